"""Commands that ask the testbed: logs in, robots and run folders out."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from robots.identification.synthetic import random_way, synthesise
from robots.measured import MEASURED
from scenarios.definition import robot_file
from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import load
from scenarios.errors import InputError
from scenarios.simulation.loop import simulate

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
