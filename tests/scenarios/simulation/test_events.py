"""Each kind of event does what it says, at the time it says, and nothing before."""

import json
from typing import Any

import numpy as np
import pytest

from robots.testbed import OBSTACLE_DISTANCE
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.figures.films.film import Film
from scenarios.figures.films.layout import Frame
from scenarios.figures.style import print_style
from scenarios.measures.metrics import measure
from scenarios.measures.predictions.remarks import remarks
from scenarios.measures.predictions.stops import spreads
from scenarios.measures.result import result
from scenarios.simulation.loop import simulate, step_by_step
from scenarios.simulation.trajectory import Trajectory

AT, UNTIL, LENGTH = 4.0, 6.0, 8.0
PERIOD = 0.03125
"""Seconds; a power of two, so that periods are the same with and without a cut."""

SQUARE = "[[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [2, 1]]"
PLAIN: dict[str, dict[str, Any]] = {
    "stop": {"agent": 4, "until_s": UNTIL},
    "push": {"agent": 4, "displacement_m": [0.1, -0.05]},
    "dropout": {"agent": 4, "until_s": UNTIL},
    "edge-loss": {"edge": [4, 3], "until_s": UNTIL},
    "sensor": {"sensing_range_m": 0.5, "until_s": UNTIL},
    "message-loss": {"message_loss": 1.0, "until_s": UNTIL},
    "reshape": {"target_m": json.loads(SQUARE)},
    "obstacle": {"vertices_m": [[0.0, 0.0]], "radius_m": 0.1},
}
SCENARIO = {"message-loss": "consensus-velocity"}


def toml(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(each)}" for key, each in value.items()) + "}"
    return json.dumps(value)


def opened(*events: dict[str, Any], name: str = "shape", plant: str = "unicycle", changes: tuple[str, ...] = ()) -> Any:
    fixed = (f"plant.name={plant}", f"plant.control_period_s={PERIOD}", "safety.filter=none", *changes)
    return open_experiment(name, (*fixed, f"events=[{', '.join(map(toml, events))}]"), LENGTH)


def one(kind: str, **keys: Any) -> dict[str, Any]:
    return {"t_s": AT, "kind": kind, **(keys or PLAIN[kind])}


def speeds(trajectory: Trajectory, begin: float, end: float) -> np.ndarray:
    """(n,) the largest step of each agent between two times, m/s."""
    rows = (trajectory.t >= begin) & (trajectory.t <= end)
    return np.linalg.norm(np.diff(trajectory.points[rows], axis=0), axis=-1).max(axis=0) / PERIOD


@pytest.mark.parametrize("kind", PLAIN)
def test_a_run_is_the_same_until_an_event_and_not_after_it(kind: str) -> None:
    name, plant = SCENARIO.get(kind, "shape"), "pymunk" if kind == "obstacle" else "unicycle"
    with_it, without, again = (
        step_by_step(opened(*events, name=name, plant=plant), 3) for events in ([one(kind)], [], [one(kind)])
    )
    until = without.t <= AT
    assert (with_it.t == without.t).all()
    assert (with_it.points[until] == without.points[until]).all()
    assert not (with_it.points[~until][1:] == without.points[~until][1:]).all()
    assert (with_it.poses == again.poses).all()


def test_a_stopped_robot_stands_still_while_it_is_stopped_and_then_goes_on() -> None:
    found = simulate(opened(one("stop")), 0)
    assert speeds(found, AT, UNTIL)[3] == 0.0
    assert (speeds(found, AT, UNTIL)[[2, 4, 5]] > 0.0).all()
    assert speeds(found, AT - 1.0, AT)[3] > 0.0
    assert speeds(found, UNTIL, LENGTH)[3] > 0.0


@pytest.mark.parametrize("plant", ["single_integrator", "unicycle", "saturated"])
def test_a_push_moves_a_robot_without_mass_by_its_displacement(plant: str) -> None:
    still = one("stop", agent=4) | {"t_s": 1.0}
    found = simulate(opened(still, one("push"), plant=plant), 0)
    row = int(np.searchsorted(found.t, AT))
    np.testing.assert_allclose(found.points[row + 1, 3] - found.points[row, 3], [0.1, -0.05], atol=1e-12)


