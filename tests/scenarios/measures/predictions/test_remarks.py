"""What speaks against a run is said before it: starts, ends and rates."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.testbed import judge
from scenarios.cli import BAD_INPUT, DONE
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.load import library
from scenarios.errors import InputError
from scenarios.measures.predictions.misfits import start_misfits
from scenarios.measures.predictions.remarks import MOST_NAMED, remarks

Cli = Callable[..., tuple[int, str, str]]
Varied = Callable[..., Experiment]

DISC = "obstacles=[{vertices_m=[[-1.0, -0.7]], radius_m=0.2}]"
AHEAD = {
    ahead: open_experiment("shape", (f"robot.projection_distance_m={ahead}", DISC, "safety.filter=none"))
    for ahead in (0.025, 0.05)
}
KINDS = {"collision": "the testbed rejects", "floor": "off the floor", "obstacle": "from obstacle 1"}


@given(st.integers(0, 2**32 - 1), st.sampled_from(sorted(AHEAD)), st.floats(0.1, 1.5))
def test_a_start_fits_exactly_where_the_testbed_accepts_it(seed: int, ahead: float, spread: float) -> None:
    """Whatever the headings, and wherever the law's point lies on the robot."""
    experiment = AHEAD[ahead]
    rng = np.random.default_rng(seed)
    points, headings = rng.uniform(-1.2, 1.2, (6, 2)) * spread, rng.uniform(-np.pi, np.pi, 6)
    poses = experiment.nid.poses(points, headings)[None]
    verdict = judge(np.zeros(1), poses, np.zeros((1, 6, 2)), experiment.arena, experiment.robot.drive)
    told = start_misfits(experiment, points, headings)
    for kind, words in KINDS.items():
        assert any(words in line for line in told) == any(found.kind == kind for found in verdict.violations)


def test_starts_in_one_place_are_told_with_the_pair() -> None:
    together = [f"agents.{k}.{key}" for k in (4, 6) for key in ("start=[0.6, 0.2]", "heading_deg=7")]
    (told,) = remarks(open_experiment("shape", tuple(together)), 0)
    assert told.startswith("does not fit: the run starts with agents 4 and 6 0.000 m apart: the testbed rejects")


def test_every_agent_off_the_floor_is_named_up_to_a_number() -> None:
    changes = [f"agents.{k}.start=[{k}.0, 5.0]" for k in range(1, 7)]
    off = [line for line in remarks(open_experiment("shape", tuple(changes)), 0) if "run starts" in line]
    assert off[0] == "does not fit: the run starts with agent 1 at (1, 5) m: its axle is off the floor"
    assert len(off) == MOST_NAMED + 1
    assert off[-1] == "does not fit: the run starts with 1 more agents: off the floor"


def test_a_chassis_that_stands_in_a_wall_is_told_at_start_and_end_and_only_where_there_is_a_wall() -> None:
    at_the_wall = ("agents.1.start=[0.0, 0.97]", "agents.2.start=[-0.4, 0.6]")
    told = remarks(open_experiment("shape", (*at_the_wall, "arena.walls=true")), 0)
    assert [line for line in told if "wall" in line] == [
        "does not fit: the run starts with agent 1 at (0, 0.97) m: 0.030 m from a wall, in which its chassis stands",
        "does not fit: phase shape ends with agent 1 at (0, 0.97) m: 0.030 m from a wall, in which its chassis stands",
    ]
    assert not any("wall" in line for line in remarks(open_experiment("shape", at_the_wall), 0))


def test_points_fit_anywhere_and_robots_of_an_own_law_are_checked_too() -> None:
    crowd = ("agents.4.start=[0.6, 0.2]", "agents.6.start=[0.6, 0.2]")
    assert remarks(open_experiment("shape", (*crowd, "plant.name=single_integrator")), 0) == []
    assert any("agents 4 and 6" in line for line in remarks(open_experiment("own-law", crowd), 0))


