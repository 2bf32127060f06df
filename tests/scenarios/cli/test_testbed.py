"""Commands that ask the testbed: logs in, robots and run folders out."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from robots.identification.synthetic import random_way, synthesise
from robots.measured import MEASURED
from scenarios.definition.experiment import open_experiment
from scenarios.definition.files import robot_file
from scenarios.definition.load import load
from scenarios.errors import InputError
from scenarios.simulation.loop import simulate
from scenarios.studies import identification
from scenarios.studies.ladder import RUNGS

Cli = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rng = np.random.default_rng(1)
    poses, counts = synthesise(random_way(rng, 900), MEASURED.numbers, rng)
    path = tmp_path_factory.mktemp("logs") / "drive.npz"
    np.savez(path, poses=poses, counts=counts)
    return path


def test_identify_prints_the_numbers_and_leaves_a_robot_that_scenarios_name(cli: Cli, log: Path) -> None:
    code, out, _ = cli("identify", str(log), "--markdown", "numbers.md")
    assert code == 0
    assert re.search(r"base_length +0\.10\d+ +0\.10\d+ to 0\.10\d+ +m\n", out)
    assert "dead reckoning over 50 turns" in out
    assert max(map(len, out.splitlines())) <= 80
    folder = Path("runs/identify-drive")
    assert (folder / "figure-residuals.png").stat().st_size > 10_000
    assert "| wheel_radius |" in Path("numbers.md").read_text(encoding="utf-8")
    changes = ("robot.model=measured", f"robot.file={folder / 'robot.toml'}")
    numbers = open_experiment("shape", changes).measured
    assert numbers is not None
    assert numbers.numbers.base_length == pytest.approx(MEASURED.numbers.base_length, rel=0.03)


def test_identify_refuses_what_is_no_log_in_one_line(cli: Cli) -> None:
    np.savez("bad.npz", poses=np.zeros((300, 3)))
    code, _, err = cli("identify", "bad.npz")
    assert code == 2
    assert err == (
        "formation: bad.npz: no array of encoder counts: expected one named counts or encoder_readings or encoders or "
        "encoder or encoder_counts or wheel_counts, got poses\n"
    )
    assert cli("identify", "none.npz")[2] == "formation: none.npz: no such file\n"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("wheel_radius_m = 0.016", "base_length_m: missing"),
        ("wheel_radios_m = 0.016", "wheel_radios_m: unknown key, did you mean 'wheel_radius_m'?"),
        ("= 1", "not valid TOML"),
    ],
)
def test_a_robot_file_that_cannot_be_used_is_refused(line: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text(line, encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(said)):
        robot_file.read(tmp_path / "robot.toml", "robot.toml")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (("robot.model=measured", "plant.name=unicycle"), 'robot.model: "measured" robots move on the plants'),
        (("robot.file=robot.toml",), "robot.file: only for robot.model"),
        (("robot.model=measured", "robot.file=none.toml"), "robot.file none.toml: no such robot file"),
        (("robot.model=measured", "robot.numbers={lag_turns=1.0}"), "robot.numbers: wheel_radius_m: missing"),
    ],
)
def test_measured_robots_that_cannot_be_are_refused(changes: tuple[str, ...], said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        open_experiment("shape", changes)


def test_a_nominal_scenario_means_what_it_meant_before_there_were_measured_robots() -> None:
    assert load("shape").sha256 == load("shape", ("robot.model=nominal", "robot.base_spread=0.01")).sha256
    assert load("shape").sha256 != load("shape", ("robot.model=measured",)).sha256


def test_a_measured_run_ends_near_its_shape_and_differs_from_the_nominal_one() -> None:
    measured = simulate(open_experiment("shape", ("robot.model=measured", "plant.name=saturated")), 0)
    nominal = simulate(open_experiment("shape", ("plant.name=saturated",)), 0)
    assert np.array_equal(measured.poses[0], nominal.poses[0])  # the start is drawn before any robot is
    assert 1e-4 < np.abs(measured.points[-1] - nominal.points[-1]).max() < 0.1


def test_a_simulated_robot_of_the_identified_numbers_reckons_as_the_log_does_and_the_data_sheets_does_not(
    log: Path,
) -> None:
    real, measured, nominal = identification.reckonings(identification.identified(log))
    for column in (1, 2):
        assert measured[column].position == pytest.approx(real[column].position, rel=0.25)
        assert measured[column].heading == pytest.approx(real[column].heading, rel=0.25)
    assert nominal[1].heading < 0.1 * real[1].heading


def test_a_ladder_has_five_rungs_and_only_the_last_has_a_floor(cli: Cli) -> None:
    arguments = ("--seeds", "0:2", "--workers", "1", "--set", "duration_s=30.0", "--markdown", "ladder.md")
    code, out, _ = cli("ladder", "shape", *arguments)
    assert code == 0
    floors = {m[1]: float(m[2]) for m in re.finditer(r"^(\w+) .* ([\d.]+e[-+]\d+) ", out, re.MULTILINE)}
    assert list(floors) == [rung for rung, _, _ in RUNGS]
    assert floors["measured"] > 1e-3 > 10.0 * max(floor for rung, floor in floors.items() if rung != "measured")
    folder = Path("runs/ladder-shape")
    rows = (folder / "rows.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 1 + 2 * len(RUNGS)
    assert (folder / "figure-ladder.png").stat().st_size > 10_000
    assert "| measured |" in Path("ladder.md").read_text(encoding="utf-8")


def test_a_rung_that_cannot_be_climbed_is_told_before_anything_runs(cli: Cli) -> None:
    code, _, err = cli("ladder", "shape", "--set", "sensor.delay_periods=2")
    assert code == 2
    assert "single_integrator" in err
