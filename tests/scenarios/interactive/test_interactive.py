"""Runs and sweeps in Python: the same as the commands', and shown as in print."""

import base64
import io
import json
import os
import re
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from PIL import Image
from rich.console import Console

import scenarios
from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.interactive.single import Run
from scenarios.one_run import run_to_folder

SHORT = 1.0
"""Seconds."""


@pytest.fixture(scope="module")
def run() -> Run:
    return scenarios.run("shape", ["plant.name=saturated"], seed=3, safety="none", duration=SHORT)


def test_a_saved_run_is_the_run_folder_of_the_command(run: Run, tmp_path: Path) -> None:
    run.save(tmp_path / "python")
    experiment = open_experiment("shape", ("plant.name=saturated", 'safety.filter="none"'), SHORT)
    run_to_folder(experiment, 3, tmp_path / "command", Console(quiet=True))
    ours, theirs = (
        {path.name: path.read_bytes() for path in (tmp_path / made).iterdir() if not path.name.startswith("recording")}
        for made in ("python", "command")
    )
    assert {**ours, "manifest.sha256": b""} == {**theirs, "manifest.sha256": b""}
    assert (tmp_path / "python" / "recording.rrd").is_file()
    assert json.loads(ours["result.json"]) == run.result


def test_a_table_has_the_states_of_the_run_with_agents_counted_from_1(run: Run) -> None:
    table = run.table()
    assert len(table) == len(run.trajectory.t)
    assert np.array_equal(table["x_6_m"], run.trajectory.points[:, 5, 0])
    assert np.array_equal(table["heading_1_rad"], run.trajectory.poses[:, 0, 2])
    assert np.array_equal(table["right_wheel_2_rad_per_s"], run.trajectory.wheel_speeds[:, 1, 1], equal_nan=True)
    errors = table.filter(regex=r"^alpha.*\.error_rad$")
    assert np.allclose(errors.abs().sum(axis=1), table["angle_error_sum_rad"])
    units = re.compile(r"(_s|_m|_rad|_rad_per_s|_m_per_s)$|^phase$")
    assert [name for name in table if not units.search(name)] == []


def test_a_figure_is_the_commands_whatever_the_style_of_the_session_is(run: Run, tmp_path: Path) -> None:
    run.save(tmp_path / "run")
    figure = run.plot("motion")
    with matplotlib.rc_context({"mathtext.fontset": "cm", "svg.hashsalt": None, "savefig.facecolor": "red"}):
        figure.savefig(tmp_path / "mine.png", metadata={"Software": None})
    assert (tmp_path / "mine.png").read_bytes() == (tmp_path / "run" / "figure-motion.png").read_bytes()


def test_an_unknown_figure_is_told_with_the_nearest_name(run: Run) -> None:
    with pytest.raises(InputError, match="did you mean 'motion'"):
        run.plot("moton")


def test_a_run_shows_itself_as_the_command_prints_it(run: Run) -> None:
    html = run._repr_html_()
    assert html.startswith("<pre>")
    assert "settl" in html
    assert repr(run) == f"<run of shape, saturated, seed 3: {run.result['outcome']}>"


@pytest.mark.parametrize(("form", "magic"), [("gif", b"GIF8"), ("webp", b"WEBP"), ("mp4", b"ftyp")])
def test_a_film_is_played_where_it_is_shown(run: Run, form: str, magic: bytes) -> None:
    film = run.animate(form, speed=10.0, fps=20.0)
    [encoded] = re.findall(r"base64,([^\"]+)", film._repr_html_())
    assert base64.b64decode(encoded) == film.data
    assert magic in film.data[:12]
    if form == "gif":
        assert Image.open(io.BytesIO(film.data)).n_frames > 1


def test_a_notebook_gets_the_recording_of_the_run_and_nothing_from_a_server(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = []

    class Viewer:
        def __init__(self, width: int, height: int) -> None:
            sent.append((width, height, os.environ["RERUN_NOTEBOOK_ASSET"]))

        def send_rrd(self, data: bytes) -> None:
            sent.append(data[:4])

    monkeypatch.delenv("RERUN_NOTEBOOK_ASSET", raising=False)
    monkeypatch.setitem(sys.modules, "rerun_notebook", SimpleNamespace(Viewer=Viewer))
    assert isinstance(run.replay(height=300), Viewer)
    assert sent == [(960, 300, "serve-local"), b"RRF2"]
    monkeypatch.setitem(sys.modules, "rerun_notebook", None)
    with pytest.raises(InputError, match="the extra 'notebook'"):
        run.replay()


def test_a_sweep_is_a_frame_of_single_runs(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = scenarios.sweep(
        "shape", [3, 5], vary={"plant.name": ["saturated", "unicycle"]}, safety="none", duration=SHORT
    )
    assert rows["seed"].tolist() == [3, 5, 3, 5]
    assert rows["angle_error_sum_rad"][0] == run.result["angle_error_sum_rad"]
    assert rows["accepted"].tolist()[0] == run.result["testbed"]["accepted"]
    assert list(tmp_path.iterdir()) == []


def test_seeds_may_be_a_range_numbers_a_number_or_a_text(tmp_path: Path) -> None:
    for seeds in (range(2), [0, 1], "0:2"):
        rows = scenarios.sweep("shape", seeds, ["plant.name=saturated"], safety="none", duration=0.1)
        assert rows["seed"].tolist() == [0, 1]
    kept = scenarios.sweep("shape", 1, ["plant.name=saturated"], safety="none", duration=0.1, out=tmp_path / "kept")
    assert kept["seed"].tolist() == [1]
    assert (tmp_path / "kept" / "rows.csv").is_file()


def test_a_negative_seed_is_refused_in_one_line() -> None:
    with pytest.raises(InputError, match="seed: expected an integer from 0"):
        scenarios.run("shape", seed=-1)