@pytest.mark.parametrize("way", [0.05, 0.2])
def test_a_push_lets_a_robot_with_mass_slide_about_as_far(way: float) -> None:
    everyone = [one("stop", agent=agent) | {"t_s": 0.0} for agent in range(1, 7)]
    found = simulate(opened(*everyone, one("push", agent=1, displacement_m=[0.0, -way]), plant="pymunk"), 0)
    slid = np.linalg.norm(found.poses[-1, 0, :2] - found.poses[0, 0, :2])
    assert slid == pytest.approx(way, rel=0.15)
    assert speeds(found, AT + 0.5, LENGTH)[0] < 1e-6


@pytest.mark.parametrize(("kind", "still"), [("dropout", [4, 5]), ("edge-loss", [3])])
def test_who_does_not_sense_a_neighbour_holds_still(kind: str, still: list[int]) -> None:
    found = simulate(opened(one(kind)), 0)
    moving = [row for row in (2, 3, 4, 5) if row not in still]
    assert (speeds(found, AT, UNTIL)[still] == 0.0).all()
    assert (speeds(found, AT, UNTIL)[moving] > 0.0).all()
    assert (speeds(found, UNTIL, LENGTH)[still] > 0.0).all()


def test_who_keeps_its_last_command_goes_straight_on() -> None:
    event = one("edge-loss", edge=[4, 3], until_s=4.5)
    kept = simulate(opened(event, plant="single_integrator", changes=('law.without_neighbour="keep-last"',)), 0)
    rows = (kept.t >= AT) & (kept.t <= 4.5)
    steps = np.diff(kept.points[rows, 3], axis=0)
    np.testing.assert_allclose(steps, np.broadcast_to(steps[0], steps.shape), atol=1e-13)
    assert np.linalg.norm(steps[0]) > 1e-4


def test_another_pair_takes_a_follower_to_the_same_place_while_holding_still_never_gets_there() -> None:
    lost = one("edge-loss", edge=[4, 3]) | {"t_s": 0.0}
    far = []
    for choice in ("another-pair", "hold-still"):
        changes = ("plant.name=single_integrator", f'law.without_neighbour="{choice}"', f"events=[{toml(lost)}]")
        experiment = open_experiment("shape", changes, 40.0)
        found = simulate(experiment, 0)
        far.append(float(measure(experiment, found).error_sum[-1]))
    assert far[0] < 1e-4
    assert far[1] > 0.1


def test_a_sensing_range_is_the_distance_up_to_which_followers_move() -> None:
    short, long = (simulate(opened(one("sensor", sensing_range_m=reach, until_s=UNTIL)), 0) for reach in (1e-3, 50.0))
    assert (speeds(short, AT, UNTIL) == 0.0).all()
    assert (speeds(short, UNTIL, LENGTH)[2:] > 0.0).all()
    assert (long.points == step_by_step(opened(), 0).points).all()


def test_a_field_of_view_decides_by_where_a_robot_points() -> None:
    experiment = opened(one("sensor", field_of_view_deg=120.0, until_s=AT + PERIOD))
    found = simulate(experiment, 0)
    row = int(np.searchsorted(found.t, AT))
    observer, observed = experiment.graph.edges.T
    e = (found.points[row, observed] - found.points[row, observer]).view(np.complex128)[:, 0]
    seen = np.abs(np.angle(e * np.exp(-1j * found.poses[row, observer, 2]))) <= np.radians(60.0)
    blind = np.unique(observer[~seen & (observer > 1)])
    moved = np.linalg.norm(found.points[row + 1] - found.points[row], axis=-1) > 0.0
    assert blind.size
    assert not moved[blind].any()
    assert moved[np.setdiff1d(np.arange(2, 6), blind)].all()


def test_lost_messages_leave_every_estimate_as_it_is() -> None:
    changes = ("phases.1.velocity_m_s=[0.02, 0.0]",)
    silent = one("message-loss", message_loss=1.0) | {"t_s": 0.0}
    found = simulate(opened(silent, name="consensus-velocity", plant="single_integrator", changes=changes), 0)
    heard = simulate(opened(name="consensus-velocity", plant="single_integrator", changes=changes), 0)
    assert found.points[-1, 0] == pytest.approx(heard.points[-1, 0])
    assert np.linalg.norm(found.points[-1] - heard.points[-1], axis=-1)[1:].min() > 0.01


