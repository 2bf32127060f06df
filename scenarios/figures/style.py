"""How a printed figure looks: one column wide, set in the type of the paper, with the same bytes on every run."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from scenarios.errors import InputError, did_you_mean
from scenarios.figures.palette import INK

COLUMN = 3.4
"""Inches; the width of one column of a two-column journal."""

DOTS_PER_INCH = 300
SIZE, TICKS = 7.5, 7.0
"""Points; of labels and titles, and of the numbers at the axes."""

SMALL = 6.5
"""Points; the size of labels inside a figure. The text around it is half a point to a point larger."""

FORMATS = ("png", "pdf", "svg")

SERIF = "STIXGeneral"
FAMILIES = {"serif": SERIF, "sans": "DejaVu Sans"}
"""Families that matplotlib brings."""

WIDTHS, SIZES = (2.0, 20.0), (5.0, 20.0)
"""Inches of a figure and points of its type, from and to."""

PER_INCH = {"in": 1.0, "mm": 25.4, "cm": 2.54}

_STYLE: Any = {
    "font.family": SERIF,
    "mathtext.fontset": "stix",
    "font.size": SIZE,
    "axes.labelsize": SIZE,
    "axes.titlesize": SIZE,
    "xtick.labelsize": TICKS,
    "ytick.labelsize": TICKS,
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


@dataclass(frozen=True)
class Look:
    """What a figure is drawn for: by default one column of a journal, in the type of the paper.

    Attributes:
        width: inches; what is inside keeps its proportions.
        family: of the type; letters that it lacks come from STIX.
        size: points, of labels and titles; all other type in proportion.
    """

    width: float = COLUMN
    family: str = SERIF
    size: float = SIZE

    @property
    def style(self) -> Any:
        """What matplotlib has to be told."""
        mathematics = {} if self.family == SERIF else {"mathtext.fontset": "stixsans"}
        return _STYLE | mathematics | {"font.family": list(dict.fromkeys((self.family, SERIF)))}


PLAIN = Look()

_LOOK: ContextVar[Look] = ContextVar("look", default=PLAIN)


def look_for(width: str | None = None, font: str | None = None, size: float | None = None) -> Look:
    """The look that is asked for.

    Args:
        width: a number with its unit, ``3.4in``, ``86mm`` or ``8.6cm``.
        font: ``serif``, ``sans``, or a family that matplotlib finds.
        size: points.

    Raises:
        InputError: one of them is none.
    """
    return Look(
        PLAIN.width if width is None else _inches(width),
        PLAIN.family if font is None else _family(font),
        PLAIN.size if size is None else _points(size),
    )


def _inches(width: str) -> float:
    found = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+)(in|mm|cm)", width.strip())
    inches = float(found[1]) / PER_INCH[found[2]] if found else 0.0
    if not WIDTHS[0] <= inches <= WIDTHS[1]:
        raise InputError(
            f"--width: expected {WIDTHS[0]:g}in to {WIDTHS[1]:g}in, 3.4in, 86mm or 8.6cm say, got {width[:40]!r}"
        )
    return inches


def _family(font: str) -> str:
    if font in FAMILIES:
        return FAMILIES[font]
    from matplotlib.font_manager import get_font_names

    known = get_font_names()
    if font not in known:
        hint = did_you_mean(font, [*FAMILIES, *known], "expected serif, sans or a family that matplotlib finds")
        raise InputError(f"--font {font[:40]!r}: {hint}")
    return font


def _points(size: float) -> float:
    if not SIZES[0] <= size <= SIZES[1]:
        raise InputError(f"--font-size: expected {SIZES[0]:g} to {SIZES[1]:g} points, got {size:g}")
    return size


@contextmanager
def print_style(look: Look | None = None) -> Iterator[None]:
    """The style of all figures, whatever the user's own matplotlib settings are; restored on leaving.

    Without a ``look``, that of the block around it.
    """
    chosen = _LOOK.get() if look is None else look
    token = _LOOK.set(chosen)
    try:
        with matplotlib.rc_context():
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(chosen.style)
            yield
    finally:
        _LOOK.reset(token)


class PrintedFigure(Figure):
    """A figure that looks as in print wherever it is drawn or saved: fonts of formulas are looked up only then."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._look, self._lettered = _LOOK.get(), False

    def draw(self, renderer: RendererBase) -> None:
        with print_style(self._look):
            self._letter()
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        with print_style(self._look):
            super().savefig(fname, **options)

    def _letter(self) -> None:
        """Give all type the size that was asked for, once: drawn is what is designed for the usual one."""
        times = self._look.size / SIZE
        if self._lettered or times == 1.0:
            return
        self._lettered = True
        for axes in self.axes:
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_tick_params(labelsize=times * TICKS)
        ticks = {text for axes in self.axes for text in (*axes.get_xticklabels(), *axes.get_yticklabels())}
        for text in self.findobj(Text):
            if text not in ticks:
                text.set_fontsize(times * float(text.get_fontsize()))

    def _repr_png_(self) -> bytes:
        return render(self, "png")


def sheet(height: float, width: float = COLUMN) -> Figure:
    """An empty figure, without a window; inches of a figure for one column, which the look may make larger."""
    times = _LOOK.get().width / COLUMN
    figure = PrintedFigure(figsize=(times * width, times * height), dpi=DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    return figure


def panel(figure: Figure, left: float, bottom: float, width: float, height: float, sharex: Axes | None = None) -> Axes:
    """Axes at a place given in inches from the figure's lower left corner, as it is for one column."""
    times = figure._look.width / COLUMN if isinstance(figure, PrintedFigure) else 1.0
    sheet_width, sheet_height = figure.get_size_inches() / times
    box = (left / sheet_width, bottom / sheet_height, width / sheet_width, height / sheet_height)
    return figure.add_axes(box, sharex=sharex)


def render(figure: Figure, form: str) -> bytes:
    """The figure as a file's content in one of :data:`FORMATS`."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=form, dpi=DOTS_PER_INCH, metadata=_METADATA[form])
    return buffer.getvalue()
