"""How a printed figure looks: one column wide, set in the type of the paper, with the same bytes on every run."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from scenarios.figures.palette import INK

COLUMN = 3.4
"""Inches; the width of one column of a two-column journal."""

DOTS_PER_INCH = 300
SMALL = 6.5
"""Points; the size of labels inside a figure. The text around it is half a point to a point larger."""

FORMATS = ("png", "pdf", "svg")

_STYLE: Any = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": SMALL,
    "legend.frameon": False,
    "legend.borderpad": 0.0,
    "legend.borderaxespad": 0.0,
    "legend.handlelength": 1.6,
    "legend.handletextpad": 0.4,
    "legend.columnspacing": 1.0,
    "legend.labelspacing": 0.25,
    "axes.linewidth": 0.5,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.labelpad": 2.0,
    "axes.titlepad": 3.0,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.minor.width": 0.3,
    "ytick.minor.width": 0.3,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "xtick.major.pad": 2.0,
    "ytick.major.pad": 2.0,
    "lines.linewidth": 0.8,
    "lines.solid_capstyle": "round",
    "pdf.fonttype": 42,
    "svg.hashsalt": "angle-formation",
}

# Dates and version strings would make two files of one run differ.
_METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "svg": {"Date": None, "Creator": None},
}


@contextmanager
def print_style() -> Iterator[None]:
    """The style of all figures, whatever the user's own matplotlib settings are; restored on leaving."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        yield


class PrintedFigure(Figure):
    """A figure that looks as in print wherever it is drawn or saved: fonts of formulas are looked up only then."""

    def draw(self, renderer: RendererBase) -> None:
        with print_style():
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        with print_style():
            super().savefig(fname, **options)

    def _repr_png_(self) -> bytes:
        return render(self, "png")


def sheet(height: float, width: float = COLUMN) -> Figure:
    """An empty figure, inches, without a window."""
    figure = PrintedFigure(figsize=(width, height), dpi=DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    return figure


def panel(figure: Figure, left: float, bottom: float, width: float, height: float, sharex: Axes | None = None) -> Axes:
    """Axes at a place given in inches from the figure's lower left corner."""
    sheet_width, sheet_height = figure.get_size_inches()
    box = (left / sheet_width, bottom / sheet_height, width / sheet_width, height / sheet_height)
    return figure.add_axes(box, sharex=sharex)


def render(figure: Figure, form: str) -> bytes:
    """The figure as a file's content in one of :data:`FORMATS`."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=form, dpi=DOTS_PER_INCH, metadata=_METADATA[form])
    return buffer.getvalue()