def test_a_reshape_begins_a_phase_with_angles_of_the_new_shape() -> None:
    changes = ("plant.name=single_integrator", f"events=[{toml(one('reshape') | {'t_s': 30.0, 'name': 'block'})}]")
    experiment: Experiment = open_experiment("shape", changes, 100.0)
    found = simulate(experiment, 0)
    metrics = measure(experiment, found)
    assert [phase.name for phase in experiment.phases] == ["shape", "block"]
    assert [end.row for end in metrics.phases] == [int(np.searchsorted(found.t, 30.0)), len(found.t) - 1]
    wanted = experiment.angles.measure(np.array(json.loads(SQUARE), dtype=float))
    np.testing.assert_allclose(experiment.angles.errors(found.points[-1], wanted), 0.0, atol=1e-4)
    assert metrics.outcome == "converged"


def test_a_reshape_may_bring_another_graph() -> None:
    neighbours = [[], [1], [1, 2], [1, 2], [2, 3], [2, 5]]
    event = one("reshape", target_m=json.loads(SQUARE), neighbours=neighbours)
    experiment = opened(event, plant="single_integrator")
    assert experiment.of_phase(1).graph.edges[3:5].tolist() == [[3, 0], [3, 1]]
    assert experiment.of_phase(0).graph.edges[3:5].tolist() == [[3, 1], [3, 2]]


def test_an_obstacle_stops_robots_from_its_time_on_and_until_it_is_gone() -> None:
    changes = ("safety.filter=decentralised",)
    start = opened(plant="pymunk").initial_points(0)
    place = {"vertices_m": [(start[0] + [0.0, 0.3]).tolist()], "radius_m": 0.05}
    event = {"t_s": 2.0, "kind": "obstacle", **place}
    experiment = opened(event, plant="pymunk", changes=changes)
    found = simulate(experiment, 0)
    gap = experiment.arena.obstacles[0].distance(found.points[found.t >= 2.5])
    assert gap.min() > 0.0


def test_an_obstacle_is_judged_while_it_stands_and_at_no_other_time() -> None:
    """One stands where agent 4 starts once that has gone, the other where agent 6 will be and is away by then."""
    plain = opened(plant="saturated")
    start, end = plain.initial_points(0)[3], simulate(plain, 0).points[-1, 5]
    early = {"t_s": 0.0, "until_s": 1.0, "kind": "obstacle", "vertices_m": [end.tolist()], "radius_m": 0.02}
    late = {"t_s": 6.0, "kind": "obstacle", "vertices_m": [start.tolist()], "radius_m": 0.02}
    experiment = opened(early, late, plant="saturated")
    metrics = measure(experiment, simulate(experiment, 0))
    assert "obstacle" not in [each.kind for each in metrics.verdict.violations]
    assert metrics.clearance is not None
    assert metrics.clearance.points.distance.min() > OBSTACLE_DISTANCE
    assert not any("obstacle" in line for line in remarks(experiment, 0))
    always = opened({**early, "until_s": 7.9}, {**late, "t_s": 0.0}, plant="saturated")
    assert "obstacle" in [each.kind for each in measure(always, simulate(always, 0)).verdict.violations]
    assert any("run starts" in line and "obstacle 2" in line for line in remarks(always, 0))


def test_a_film_shows_an_obstacle_of_an_event_while_it_stands() -> None:
    experiment = opened(one("obstacle", vertices_m=[[1.2, 0.8]], radius_m=0.1, until_s=UNTIL), plant="saturated")
    trajectory = simulate(experiment, 0)
    with print_style():
        film = Film(experiment, trajectory, measure(experiment, trajectory), 1.0, 1.0, Frame())
    x, y = film.floor.transData.transform([1.2, 0.8]).astype(int)
    with print_style():
        seen = [tuple(frame[frame.shape[0] - y, x, :3]) != (255, 255, 255) for frame in film.frames()]
    assert seen == [AT <= round(trajectory.t[row]) < UNTIL for row in film.rows]


