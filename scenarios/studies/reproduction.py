"""The paper's numbers beside what every plant measures: docs/reproduction.md, made by ``formation reproduce``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from formation import agents, decay_rates
from robots import GTERNAL, PLANTS
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.documents import cell, markdown_table
from scenarios.measures.metrics import measure
from scenarios.measures.result import result, versions
from scenarios.measures.tracking import predicted_ends
from scenarios.simulation.compiling import compile_for
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.work.processes import run_all

Real = NDArray[np.float64]

SEED = 0
"""Of every run: the paper's headings are random and not given."""

SHAPE, MANEUVER = "shape", "maneuver"
"""The library's scenarios with the paper's two experiments."""

OFFSET = (0.08, 0.06)
"""Metres by which one follower starts off its place, all others in theirs, to measure its own rate."""

RATE_DURATION = 30.0
"""Seconds of such a run."""

MACHINE = (
    ("width (m)", "0.11", GTERNAL.chassis.width),
    ("length (m)", "0.10", GTERNAL.chassis.length),
    ("largest speed (m/s)", "0.2", GTERNAL.drive.wheel_speed_limit * GTERNAL.drive.wheel_radius),
    (
        "largest turning speed (rad/s)",
        "3.6",
        2.0 * GTERNAL.drive.wheel_speed_limit * GTERNAL.drive.wheel_radius / GTERNAL.drive.base_length,
    ),
)
"""The robot as Section 4 describes it, and as it is simulated."""


@dataclass(frozen=True)
class Trial:
    """One run of the reproduction.

    Attributes:
        scenario: a library name.
        plant: the world.
        follower: the number of the only agent that starts off its place; None for the scenario's own starts.
    """

    scenario: str
    plant: str
    follower: int | None = None


Results = dict[Trial, dict[str, Any]]
"""``result.json`` of each trial; each of its phases has ``velocity_error_m_s``, the largest |v - v_r| at its end."""


def trials() -> list[Trial]:
    """Both experiments and each follower by itself, on every plant."""
    followers = agents.numbers(open_experiment(SHAPE).target.graph.followers).tolist()
    own = [Trial(scenario, plant) for scenario in (MANEUVER, SHAPE) for plant in PLANTS]
    return own + [Trial(SHAPE, plant, follower) for follower in followers for plant in PLANTS]


def reproduce(workers: int, on_progress: Callable[[int, int], None]) -> Results:
    """Run every trial."""
    queue = trials()
    compile_for(_open(queue[0]))
    results = {}
    for trial, found in zip(queue, run_all(run_trial, queue, workers), strict=True):
        results[trial] = found
        on_progress(len(results), len(queue))
    return results


def run_trial(trial: Trial) -> dict[str, Any]:
    """The result of one trial."""
    experiment = _open(trial)
    trajectory = simulate(experiment, SEED)
    metrics = measure(experiment, trajectory)
    found = result(experiment, SEED, trajectory, metrics)
    for index, end in enumerate(metrics.phases):
        error = _velocity_error(experiment, trajectory, end.row, index)
        found["phases"][index]["velocity_error_m_s"] = error
    return found


def _open(trial: Trial) -> Experiment:
    plant = f"plant.name={trial.plant}"
    if trial.follower is None:
        return open_experiment(trial.scenario, (plant,))
    ends = _ends(open_experiment(trial.scenario))
    ends[agents.rows(trial.follower)] += OFFSET
    starts = [f"agents.{agents.number(row)}.start={place}" for row, place in enumerate(ends.tolist())]
    return open_experiment(trial.scenario, (plant, *starts), RATE_DURATION)


def _ends(experiment: Experiment) -> Real:
    return predicted_ends(experiment, experiment.initial_points(SEED))[-1]


def _velocity_error(experiment: Experiment, trajectory: Trajectory, row: int, phase: int) -> float:
    moved = trajectory.points[row] - trajectory.points[row - 1]
    velocity = moved / (trajectory.t[row] - trajectory.t[row - 1])
    return float(np.linalg.norm(velocity - experiment.phases[phase].velocity, axis=1).max())


def markdown(results: Results) -> str:
    """The document."""
    parts = [_head(), _angles(results), _ends_table(results), _rates(results)]
    parts += [_phase_ends(results), _verdicts(results), _machine()]
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _head() -> list[str]:
    made = ", ".join(f"{name} {version}" for name, version in versions().items())
    return [
        "# The paper beside the runs",
        "",
        "What Li, Shen, Jing, Song state as a number, and what each plant measures. Nothing here is written by hand:",
        "`formation reproduce --markdown docs/reproduction.md` makes this page. Scenarios run as the library has them,",
        f"safety filter included. Headings are random in the paper and not given; here seed {SEED} draws them.",
        f"Made with {made}.",
    ]


def _angles(results: Results) -> list[str]:
    listed = open_experiment(SHAPE).scenario.target.angles_deg
    runs = [results[Trial(SHAPE, plant)]["angles"] for plant in PLANTS]
    rows = [
        (runs[0][index]["name"], f"{degrees:g}", *(cell(run[index]["final_deg"], ".4f") for run in runs))
        for index, degrees in enumerate(listed.values())
    ]
    return [
        "## Shape: the listed angles",
        "",
        "Degrees at the end of `shape`, of the projected points; the paper prints two decimals.",
        "",
        *markdown_table(("angle", "paper", *PLANTS), rows),
    ]


