"""Exported scripts: they do what the run does, and read like a person's work."""

import ast
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.robotarium import Robotarium
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.export.portable import crowded, start_poses
from scenarios.export.script import script
from scenarios.export.wording import prose, quoted
from scenarios.simulation.loop import simulate

WHOLE_PERIODS = 900 * 0.033
Runner = Callable[[str, str], Robotarium]
Same = Callable[[Experiment, int, str, float], None]
EXPORTABLE = (
    "shape",
    "scale-only",
    "orientation-only",
    "sequential",
    "consensus-velocity",
    "gap",
    "figure-eight",
    "reshape",
    "robot-stops",
    "law-area",
    "law-triangle-mixed",
    "law-bisector",
    "law-persistent",
    "law-laplacian",
)


@pytest.mark.parametrize(("plant", "atol"), [("saturated", 1e-7), ("pymunk", 1e-4)])
@pytest.mark.parametrize("saturation", ["scale", "clip"])
def test_the_script_moves_the_robots_as_the_run_does(
    moves_as_the_run: Same, varied: Callable[..., Experiment], plant: str, atol: float, saturation: str
) -> None:
    experiment = varied(
        f'plant.name="{plant}"',
        'safety.filter="none"',
        f'robot.saturation="{saturation}"',
        "robot.projection_distance_m=0.04",
        duration=WHOLE_PERIODS,
    )
    moves_as_the_run(experiment, 3, plant, atol)


@pytest.mark.parametrize("first_follower", ["stationary", "displacement", "distance", "bearing", "spiral"])
def test_every_first_follower_acts_in_the_script_as_in_the_run(
    moves_as_the_run: Same, varied: Callable[..., Experiment], first_follower: str
) -> None:
    phases = [
        {"name": "up", "duration_s": 3.3, "velocity_m_s": [0.0, 0.02], "displacement_m": [0.4, 0.4]},
        {"name": 'the "turn"', "duration_s": 1.65, "velocity_m_s": [0.05, 0.01], "displacement_m": [0.4, -0.4]},
    ]
    experiment = varied(
        without="duration_s",
        phases=phases,
        law={"first_follower": first_follower},
        plant={"name": "saturated"},
        safety={"filter": "none"},
    )
    moves_as_the_run(experiment, 1, "saturated", 1e-7)


def test_followers_wait_for_their_neighbours_in_the_script_as_in_the_run(moves_as_the_run: Same) -> None:
    changes = ('plant.name="saturated"', 'safety.filter="none"')
    experiment = open_experiment("sequential", changes, duration=450 * 0.033)
    started = simulate(experiment, 0).active
    assert not started[0, 3]
    assert started[-1, 4]
    moves_as_the_run(experiment, 0, "saturated", 1e-7)


def test_agents_learn_the_velocity_in_the_script_as_in_the_run(
    moves_as_the_run: Same, varied: Callable[..., Experiment]
) -> None:
    experiment = varied(
        without="duration_s",
        phases=[
            {"name": "up", "duration_s": 3.3, "velocity_m_s": [0.0, 0.02], "displacement_m": [0.4, 0.4]},
            {"name": "right", "duration_s": 1.65, "velocity_m_s": [0.05, 0.01], "displacement_m": [0.4, -0.4]},
        ],
        velocity_known_by="leader",
        communication={"gain_per_s": 2.0},
        law={"first_follower": "displacement"},
        plant={"name": "saturated"},
        safety={"filter": "none"},
    )
    moves_as_the_run(experiment, 1, "saturated", 1e-7)


def test_the_certificate_acts_in_the_script_as_in_the_run(
    moves_as_the_run: Same, varied: Callable[..., Experiment]
) -> None:
    experiment = varied('plant.name="saturated"', 'safety.filter="robotarium"', duration=300 * 0.033)
    moves_as_the_run(experiment, 0, "saturated", 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "seeds"), [("shape", 3), ("maneuver-testbed", 1)])
def test_under_the_certificate_the_goal_is_reached_and_accepted_from_every_heading(
    on_testbed: Runner, capsys: pytest.CaptureFixture[str], scenario: str, seeds: int
) -> None:
    experiment = open_experiment(scenario)
    for seed in range(seeds):
        robotarium = on_testbed(script(experiment, seed), "pymunk")
        assert "rad: reached" in capsys.readouterr().out, seed
        assert robotarium.debug().accepted, seed