@pytest.mark.parametrize("safety", ["none", "decentralised"])
def test_the_error_that_a_stop_spreads_is_the_predicted_one(safety: str) -> None:
    phase = "{name='go', duration_s=60.0, velocity_m_s=[0.01, 0.0], displacement_m=[0.7, 0.0]}"
    stop = toml({"t_s": 45.0, "kind": "stop", "agent": 4, "until_s": 55.0})
    changes = (f"phases=[{phase}]", f"safety.filter={safety}", f"events=[{stop}]", "plant.name=unicycle")
    experiment = open_experiment("maneuver", changes)
    found = simulate(experiment, 0)
    content = result(experiment, 0, found, measure(experiment, found))["events"][0]
    predicted, measured = (np.array(content["offsets_m"][key]) for key in ("predicted", "measured"))
    off = predicted > 0.01
    assert (np.flatnonzero(off) + 1).tolist() == [4, 5, 6]
    np.testing.assert_allclose(measured[off], predicted[off], rtol=0.05)
    assert (measured[~off] < 0.002).all()
    assert spreads(experiment, found.points[0])[0].time == 55.0


EARLY = {"t_s": 1.0}
REFUSED = [
    ([one("stop", agent=3) | {"t_s": 500.0}], r"events\[1\].t_s: expected less than the run's .* s, got 500"),
    ([one("stop", agent=3, until_s=3.0)], r"events\[1\].until_s: expected more than t_s, 4, .* got 3"),
    ([one("stop", agent=3, until_s=900.0)], r"events\[1\].until_s: .* at most the run's .* got 900"),
    ([one("stop", agent=60)], r"events\[1\].agent: no agent 60, did you mean '6'\?"),
    ([one("push", agent=9, displacement_m=[1, 0])], r"events\[1\].agent: no agent 9, known: 1, 2, 3, 4, 5, 6"),
    ([one("edge-loss", edge=[4, 1])], r"events\[1\].edge: there is no edge \[4, 1\], agent 4 senses 2, 3"),
    (
        [one("reshape", target_m=[[0, 0], [1, 0]])],
        r"events\[1\].target_m: expected 6 entries, one for each agent, got 2",
    ),
    ([one("reshape", target_m=[[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]])], r"events\[1\].*Assumption 2"),
    ([one("stop", agent=3), one("stop", agent=3) | EARLY], r"events\[2\].t_s: overlaps events\[1\].*for good, got 1"),
    ([one("stop", agent=3, edge=[4, 3])], r'events\[1\].edge: only for kind = "edge-loss", got "stop"'),
    ([one("stop", until_s=5.0)], r'events\[1\].agent: missing, kind = "stop" needs it'),
    ([one("sensor", until_s=5.0)], r"events\[1\]: expected one of sensing_range_m, .* got none"),
    ([one("message-loss")], r'events\[1\].kind: only for velocity_known_by = "leader", got "all"'),
    ([one("push", agent=3, displacement_m=[0, 0])], r"events\[1\].displacement_m: expected a way"),
    ([one("obstacle", vertices_m=[[0, 0], [0, 0]])], r"events\[1\].vertices_m: the ends of a segment must differ"),
    ([one("stopp", agent=3)], r"events\[1\].kind: expected 'stop', .* got 'stopp'"),
    ([one("stop", agnet=3)], r"events\[1\].agnet: unknown key, did you mean 'agent'\?"),
]


@pytest.mark.parametrize(("events", "message"), REFUSED)
def test_a_bad_event_is_refused_in_one_line_that_names_it(events: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        opened(*events)
    assert "\n" not in str(refused.value)


def test_a_field_of_view_is_for_robots_with_a_front() -> None:
    with pytest.raises(InputError, match="has points without a front"):
        opened(one("sensor", field_of_view_deg=90.0), plant="single_integrator")


def test_another_pair_is_for_the_angle_law_without_feed_forward() -> None:
    pair = 'law.without_neighbour="another-pair"'
    with pytest.raises(InputError, match=r'law.without_neighbour: "another-pair" is for law.name = "angle", got "dist'):
        open_experiment("law-distance", (pair,))
    with pytest.raises(InputError, match=r"law.feedforward: it is of one pair"):
        open_experiment("circle", (pair,))
