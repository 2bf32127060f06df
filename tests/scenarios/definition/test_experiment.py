"""From a validated scenario to the objects of a run."""

from collections.abc import Callable

import numpy as np
import pytest

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.load import LIBRARY, library
from scenarios.errors import InputError

Varied = Callable[..., Experiment]


def test_the_shape_experiment_is_the_papers(shape: Experiment) -> None:
    assert shape.n == 6
    np.testing.assert_array_equal(shape.graph.neighbours + 1, [[1, 2], [2, 3], [1, 4], [1, 4]])
    np.testing.assert_array_equal(shape.initial_points(0)[[0, 1, 5]], [[0.0, 0.5], [-0.5, 0.0], [0.6, 0.2]])
    assert [phase.duration for phase in shape.phases] == [60.0]
    assert shape.nid.projection_distance == 0.025
    assert len(shape.angles) == 8


def test_targets_are_exact_and_the_listed_degrees_only_checked_against_them(shape: Experiment) -> None:
    listed = list(shape.scenario.target.angles_deg.values())
    assert np.degrees(shape.target_angles) == pytest.approx(listed, abs=0.005)
    assert np.abs(shape.angles.errors(shape.target.positions, shape.target_angles)).max() == 0.0


def test_without_listed_angles_every_followers_triangle_is_measured(varied: Varied) -> None:
    assert len(varied("target.angles_deg={}").angles) == 8


def test_the_order_of_the_agents_in_a_file_does_not_matter(shape: Experiment, varied: Varied) -> None:
    agents = [agent.model_dump(exclude_none=True) for agent in shape.scenario.agents]
    turned = varied(agents=[{**a, "neighbours": list(a["neighbours"])[::-1]} for a in agents[::-1]])
    assert (turned.initial_points(0) == shape.initial_points(0)).all()
    assert (turned.graph.neighbours == shape.graph.neighbours).all()


def test_a_duration_replaces_the_scenarios_own(varied: Varied) -> None:
    assert [phase.duration for phase in varied(duration=3.0).phases] == [3.0]


@pytest.mark.parametrize(("duration", "lengths"), [(1.0, [1.0]), (2.0, [2.0]), (3.0, [2.0, 1.0]), (10.0, [2.0, 8.0])])
def test_a_duration_cuts_phases_short_or_lengthens_the_last(
    moving: Callable[[str], Experiment], varied: Varied, duration: float, lengths: list[float]
) -> None:
    phases = [phase.model_dump() for phase in moving("displacement").scenario.phases]
    experiment = varied(without="duration_s", phases=phases, law={"first_follower": "displacement"}, duration=duration)
    assert [phase.duration for phase in experiment.phases] == lengths


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (["agents.3.neighbours=[1]"], r"agents: Assumption 1, clause \(i\): agent 3 has 1 neighbour"),
        (["agents.3.neighbours=[1, 4]"], r"agents: Assumption 1, clause \(ii\): agent 3 senses agent 4"),
        (["agents.3.target=[2, 0]"], r"triangle \(1, 2, 3\) is degenerate, agent 3 is collinear"),
        (["agents.2.start=[0, 0.5]"], r"agents\[id 2\].start: leader and first follower coincide at \(0, 0.5\)"),
        (["agents.2.target=[0, 0]"], "leader and first follower coincide in the target"),
        (['target.angles_deg={"1;2,3"=90.01}'], r"'1;2,3': the target positions have 90.0000 degrees, got 90.01"),
        (['target.angles_deg={"1;2,7"=90.0}'], r"'1;2,7' names agent 7 outside 1\.\.6"),
        (['target.angles_deg={"1;2,2"=90.0}'], r"alpha\(1;2,2\) does not name three distinct agents"),
        (['target.angles_deg={"123"=90.0}'], "expected a name as in '3;2,4', got '123'"),
        (["arena.x_m=[1, -1]"], r"arena: x must be \(low, high\) in m"),
        (["law.first_follower=bearing"], "law.first_follower: 'bearing' needs phases to follow"),
        (["plant.control_period_s=1e-9"], "duration_s: expected at most 1000000 control periods"),
    ],
)
def test_what_cannot_be_built_is_refused_with_file_and_field(changes: list[str], message: str) -> None:
    with pytest.raises(InputError, match=rf"^shape: .*{message}"):
        open_experiment("shape", tuple(changes))


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan, np.inf, 1e9])
def test_a_duration_that_is_no_time_is_refused(duration: float) -> None:
    with pytest.raises(InputError, match="--duration: expected"):
        open_experiment("shape", (), duration)


def test_a_first_follower_that_moves_needs_its_displacement_in_every_phase(varied: Varied) -> None:
    for displacement, message in ((None, "missing"), ([0.0, 0.0], "one place")):
        phase = {"name": "a", "duration_s": 1.0} | ({} if displacement is None else {"displacement_m": displacement})
        with pytest.raises(InputError, match=rf"phases\[1\].displacement_m: .*{message}"):
            varied(without="duration_s", phases=[phase], law={"first_follower": "displacement"})


@pytest.mark.parametrize("name", library())
def test_every_scenario_of_the_library_opens(name: str) -> None:
    assert open_experiment(name).n >= 3


def test_a_scenario_may_be_named_by_a_path_object() -> None:
    path = LIBRARY / "shape.toml"
    assert (
        open_experiment(path).file.sha256
        == open_experiment(str(path)).file.sha256
        == open_experiment("shape").file.sha256
    )
