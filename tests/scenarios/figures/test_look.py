"""Figures are as wide as was asked for, in the type that was asked for, and otherwise the same."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

import scenarios
from scenarios.errors import InputError
from scenarios.figures.style import DOTS_PER_INCH, Look, look_for, panel, print_style, render, sheet
from scenarios.interactive.single import Run


@pytest.fixture(scope="module")
def run() -> Run:
    return scenarios.run("shape", plant="saturated", duration=3.0)


@pytest.fixture(scope="module")
def saved(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run's folder, to copy."""
    return run.save(tmp_path_factory.mktemp("saved") / "run")


def drawn(look: Look) -> Figure:
    with print_style(look):
        figure = sheet(1.7)
        axes = panel(figure, 0.34, 0.34, 2.72, 1.19)
        axes.set(xlabel="time (s)", title="a")
        axes.text(0.5, 0.5, "b", fontsize=6.0)
        return figure


@pytest.mark.parametrize("width", ["3.4in", "7in", "180mm", "8.6cm"])
def test_a_figure_is_as_wide_as_was_asked_for_and_keeps_its_proportions(width: str, tmp_path: Path) -> None:
    look = look_for(width)
    figure = drawn(look)
    (tmp_path / "a.png").write_bytes(render(figure, "png"))
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.width == pytest.approx(look.width * DOTS_PER_INCH, abs=1.0)
        assert picture.height == pytest.approx(picture.width / 2.0, abs=1.0)
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ", render(figure, "pdf"))
    assert box is not None
    assert float(box[1]) == pytest.approx(72.0 * look.width, abs=1e-3)
    assert figure.axes[0].get_position().bounds == pytest.approx((0.1, 0.2, 0.8, 0.7))


def test_all_type_grows_in_proportion_once_and_lines_do_not() -> None:
    sizes = {}
    for points in (7.5, 9.0):
        figure = drawn(Look(size=points))
        for _ in range(2):
            render(figure, "png")
        axes = figure.axes[0]
        texts = [axes.title, axes.xaxis.label, axes.texts[0], axes.get_xticklabels()[0], axes.get_yticklabels()[-1]]
        sizes[points] = np.array([text.get_fontsize() for text in texts])
        assert figure.axes[0].spines["left"].get_linewidth() == 0.5
    assert sizes[9.0] == pytest.approx(1.2 * sizes[7.5])


def test_the_type_is_of_the_family_and_the_sessions_style_is_left_alone(run: Run) -> None:
    before = dict(matplotlib.rcParams)
    figure = run.plot("separation", font="sans", width="5in")
    assert {text.get_fontfamily()[0] for text in figure.findobj(Text)} == {"DejaVu Sans"}
    assert b"DejaVuSans" in render(figure, "pdf")
    assert figure.get_figwidth() == pytest.approx(5.0)
    assert dict(matplotlib.rcParams) == before
    assert run.plot("separation").get_figwidth() == pytest.approx(3.4)


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--width", "3.4", "--width: expected 2in to 20in, 3.4in, 86mm or 8.6cm say, got '3.4'"),
        ("--width", "1mm", "--width: expected 2in to 20in, 3.4in, 86mm or 8.6cm say, got '1mm'"),
        ("--font", "seriv", "--font 'seriv': did you mean 'serif'?"),
        ("--font-size", "nan", "--font-size: expected 5 to 20 points, got nan"),
        ("--figure", "moton", "figure 'moton': did you mean 'motion'?"),
    ],
)
def test_a_look_that_cannot_be_is_refused_in_one_line(
    option: str, value: str, said: str, saved: Path, tmp_path: Path, cli: Callable[..., tuple[int, str, str]]
) -> None:
    shutil.copytree(saved, tmp_path / "run")
    before = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "run").iterdir()}
    assert cli("plot", "run", option, value) == (2, "", f"formation: {said}\n")
    assert {path.name: path.stat().st_mtime_ns for path in (tmp_path / "run").iterdir()} == before


def test_plot_draws_the_figures_that_are_named_as_wide_as_is_said(
    run: Run, saved: Path, tmp_path: Path, cli: Callable[..., tuple[int, str, str]]
) -> None:
    shutil.copytree(saved, tmp_path / "run")
    code, out, _ = cli(
        "plot", "run", "--figure", "separation", "--width", "86mm", "--format", "png", "--out", "figures"
    )
    assert (code, out) == (0, "figures/figure-separation.png\n")
    with Image.open("figures/figure-separation.png") as picture:
        assert picture.width == pytest.approx(86.0 / 25.4 * 300.0, abs=1.0)
    with pytest.raises(InputError):
        run.plot("separation", width="0in")


def test_an_edge_that_is_sensed_one_way_has_a_head_that_points_to_whom_is_sensed(run: Run) -> None:
    from scenarios.figures.floor import draw_edges

    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]])
    with print_style():
        axes = panel(sheet(1.0), 0.1, 0.1, 1.0, 1.0)
        draw_edges(axes, run.experiment.graph, points)
    heads = [path.vertices[:3] for path in axes.collections[-1].get_paths()]
    assert len(heads) == len(run.experiment.graph.edges)
    for (tip, *back), (observer, observed) in zip(heads, run.experiment.graph.edges, strict=True):
        ahead = tip - np.mean(back, axis=0)
        way = points[observed] - points[observer]
        assert ahead @ way == pytest.approx(np.linalg.norm(ahead) * np.linalg.norm(way))
