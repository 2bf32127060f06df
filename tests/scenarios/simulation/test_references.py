"""Formations on curves, from scenario files: exact with feed-forward, as far behind as predicted without."""

from pathlib import Path

import numpy as np
import pytest

from formation.plane import as_complex
from formation.references.lag import shape_residual
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.errors import InputError
from scenarios.measures.predictions.course import course
from scenarios.measures.predictions.forecast import forecast
from scenarios.measures.predictions.theory import motion, moves_exactly
from scenarios.measures.predictions.way import way
from scenarios.measures.tracking import following, reference
from scenarios.simulation.loop import simulate

IDEAL = "plant.name=single_integrator"


def opened(name: str, *changes: str, omega: float = 0.2) -> Experiment:
    return open_experiment(name, (IDEAL, f"reference.period_s={2.0 * np.pi / omega}", *changes), 80.0)


def residual(experiment: Experiment, seconds: float = 0.0) -> float:
    """The largest shape residual over the last seconds of a run."""
    trajectory = simulate(experiment, 0)
    late = trajectory.t >= trajectory.t[-1] - seconds
    return float(shape_residual(experiment.target, as_complex(trajectory.points[late])).max())


@pytest.mark.parametrize("omega", [0.1, 0.5])
@pytest.mark.parametrize("name", ["circle", "figure-eight"])
def test_without_a_compass_feed_forward_is_exact(name: str, omega: float) -> None:
    assert residual(opened(name, "law.first_follower=stationary", omega=omega)) < 1e-12


def test_a_displacement_first_follower_is_exact_up_to_the_fourth_power_of_the_step() -> None:
    fine, coarse = (residual(opened("circle", f"plant.control_period_s={h}", omega=0.5)) for h in (0.04, 0.08))
    assert fine < 1e-8
    assert 14.0 < coarse / fine < 18.0


def in_place(experiment: Experiment) -> list[str]:
    """The changes that let everybody begin in its place."""
    places = following(experiment, experiment.initial_points(0), np.zeros(1))[0]
    return [f"agents.{k}.start={place}" for k, place in enumerate(places.tolist(), start=1)]


def begun_in_place(name: str, omega: float, period: float, *changes: str) -> Experiment:
    """For one round."""
    changed = (IDEAL, f"reference.period_s={2.0 * np.pi / omega}", f"plant.control_period_s={period}", *changes)
    experiment = open_experiment(name, changed, 2.0 * np.pi / omega)
    return open_experiment(name, (*changed, *in_place(experiment)), 2.0 * np.pi / omega)


def test_where_a_figure_eight_turns_three_times_as_fast_as_on_average_steps_are_shorter() -> None:
    """It turns at up to 1.6 rad/s, where one step in 33 ms leaves 4.4e-8."""
    fine, coarse = (residual(begun_in_place("figure-eight", 0.5, h), 99.0) for h in (0.04, 0.08))
    assert fine < 1e-8
    assert 14.0 < coarse / fine < 18.0


def test_one_step_a_period_leaves_the_first_follower_of_a_circle_off_by_the_error_constant_of_runge_kutta() -> None:
    """The settled motion of e' = (mu - 1) e + delta D(t), D = e^{i w t}, mu = i w, under the classical method: with
    k_1 .. k_4 of one step from e, e_next = e e^{i w h} has the solution e = delta (1 - c h^4 + ...) with the constant
    c below. At w = 1.59, the sharpest turn of the figure eight at 0.5, c h^4 = 1.7e-7 for h = 33 ms: no single step of
    the method can be exact to 1e-8 there.
    """

    def share(omega: float, h: float) -> complex:
        return h**4 * omega**2 * (24j * omega**3 - 75.0 * omega**2 - 80j * omega + 30.0) / 2880.0

    omega, h = 0.5, 0.02
    run = as_complex(simulate(begun_in_place("circle", omega, h), 0).points)[-1]
    assert (run[1] - run[0]) / 0.4 - 1.0 == pytest.approx(-share(omega, h), rel=0.03)
    assert abs(share(1.59, 0.033)) > 1e-7


