"""Commands that ask the testbed: logs in, robots and run folders out."""

import json
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
from scenarios.storage import run_folder
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
        "encoder or encoder_counts or wheel_counts\n"
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


@pytest.fixture(scope="module")
def formation_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of six robots, as the testbed returns it: (3, N, T), headings wrapped, some poses missing."""
    trajectory = simulate(open_experiment("shape", ("robot.model=measured",), duration=20.0), 3)
    poses = np.moveaxis(trajectory.poses, 0, 2).swapaxes(0, 1).copy()
    poses[2] = np.angle(np.exp(1j * poses[2]))
    poses[:, 2, 100:104] = np.nan
    path = tmp_path_factory.mktemp("logs") / "six.npz"
    np.savez(path, poses=poses, t=trajectory.t)
    return path


def test_adopt_makes_a_log_a_run_folder_beside_its_simulation(cli: Cli, formation_log: Path) -> None:
    code, out, _ = cli("adopt", str(formation_log), "--scenario", "shape", "--set", "goal.angle_error_sum_rad=0.1")
    assert code == 0
    assert out.count("testbed: accepted") == 2
    run = run_folder.read(Path("runs/adopt-six"))
    poses = np.load(formation_log)["poses"]
    assert np.allclose(run.trajectory.poses[-1, :, :2], poses[:2, :, -1].T, atol=1e-12)
    assert run.trajectory.t[-1] == pytest.approx(20.0)
    assert "six.npz" in run.experiment.scenario.source
    beside = run_folder.read(Path("runs/adopt-six-simulated"))
    assert np.allclose(beside.trajectory.points[0], run.trajectory.points[0], atol=1e-9)
    assert (Path("runs/adopt-six") / run_folder.RECORDING).is_file()


def test_a_log_without_a_scenario_is_measured_by_the_shape_that_it_ends_in(cli: Cli, formation_log: Path) -> None:
    code, out, _ = cli("adopt", str(formation_log), "--no-simulate", "--out", "own")
    assert code == 0
    assert "outcome: converged" in out
    assert np.abs(run_folder.read(Path("own")).trajectory.points[-1]).max() < 2.0


@pytest.mark.parametrize(
    ("poses", "arguments", "said"),
    [
        (np.zeros((300, 3)), (), "expected 3 robots or more, got 1"),
        (np.zeros((3, 4, 300)), ("--scenario", "shape"), "expected 6 robots, as many as shape has agents, got 4"),
        (np.full((3, 6, 300), np.nan), ("--scenario", "shape"), "robot 1 has no poses"),
    ],
)
def test_a_log_that_fits_no_formation_is_refused(
    cli: Cli, poses: np.ndarray, arguments: tuple[str, ...], said: str
) -> None:
    np.savez("log.npz", poses=poses)
    code, _, err = cli("adopt", "log.npz", *arguments)
    assert code == 2
    assert said in err


SCRIPT = """
import numpy as np
import rps.robotarium as robotarium

r = robotarium.Robotarium(number_of_robots=2, initial_conditions=np.array([[0.0, 0.5], [0.0, 0.0], [0.0, 0.0]]))
for _ in range(90):
    seen = r.get_poses()
    r.set_velocities(np.arange(2), np.array([[0.0, 0.1], [1.5, 0.0]]))
    r.step()
print("seen", *seen[:, 0])
r.call_at_scripts_end()
"""


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_scripts_drive_measured_robots_and_see_what_the_cameras_say(cli: Cli, plant: str) -> None:
    Path("spin.py").write_text(SCRIPT, encoding="utf-8")
    turned = {}
    for robots in ((), ("--measured",)):
        code, out, _ = cli("script", "spin.py", "--plant", plant, "--no-recording", "--out", "run", *robots)
        assert code == 0
        seen = float(re.findall(r"^seen .* (\S+)$", out, re.MULTILINE)[0])
        poses = np.load("run/trajectory.npz")["poses"]
        turned[robots] = poses[-1, 0, 2]
        wrapped = np.angle(np.exp(1j * (seen - poses[-2, 0, 2])))
        assert (abs(wrapped) < 1e-9) == (not robots)  # the cameras are late
    assert json.loads(Path("run/result.json").read_text(encoding="utf-8"))["robot_model"] == "measured"
    assert abs(turned[()] - 1.5 * 90 * 0.033) < 0.02
    assert 0.0 < turned["--measured",] - turned[()] + 0.15 < 0.5  # bases of 0.1055 m turn faster, motors start late


def test_scripts_with_measured_robots_need_wheels_with_limits(cli: Cli) -> None:
    Path("spin.py").write_text(SCRIPT, encoding="utf-8")
    code, _, err = cli("script", "spin.py", "--plant", "unicycle", "--measured")
    assert code == 2
    assert err == "formation: --measured: robots move on saturated and pymunk, got --plant unicycle\n"


def test_the_calibration_script_runs_and_its_log_tells_the_robot(cli: Cli) -> None:
    assert cli("calibrate", "--out", "calibrate.py")[0] == 0
    script = Path("calibrate.py").read_text(encoding="utf-8")
    for long, short in (("SPINS = 20", "SPINS = 2"), ("* 5", "* 2"), ("20.0)", "3.0)")):
        assert long in script
        script = script.replace(long, short)
    Path("calibrate.py").write_text(script, encoding="utf-8")
    code, _, _ = cli("script", "calibrate.py", "--plant", "saturated", "--measured", "--no-recording")
    assert code == 0
    found = identification.identified(Path("calibration.npz"))
    assert found.numbers.wheel_radius == pytest.approx(MEASURED.numbers.wheel_radius, rel=0.02)
    assert found.numbers.base_length == pytest.approx(MEASURED.numbers.base_length, rel=0.05)
    assert found.numbers.lag < 0.0  # here it is the cameras that are late