@pytest.mark.parametrize("name", library())
def test_every_scenario_of_the_library_starts_where_its_robots_fit_and_has_time_enough(name: str) -> None:
    told = remarks(open_experiment(name), 0)
    assert [line for line in told if "starts" in line or "slow" in line] == []


@pytest.mark.parametrize(("height", "duration", "slow"), [(0.05, 60.0, True), (0.05, 500.0, False), (0.5, 60.0, False)])
def test_a_follower_too_slow_for_the_run_is_told_with_its_rate(
    varied: Varied, height: float, duration: float, slow: bool
) -> None:
    agents = [
        {"id": 1, "start": [0.0, 0.5], "target": [0.0, 0.0]},
        {"id": 2, "neighbours": [1], "start": [0.4, 0.5], "target": [0.5, 0.0]},
        {"id": 3, "neighbours": [1, 2], "start": [-0.5, -0.5], "target": [1.0, height]},
    ]
    told = [line for line in remarks(varied(agents=agents, target={}, duration=duration), 0) if "slow" in line]
    assert len(told) == slow
    if slow:
        rate = np.sin(np.arctan2(height, 0.5) - np.arctan2(height, 1.0)) ** 2
        assert told[0].startswith(f"too slow: agent 3 closes in at {rate:.2g} 1/s")
        assert f"in {duration:g} s its distance shrinks to {np.exp(-rate * duration):.3g}" in told[0]
        assert told[0].endswith("it cannot settle within the run")


@pytest.mark.parametrize("height", [0.0001, 0.004])
def test_a_follower_for_which_no_run_is_long_enough_is_refused_with_its_rate(varied: Varied, height: float) -> None:
    targets = [[0.0, 0.0], [0.5, 0.0], [1.0, height]]
    starts = [[0.0, 0.5], [0.4, 0.5], [-0.5, -0.5]]
    agents = [
        {"id": k + 1, "neighbours": list(range(1, k + 1)), "start": starts[k], "target": targets[k]} for k in range(3)
    ]
    rate = np.sin(np.arctan2(height, 0.5) - np.arctan2(height, 1.0)) ** 2
    message = rf"^varied: agents: Assumption 2: agent 3 .* neighbours 1 and 2, .*: at {rate:.2g} 1/s it cannot settle"
    with pytest.raises(InputError, match=message):
        varied(agents=agents, target={})
    assert varied(agents=agents, target={}, law={"name": "displacement"}).n == 3  # its rate is another


def test_show_run_and_export_say_the_same(cli: Cli) -> None:
    change = ("--set", "agents.6.start=[0.5, -0.3]")
    said = {}
    for command, stream in ((("show",), 1), (("run", "--duration", "0.1", "--no-recording"), 1), (("export",), 2)):
        answer = cli(command[0], "shape", *command[1:], *change)
        assert answer[0] != BAD_INPUT
        lines = [line.removeprefix("note: ") for line in answer[stream].splitlines()]
        said[command[0]] = [line for line in lines if line.startswith("does not fit")]
    assert said["show"] == said["run"] == said["export"] != []


def test_small_numbers_keep_their_digits(cli: Cli) -> None:
    code, out, _ = cli("show", "shape", "--set", "agents.3.target=[0.5, 0.02]", "--set", "target.angles_deg={}")
    assert code == DONE
    assert "0.0000" not in out
    assert "too slow: agent 3" in out


def test_hulls_that_reach_beyond_what_the_filter_keeps_are_told_of_robots_that_differ() -> None:
    def told(robot: str, *changes: str) -> list[str]:
        experiment = open_experiment("shape", (f"agents.5.robot={robot}", *changes))
        return [line for line in remarks(experiment, 0) if line.startswith("too wide")]

    assert told("{width_m=0.11}") == []
    (line,) = told("{width_m=0.20}")
    assert "the hull of agent 5 reaches 0.112 m from its projected point and that of agent 6 0.074 m" in line
    (line,) = told("{projection_distance_m=0.06}")
    assert "agent 5 reaches 0.101 m" in line
    assert told("{width_m=0.20}", "safety.safe_distance_m=0.19") == []
    assert told("{width_m=0.20}", "safety.filter=none") == []