@pytest.mark.parametrize(("name", "omega"), [("circle", 0.2), ("figure-eight", 0.2)])
def test_without_feed_forward_the_lag_is_the_predicted_one(name: str, omega: float) -> None:
    experiment = opened(name, "law.feedforward=false", omega=omega)
    known = course(experiment, experiment.initial_points(0))
    assert known is not None
    assert known.lag is not None
    assert residual(experiment, 2.0 * np.pi / omega) == pytest.approx(known.lag[0], rel=0.01)


@pytest.mark.parametrize(("told", "within"), [("true", 0.15), ("false", 0.01)])
def test_robots_that_hold_commands_lag_as_predicted(told: str, within: float) -> None:
    experiment = opened("figure-eight", "plant.name=unicycle", "safety.filter=none", f"law.feedforward={told}")
    known = course(experiment, experiment.initial_points(0))
    assert known is not None
    assert known.lag is not None
    assert residual(experiment, 2.0 * np.pi / 0.2) == pytest.approx(known.lag[0], rel=within)


def test_robots_that_a_filter_turns_lag_as_predicted() -> None:
    experiment = open_experiment("circle", ("plant.name=saturated",), 60.0)
    known = course(experiment, experiment.initial_points(0))
    assert known is not None
    assert known.lag is not None
    assert residual(experiment, 5.0) == pytest.approx(known.lag[0], rel=0.01)


def test_all_agents_end_where_the_reference_puts_them() -> None:
    experiment = opened("figure-eight")
    trajectory = simulate(experiment, 0)
    np.testing.assert_allclose(trajectory.points[-1], reference(experiment, trajectory)[-1], atol=1e-7)


@pytest.mark.parametrize("safety", ["none", "decentralised"])
def test_wheels_are_outrun_when_and_by_whom_it_is_told(tmp_path: Path, safety: str) -> None:
    text = (LIBRARY / "circle.toml").read_text(encoding="utf-8")
    head, rest = text.split("[reference]")
    _, rest = rest.split("[arena]")
    points = 'kind = "way-points"\nfile = "way.csv"\ndisplacement_m = [0.4, 0.0]\n'
    (tmp_path / "way.toml").write_text(f"{head}[reference]\n{points}\n[arena]{rest}", encoding="utf-8")
    (tmp_path / "way.csv").write_text("t_s,x_m,y_m,turn_deg\n0,0,0,0\n40,0,0,0\n60,0.3,0,180\n80,0.5,0,540\n")
    changes = ("plant.name=saturated", f"safety.filter={safety}", "arena.walls=false")
    experiment = open_experiment(str(tmp_path / "way.toml"), changes)
    known = course(experiment, experiment.initial_points(0))
    assert known is not None
    assert known.outrun is not None
    trajectory = simulate(experiment, 0)
    limit = experiment.robot.drive.wheel_speed_limit
    at_limit = np.abs(trajectory.wheel_speeds).max(axis=-1) >= limit * (1.0 - 2e-6)  # the filter stays 1e-6 below
    row = int(np.flatnonzero(at_limit.any(axis=1) & (trajectory.t > 30.0))[0])
    assert trajectory.t[row] == pytest.approx(known.outrun.time, abs=0.15)
    assert np.flatnonzero(at_limit[row]).tolist() == [known.outrun.row]