def _ends_table(results: Results) -> list[str]:
    runs = [results[Trial(SHAPE, plant)]["phases"][-1] for plant in PLANTS]
    rows = [
        (str(agents.number(row)), _point(place), *(cell(run["distance_m"][row], ".1e") for run in runs))
        for row, place in enumerate(_ends(open_experiment(SHAPE)).tolist())
    ]
    return [
        "## Shape: the end configuration",
        "",
        "Where Theorem 1 and the starts of agents 1 and 2 put everyone, and how far from there (m) each projected",
        "point ends. Agents 1 and 2 do not drive; where they end elsewhere, they were pushed.",
        "",
        *markdown_table(("agent", "paper (m)", *PLANTS), rows),
    ]


def _rates(results: Results) -> list[str]:
    experiment = open_experiment(SHAPE)
    target, period = experiment.target, experiment.scenario.plant.control_period_s
    rows = []
    for index, rate in enumerate(decay_rates(target)):
        follower = agents.number(target.graph.followers[index])
        found = [results[Trial(SHAPE, plant, follower)]["late_rates_per_s"]["measured"][index] for plant in PLANTS]
        angle = f"{np.degrees(target.follower_angles[index]):.2f}"
        held = -np.log1p(-period * rate) / period
        rows.append((str(follower), angle, f"{rate:.3f}", f"{held:.3f}", *(cell(value, ".3f") for value in found)))
    return [
        "## Shape: the rates",
        "",
        "Rate (1/s) at which a follower nears its place while its neighbours stand in theirs: sin^2 of the follower",
        "angle (degrees). The paper's 2 sin^2 is that of the Lyapunov function, twice the error's. A command that is",
        f"held for the control period T = {period:g} s makes it -ln(1 - T sin^2) / T. Each follower starts",
        f"{np.hypot(*OFFSET):g} m off its place by itself.",
        "",
        *markdown_table(("follower", "angle", "paper", "held", *PLANTS), rows),
    ]


def _phase_ends(results: Results) -> list[str]:
    runs = [results[Trial(MANEUVER, plant)]["phases"] for plant in PLANTS]
    lines = ["## Maneuver: the phase ends", ""]
    lines += ["Places in metres; v is compared with v_r for the agent that is furthest from it."]
    for index, phase in enumerate(open_experiment(MANEUVER).phases):
        ends = [run[index] if index < len(run) else None for run in runs]
        first = next(end for end in ends if end is not None)
        predicted, delta = np.array(first["predicted_m"]), np.array(phase.delta)
        rows = [
            ("leader", _point(predicted[0]), *(_of(end, lambda e: _point(e["measured_m"][0])) for end in ends)),
            ("delta_12", _point(delta), *(_of(end, lambda e: _point(_delta(e))) for end in ends)),
            (
                "side",
                f"{np.linalg.norm(delta):.3f}",
                *(_of(end, lambda e: f"{np.linalg.norm(_delta(e)):.3f}") for end in ends),
            ),
            ("v - v_r (m/s)", "0", *(_of(end, lambda e: cell(e["velocity_error_m_s"], ".1e")) for end in ends)),
            ("angle errors (rad)", "0", *(_of(end, lambda e: cell(e["angle_error_sum_rad"], ".1e")) for end in ends)),
        ]
        velocity = _point(phase.velocity)
        lines += ["", f"At {first['end_s']:g} s, after `{phase.name}` with v_r = {velocity} m/s:", ""]
        lines += markdown_table(("", "paper", *PLANTS), rows)
    return lines


def _verdicts(results: Results) -> list[str]:
    lines = ["## What the paper leaves open", ""]
    lines += ["The paper gives no settling times and no distances, and says that the runs were made on the testbed."]
    for scenario in (SHAPE, MANEUVER):
        runs = [results[Trial(scenario, plant)] for plant in PLANTS]
        rows = [
            ("outcome", *(run["outcome"].replace("_", " ") for run in runs)),
            ("safety filter", *(str(run["safety"]) for run in runs)),
            ("settled after (s)", *(cell(run["settling_time_s"], ".1f") for run in runs)),
            ("smallest distance (m)", *(cell(run["min_separation"]["distance_m"], ".3f") for run in runs)),
            ("angle errors, axles (rad)", *(cell(run["axle_angle_error_sum_rad"], ".1e") for run in runs)),
            ("the testbed", *(_verdict(run["testbed"]) for run in runs)),
        ]
        lines += ["", f"`{scenario}`:", "", *markdown_table(("", *PLANTS), rows)]
    return lines


def _machine() -> list[str]:
    rows = [(name, stated, f"{simulated:.4g}") for name, stated, simulated in MACHINE]
    return ["## The robot", "", *markdown_table(("", "paper", "simulated"), rows)]


def _verdict(testbed: dict[str, Any]) -> str:
    if not testbed["violations"]:
        return "accepts"
    found = ", ".join(f"{v['kind']} at {v['first']['time_s']:.1f} s" for v in testbed["violations"])
    return f"{'accepts' if testbed['accepted'] else 'rejects'}: {found}"


def _delta(end: dict[str, Any]) -> Real:
    leader, first = np.array(end["measured_m"][: agents.FIRST_ORDINARY])
    return first - leader


def _of(end: dict[str, Any] | None, shown: Callable[[dict[str, Any]], str]) -> str:
    return "-" if end is None else shown(end)


def _point(point: Sequence[float] | Real) -> str:
    x, y = (f"{coordinate:.3f}".rstrip("0").rstrip(".") for coordinate in np.round(point, 3) + 0.0)
    return f"({x}, {y})"