@pytest.mark.parametrize("scenario", EXPORTABLE)
@pytest.mark.parametrize("change", ['safety.filter="none"', 'safety.filter="robotarium"', 'robot.saturation="clip"'])
def test_the_script_needs_numpy_and_rps_alone_and_its_lines_are_short(scenario: str, change: str) -> None:
    text = script(open_experiment(scenario, (change,)), 7)
    imported = {
        name.split(".")[0]
        for node in ast.walk(ast.parse(text))
        for name in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [node.module or ""]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    assert imported == {"numpy", "rps"}
    assert max(len(line) for line in text.splitlines()) <= 79


@pytest.mark.parametrize("change", ['safety.filter="none"', 'robot.saturation="clip"'])
def test_ruff_finds_nothing_in_the_scripts(tmp_path: Path, change: str) -> None:
    for scenario in EXPORTABLE:
        (tmp_path / f"{scenario}.py").write_text(script(open_experiment(scenario, (change,))), encoding="utf-8")
    for command in (["check", "--select", "E,F,W,I,B,UP,N,NPY,RUF,SIM,C4"], ["format", "--check"]):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, "--isolated", "--no-cache", "--line-length", "79", str(tmp_path)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout


def test_every_digit_of_the_gains_targets_and_starts_is_kept(shape: Experiment) -> None:
    tree = ast.parse(script(shape, 5))
    lists = {
        node.targets[0].id: node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and isinstance(node.value, ast.List)
    }
    values = {name: eval(ast.unparse(node)) for name, node in lists.items()}
    assert [gain for _, _, gain in values["EDGES"]] == shape.law.gains.ravel().tolist()  # type: ignore[union-attr]
    assert [target for *_, target in values["ANGLES"]] == shape.target_angles.tolist()
    poses = shape.nid.poses(*shape.starts.draw(np.random.default_rng(5)))
    assert values["START"] == [tuple(pose) for pose in poses.tolist()]


@given(st.text(max_size=120))
def test_no_title_ends_the_docstring(title: str) -> None:
    tree = ast.parse(f'"""{prose(f"{title}.")}\n"""\n')
    assert [type(node) for node in tree.body] == [ast.Expr]
    plain = "".join(c if c.isprintable() else " " for c in title)
    assert "".join((ast.get_docstring(tree) or "").split()) == "".join(f"{plain}.".split())


@given(st.text())
def test_quoted_names_read_back(name: str) -> None:
    assert ast.literal_eval(quoted(name)) == name


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ("plant.control_period_s=0.02", "plant.control_period_s"),
        ("robot.wheel_speed_limit_rad_s=20.0", "robot.wheel_speed_limit_rad_s"),
        ("sensor.position_noise_m=0.01", "sensor.position_noise_m"),
        ("sensor.bearing_noise_deg=1.0", "sensor.bearing_noise_deg"),
        ("sensor.compass_bias_deg=1.0", "sensor.compass_bias_deg"),
        ("sensor.delay_periods=1", "sensor.delay_periods"),
        ("sensor.edge_loss=0.1", "sensor.edge_loss"),
        ("sensor.dropout=0.1", "sensor.dropout"),
        ("arena.x_m=[-3.0, 1.0]", "arena.x_m"),
        ("arena.y_m=[-0.5, 1.5]", "arena.y_m"),
    ],
)
def test_what_a_script_cannot_carry_is_refused_by_name(
    varied: Callable[..., Experiment], change: str, field: str
) -> None:
    with pytest.raises(InputError, match=rf": {field}: "):
        script(varied(change))


def test_starts_off_the_floor_are_refused() -> None:
    with pytest.raises(InputError, match=r"agents\[id 2\].start"):
        script(open_experiment("shape", ("agents.2.start=[-1.7, 0.0]",)))


def test_starts_without_room_to_arrive_are_remarked_on() -> None:
    crowd, room = (open_experiment(name) for name in ("shape", "maneuver-testbed"))
    assert "agents 1 and 4 start 0.30 m apart" in (crowded(crowd, start_poses(crowd, 0)) or "")
    assert crowded(room, start_poses(room, 0)) is None


def test_export_prints_or_writes_and_replaces_nothing_unasked(
    tmp_path: Path, cli: Callable[..., tuple[int, str, str]]
) -> None:
    export = partial(cli, "export", "--duration", "1")
    place = tmp_path / "new" / "shape.py"
    code, printed, remark = export("shape", "--seed", "2")
    assert code == 0
    assert printed == script(open_experiment("shape", (), 1.0), 2)
    assert export("shape", "--seed", "2", "--out", str(place)) == (0, "", remark)
    assert place.read_text(encoding="utf-8") == printed
    place.write_text("mine", encoding="utf-8")
    code, _, problem = export("shape", "--out", str(place))
    assert code == 2
    assert "--force" in problem
    assert place.read_text(encoding="utf-8") == "mine"
    assert export("shape", "--seed", "2", "--out", str(place), "--force") == (0, "", remark)
    assert place.read_text(encoding="utf-8") == printed
    code, _, problem = export("random-50", "--out", str(tmp_path / "random.py"))
    assert code == 2
    assert problem.count("\n") == 1
    assert sorted(path.name for path in tmp_path.rglob("*.py")) == ["shape.py"]


NUMBERED = """
title = "Five robots with numbers of their own"
graph = "subgraph"
leaders = [7, 3]
agents = [
  { id = 3, neighbours = [7], target = [0.5, 0.0], start = [0.6, -0.1] },
  { id = 5, neighbours = [3, 9], target = [0.2, 0.7], start = [-0.1, 0.5] },
  { id = 7, target = [0.0, 0.0], start = [0.0, -0.2] },
  { id = 9, neighbours = [3, 7], target = [0.6, 0.6], start = [0.9, 0.5] },
  { id = 1, neighbours = [9, 7], target = [-0.4, 0.3], start = [-0.8, 0.3] },
]
law = { first_follower = "displacement" }
phases = [{ name = "gather", duration_s = 6.6, displacement_m = [0.6, 0.1] }]
plant = { name = "saturated" }
safety = { filter = "none" }
"""


def test_agents_keep_their_own_numbers_in_the_script(moves_as_the_run: Same, tmp_path: Path) -> None:
    (tmp_path / "numbered.toml").write_text(NUMBERED, encoding="utf-8")
    experiment = open_experiment(str(tmp_path / "numbered.toml"))
    assert experiment.numbers[:2] == (7, 3)
    text = script(experiment, 2)
    assert f"AGENTS = {list(experiment.numbers)}" in text
    assert "u[1] = delta - (p[1] - p[0])  # agent 3, the first follower" in text
    assert "and agent 3 as seen from agent 7" in text
    (edges,) = (
        eval(ast.unparse(node.value))
        for node in ast.parse(text).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "EDGES"
    )
    assert {edge[:2] for edge in edges} == {(9, 3), (9, 7), (5, 3), (5, 9), (1, 9), (1, 7)}
    moves_as_the_run(experiment, 2, "saturated", 1e-7)
