"""The figure of a sweep shows every run, the medians and the intervals."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from scenarios.figures.studies.dependence import dependence

Cli = Callable[..., tuple[int, str, str]]
RNG = np.random.default_rng(0)
SHARES = np.array([[1.0, 0.9, 1.0], [0.5, 0.3, 0.7]])


def test_every_run_has_a_point_and_each_combination_its_median() -> None:
    own = [RNG.uniform(1.0, 2.0, 20), RNG.uniform(3.0, 4.0, 30)]
    figure = dependence("sensor.bearing_noise_deg", ["0", "1"], SHARES, {"settling_time_s": own})
    below, above = figure.axes
    drawn = [line.get_ydata() for line in below.get_lines()]
    for values in own:
        assert any(len(y) == len(values) and np.array_equal(y, values) for y in drawn)
        assert any(len(y) == 1 and y[0] == np.median(values) for y in drawn)
    assert below.get_xlabel() == "sensor.bearing_noise_deg"
    [bars] = above.collections
    assert np.allclose([segment[:, 1] for segment in bars.get_segments()], SHARES[:, 1:])


def test_without_a_varied_key_the_share_of_runs_below_each_value_is_shown() -> None:
    values = np.array([1.0, 2.0, 4.0, 8.0])
    figure = dependence("", [""], SHARES[:1], {"settling_time_s": [values], "min_separation_m": [np.array([])]})
    empty, full = figure.axes
    steps = full.get_lines()[-1]
    x, y = np.asarray(steps.get_xdata()), np.asarray(steps.get_ydata())
    assert y[x <= 3.0].max() == 0.5
    assert "no run has one" in empty.texts[0].get_text()


def test_a_sweep_is_drawn_by_the_command(cli: Cli) -> None:
    common = "shape", "--plant", "unicycle", "--safety", "none", "--duration", "1", "--seeds", "0:3", "--workers", "1"
    assert cli("sweep", *common, "--vary", "sensor.bearing_noise_deg=0,2", "--out", "s")[0] == 0
    code, out, _ = cli("plot", "s", "--format", "png")
    assert (code, out) == (0, "s/figure-sweep.png\n")
    assert Path("s/figure-sweep.png").read_bytes().startswith(b"\x89PNG")