def test_a_file_of_way_points_is_the_scenario_with_these_points(tmp_path: Path) -> None:
    text = (LIBRARY / "circle.toml").read_text(encoding="utf-8")
    start, end = text.index("[reference]"), text.index("[arena]")
    listed = "points = [{ t_s = 0, position_m = [0, 0] }, { t_s = 9, position_m = [1, 2], scale = 0.5, turn_deg = 30 }]"
    digests = []
    for name, points in (("listed", listed), ("filed", 'file = "way.csv"')):
        table = f'[reference]\nkind = "way-points"\n{points}\n\n'
        (tmp_path / f"{name}.toml").write_text(text[:start] + table + text[end:], encoding="utf-8")
        (tmp_path / "way.csv").write_text("t_s, x_m, y_m, scale, turn_deg\n0, 0, 0, 1, 0\n\n9, 1, 2, 0.5, 30\n")
        digests.append(open_experiment(str(tmp_path / f"{name}.toml")).file.sha256)
    assert digests[0] == digests[1]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "line 1: column t_s is missing"),
        ("t_s,x_m,y_m,skale\n", "line 1: unknown column 'skale', did you mean 'scale'"),
        ("t_s,x_m,y_m\n0,0\n", "line 2: expected 3 cells, got 2"),
        ("t_s,x_m,y_m\n0,0,0\n1,here,0\n", "line 3: x_m: expected a number, got 'here'"),
        ("t_s,x_m,y_m\n0,0,0\n", "at least two of them, got 1"),
        ("t_s,x_m,y_m\n1,0,0\n2,0,0\n", "the first is 1"),
        ("t_s,x_m,y_m\n0,0,0\n5,0,0\n3,0,0\n", "number 3 is 3 after 5"),
        ("t_s,x_m,y_m,x_m\n0,0,0,0\n", "line 1: column x_m is there 2 times"),
        ("t_s,x_m,y_m\n0,0,0\n1,nan,0\n", r"reference.points\[2\].position_m"),
        (None, "cannot be read: No such file"),
    ],
)
def test_a_file_that_holds_no_way_points_is_refused_with_its_place(
    tmp_path: Path, content: str | None, message: str
) -> None:
    text = (LIBRARY / "circle.toml").read_text(encoding="utf-8")
    table = '[reference]\nkind = "way-points"\nfile = "way.csv"\n\n'
    start, end = text.index("[reference]"), text.index("[arena]")
    (tmp_path / "way.toml").write_text(text[:start] + table + text[end:], encoding="utf-8")
    if content is not None:
        (tmp_path / "way.csv").write_text(content)
    with pytest.raises(InputError, match=message):
        open_experiment(str(tmp_path / "way.toml"))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (("reference.height_m=1.0",), "reference.height_m: a circle has its width alone"),
        (("reference.kind=ellipse",), "reference.height_m: missing, the ellipse needs it"),
        (("reference.speed_m_s=0.1",), "expected either period_s or speed_m_s, got both"),
        (("reference.kind=way-points",), "reference.width_m: only for closed curves"),
        (
            ("reference={kind='way-points', points=[{t=0.0, position_m=[0, 0]}]}",),
            r"points\[1\].t: unknown key, known: t_s",
        ),
        (("reference.file=way.csv",), 'reference.file: only for kind = "way-points", got "circle"'),
        (("reference.displacement_m=[0, 0]",), "reference.displacement_m: agents 1 and 2 must not"),
        (("law.activation=sequential",), "law.feedforward: followers that wait cannot follow"),
        (("law.name=displacement", "law.first_follower=stationary"), "law.feedforward: only for law.name"),
    ],
)
def test_references_that_make_no_sense_are_refused(changes: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        open_experiment("circle", changes)


RAMPS = "[{t_s=0.0, velocity_m_s=[0.0, 0.0]}, {t_s=8.0, velocity_m_s=[0.04, 0.0]}, {t_s=12.0, velocity_m_s=[0.0, 0.0]}]"


def test_a_formation_on_ramps_follows_its_leader_exactly_where_v_r_is_known_to_all() -> None:
    changes = ("law.feedforward=false", f"reference={{kind='ramps', velocities={RAMPS}, displacement_m=[0.4, 0.0]}}")
    experiment = open_experiment("circle", (IDEAL, *changes), 60.0)
    trajectory = simulate(experiment, 0)
    np.testing.assert_allclose(trajectory.points[-1], reference(experiment, trajectory)[-1], atol=1e-6)
    assert trajectory.points[-1, 0, 0] - trajectory.points[0, 0, 0] == pytest.approx(0.04 * 12.0 / 2.0, abs=1e-4)


TOLD = """velocities = [
    { t_s = 0.0, velocity_m_s = [0.02, -0.01] },
    { t_s = 7.01, velocity_m_s = [0.0, 0.02], scale = 0.9, turn_deg = 40.0 },
    { t_s = 20.0, scale = 1.1, turn_deg = 40.0 },
    { t_s = 31.5, velocity_m_s = [0.01, 0.0], turn_deg = -60.0 },
]"""


def on_ramps(tmp_path: Path, first_follower: str, *changes: str) -> Experiment:
    path = filed(tmp_path, f'kind = "ramps"\ndisplacement_m = [0.4, 0.1]\n{TOLD}')
    return open_experiment(path, (IDEAL, f"law.first_follower={first_follower}", *changes), 40.0)


@pytest.mark.parametrize("first_follower", ["stationary", "displacement"])
def test_behind_ramps_agents_move_exactly_as_predicted(tmp_path: Path, first_follower: str) -> None:
    experiment = on_ramps(tmp_path, first_follower, "law.feedforward=false")
    trajectory = simulate(experiment, 0)
    np.testing.assert_allclose(motion(experiment, trajectory.points[0], 0), trajectory.points, atol=1e-6)
    ahead = forecast(experiment, trajectory.points[0])[0]
    assert ahead.points is not None
    assert ahead.arrival is None
    np.testing.assert_allclose(ahead.points, trajectory.points[-1], atol=1e-6)


@pytest.mark.parametrize("first_follower", ["stationary", "displacement"])
def test_with_feed_forward_everybody_stays_in_place_through_every_bend_of_ramps(
    tmp_path: Path, first_follower: str
) -> None:
    experiment = on_ramps(tmp_path, first_follower, *in_place(on_ramps(tmp_path, first_follower)))
    trajectory = simulate(experiment, 0)
    np.testing.assert_allclose(trajectory.points, reference(experiment, trajectory), atol=1e-8)


def test_what_is_told_of_the_lag_behind_ramps_is_what_agents_do_that_begin_in_their_places(tmp_path: Path) -> None:
    changes = ("displacement", "law.feedforward=false")
    experiment = on_ramps(tmp_path, *changes)
    told = course(experiment, experiment.initial_points(0))
    assert told is not None
    assert told.lag is not None
    begun = on_ramps(tmp_path, *changes, *in_place(experiment))
    assert residual(begun, 40.0) == pytest.approx(told.lag[0], abs=1e-7)
    assert told.lag[0] > 0.05


@pytest.mark.parametrize("first_follower", ["stationary", "displacement"])
def test_where_v_r_spreads_by_consensus_on_ramps_agents_move_exactly_as_predicted(
    tmp_path: Path, first_follower: str
) -> None:
    spread = ("law.feedforward=false", "velocity_known_by=leader", "communication.gain_per_s=1.0")
    experiment = on_ramps(tmp_path, first_follower, *spread)
    trajectory = simulate(experiment, 0)
    assert moves_exactly(experiment)
    np.testing.assert_allclose(motion(experiment, trajectory.points[0], 0), trajectory.points, atol=1e-6)
    ahead = forecast(experiment, trajectory.points[0])[0].points
    assert ahead is not None
    np.testing.assert_allclose(ahead, trajectory.points[-1], atol=1e-6)
    t, points = way(experiment, trajectory.points[0]) or (np.zeros(0), np.zeros(0))
    np.testing.assert_allclose(points[-1], trajectory.points[-1], atol=1e-6)
    assert t[-1] == trajectory.t[-1]
    assert not moves_exactly(on_ramps(tmp_path, first_follower, *spread, "communication.message_loss=0.1"))


@pytest.mark.parametrize("plant", ["single_integrator", "unicycle"])
def test_where_v_r_spreads_by_consensus_each_phase_is_the_predicted_one(plant: str) -> None:
    changes = ("safety.filter=none",) if plant == "unicycle" else ()
    experiment = open_experiment("consensus-velocity", (f"plant.name={plant}", *changes))
    trajectory = simulate(experiment, 0)
    for index in range(len(experiment.phases)):
        rows = np.flatnonzero(trajectory.phase == index)
        rows = rows if index == 0 else np.insert(rows, 0, rows[0] - 1)
        exact = motion(experiment, trajectory.points[rows[0]], index)
        if plant == "single_integrator":
            np.testing.assert_allclose(exact, trajectory.points[rows], atol=1e-6)
        np.testing.assert_allclose(exact[-1], trajectory.points[rows[-1]], atol=5e-3)  # robots turn first


def test_commands_that_are_held_on_ramps_are_ramps_as_periods_shrink(tmp_path: Path) -> None:
    errors = []
    for period in (0.04, 0.02):
        at = ("law.feedforward=false", f"plant.control_period_s={period}")
        smooth = on_ramps(tmp_path, "displacement", *at)
        held = on_ramps(tmp_path, "displacement", *at, "plant.name=unicycle", "safety.filter=none")
        start = smooth.initial_points(0)
        errors.append(np.abs(motion(held, start, 0) - motion(smooth, start, 0)).max())
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ((f"reference.velocities={RAMPS}",), 'reference.velocities: only for kind = "ramps", got "circle"'),
        (("reference={kind='ramps'}",), "reference.velocities: times must begin with 0 and increase"),
        (("reference.kind=ramps",), "reference.width_m: only for closed curves, ramps have times and velocities"),
    ],
)
def test_ramps_that_make_no_sense_are_refused(changes: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        open_experiment("circle", ("law.feedforward=false", *changes))


FUNCTION = """
from math import cos, degrees, sin

def way(t):
    return 0.5 * sin(0.2 * t), 0.5 - 0.5 * cos(0.2 * t), 1.0, degrees(0.2 * t)

def short(t):
    return (1.0,)

def shrinking(t):
    return 0.0, 0.0, 1.0 - t / 45.0, 0.0

def failing(t):
    return t / 0.0, 0.0
"""


def filed(tmp_path: Path, table: str) -> str:
    text = (LIBRARY / "circle.toml").read_text(encoding="utf-8")
    start, end = text.index("[reference]"), text.index("[arena]")
    (tmp_path / "way.toml").write_text(f"{text[:start]}[reference]\n{table}\n\n{text[end:]}", encoding="utf-8")
    (tmp_path / "way.py").write_text(FUNCTION)
    return str(tmp_path / "way.toml")


def test_a_python_function_is_followed_as_the_curve_that_it_describes(tmp_path: Path) -> None:
    path = filed(tmp_path, 'kind = "way-points"\nfile = "way.py"\nfunction = "way"\ndisplacement_m = [0.4, 0.0]')
    experiment = open_experiment(path, (IDEAL,))
    told = experiment.phases[0].reference
    assert told is not None
    t = np.linspace(0.0, experiment.phases[0].duration, 997)
    np.testing.assert_allclose(told.path(t), 0.5 * np.sin(0.2 * t) + 0.5j * (1.0 - np.cos(0.2 * t)), atol=1e-8)
    np.testing.assert_allclose(told.velocity(t[:-1]), 0.1 * np.exp(0.2j * t[:-1]), atol=1e-6)
    np.testing.assert_allclose(told.rate(t[:-1]), 0.2j, atol=1e-6)
    assert experiment.file.scenario.reference is not None
    assert experiment.file.scenario.reference.file is None
    assert residual(experiment) < 1e-5


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('file = "way.py"', "reference.function: missing, the name of a function in"),
        ('file = "way.py"\nfunction = "wya"', "has no function 'wya', did you mean 'way'"),
        ('file = "way.py"\nfunction = "short"', r"short\(0\): expected \(x_m, y_m\) or \(x_m, y_m, scale, turn_deg\)"),
        ('file = "way.py"\nfunction = "failing"', r"way.py:14: failing\(0\) raised ZeroDivisionError"),
        ('file = "no.py"\nfunction = "way"', "reference.file: no such file"),
        ('function = "way"\npoints = []', "reference.function: only with reference.file, a Python file"),
        ('file = "way.toml"\nfunction = "way"', r"reference.function: only with a Python file, NAME.py, got way.toml"),
        ('file = "way.py"\nfunction = "shrinking"', r"shrinking\(45\): scale: expected above 0, got 0"),
    ],
)
def test_a_function_that_makes_no_way_is_refused_with_its_place(tmp_path: Path, table: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        open_experiment(filed(tmp_path, f'kind = "way-points"\n{table}'))
