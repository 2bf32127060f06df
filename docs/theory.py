"""Write docs/theory.md: each closed form of the theory beside what the product simulates.

    .venv/bin/python docs/theory.py

Takes a few minutes of one processor; the seeds are fixed, so that the page changes only where the theory or the
simulation does.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from formation import Phase, SensingGraph, TargetFormation, end_configuration
from formation.analysis.amplification import dwell_errors, transient_gain
from formation.analysis.cascade import Cascade
from formation.analysis.exact import ideal
from formation.analysis.margins import longest_period, most_periods
from formation.analysis.noise import noise_power, noise_rms
from formation.plane import as_complex
from scenarios.definition.experiment import open_experiment
from scenarios.measures.late_rates import measured_late_rates, predicted_late_rates
from scenarios.measures.predictions.theory import motion
from scenarios.simulation.loop import simulate

PAGE = Path(__file__).parent / "theory.md"
SEEDS = 60
SHORT = ("phases.1.displacement_m=[0.35,0.0]", "phases.2.displacement_m=[0.3,0.0]")
LITERAL = ("safety.filter=none",)

HEAD = """# What the theory predicts, and what the robots do

Written by `python docs/theory.py`. The formulas are derived where they are computed: `formation/analysis/`, one idea a
file. `formation show SCENARIO` prints those of a scenario, `formation audit` those of any law, from its linearisation.

| prediction | case | predicted | simulated | difference |
|---|---|---:|---:|---:|
"""

Row = tuple[str, str, float, float]


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")


def page() -> str:
    """The whole page, computed anew."""
    rows = [*late_rates(), *exact_motion(), *noise(), *margins(), *held_commands(), *growth(), *dwell()]
    return HEAD + "\n".join(line(row) for row in rows) + "\n" + TAIL


def line(row: Row) -> str:
    """A row as the page has it."""
    what, case, a, b = row
    return f"| {what} | {case} | {a:.4g} | {b:.4g} | {_apart(a, b)} |"


def late_rates() -> Iterator[Row]:
    """The follower whose rate differs most."""
    cases = [
        ("scale-only", (*SHORT, *LITERAL), "unicycle", "0.35, 0.3 m"),
        ("orientation-only", LITERAL, "unicycle", ""),
        ("fastest", LITERAL, "unicycle", ""),
        ("random-50", LITERAL, "single_integrator", ""),
        ("random-50", LITERAL, "saturated", ""),
        ("random-50", (), "saturated", "with filter"),
    ]
    for name, changes, plant, note in cases:
        experiment = open_experiment(name, (*changes, f"plant.name={plant}"))
        run = simulate(experiment, 0)
        pairs = [
            (p, m)
            for p, m in zip(
                predicted_late_rates(experiment, run) or [], measured_late_rates(experiment, run), strict=True
            )
            if p is not None and m is not None
        ]
        p, m = max(pairs, key=lambda pair: abs(pair[0] / pair[1] - 1.0))
        yield "late rate (1/s), worst follower", f"`{name}`{', ' if note else ''}{note}, {plant}", p, m


def exact_motion() -> Iterator[Row]:
    """The largest distance between the exact motion and the simulated points at any instant."""
    for name in ("shape", "maneuver", "scale-only", "orientation-only"):
        experiment = open_experiment(name, ("plant.name=single_integrator",))
        run, worst = simulate(experiment, 0), 0.0
        for index in range(len(experiment.phases)):
            rows = np.flatnonzero(run.phase == index)
            rows = rows if index == 0 else np.insert(rows, 0, rows[0] - 1)
            apart = np.linalg.norm(motion(experiment, run.points[rows[0]], index) - run.points[rows], axis=-1)
            worst = max(worst, float(apart.max()))
        yield "exact motion: largest distance (m)", f"`{name}`, single_integrator", 0.0, worst


def noise() -> Iterator[Row]:
    """Root mean square error of each follower over all seeds, late in the run."""
    experiment = open_experiment(
        "shape", (*LITERAL, "plant.name=unicycle", "sensor.position_noise_m=0.01"), duration=60.0
    )
    run = simulate(experiment, range(SEEDS))
    end = end_configuration(experiment.target, *experiment.initial_points(0)[:2])
    late = run.points[run.t > 25.0] - end
    measured = np.sqrt((late**2).sum(axis=-1).mean(axis=(0, 1)))
    loop = Cascade.of(experiment.target)
    predicted = noise_rms(loop, 0.033, noise_power(loop, end, 0.01))
    for row in range(2, 6):
        case = f"`shape`, 1 cm, agent {row + 1}, unicycle, {SEEDS} seeds"
        yield "noise rms (mm)", case, 1e3 * predicted[row], 1e3 * measured[row]


def margins() -> Iterator[Row]:
    """Where growth begins, by halving between decay and growth."""
    modes = [-1.0, -0.64, -0.5]
    most = most_periods(modes, 0.033)
    yield "delay margin (control periods)", "`shape`, turn undone, unicycle", float(most or 0), float(_last_stable())


def held_commands() -> Iterator[Row]:
    """Where held commands of old measurements begin to grow."""
    modes = [-1.0, -0.64, -0.5]
    for delay in (0, 1, 2, 5):
        bound = longest_period(modes, delay)
        yield "held-command bound (s)", f"{delay} periods of delay", bound, _longest_stable(delay)


def growth() -> Iterator[Row]:
    """The largest growth of the worst errors in the exact motion of strips."""
    for n in (6, 12, 24, 48):
        target = strip(n)
        loop = Cascade.of(target)
        gain, when = transient_gain(loop)
        worst = np.linalg.svd(loop.exponential(when)[2:, 2:])[2][0].conj()
        start = as_complex(target.positions) + np.concatenate([[0.0, 0.0], worst])
        states = islice(ideal(loop, start, Phase("", 1.0), "stationary", max(when, 0.1) / 40.0), 80)
        grown = max(float(np.linalg.norm(state - as_complex(target.positions))) for state in states)
        yield "transient gain", f"equilateral strip, {n} agents", gain, grown


def dwell() -> Iterator[Row]:
    """What is left before a switch, after many."""
    experiment = open_experiment("maneuver", ("plant.name=single_integrator",))
    target, loop = experiment.target, Cascade.of(experiment.target, 1.0)
    for seconds in (1.0, 2.0, 4.0, 8.0):
        predicted = dwell_errors(target, loop, seconds, (0.4 + 0.4j) * (1.0 - 1.0j)).max()
        p = as_complex(experiment.initial_points(0))
        for switch in range(40):
            delta = (0.4, 0.4) if switch % 2 else (0.4, -0.4)
            *_, p = islice(ideal(loop, p, Phase("", seconds, delta=delta), "displacement", seconds / 20.0), 21)
        z = as_complex(target.positions) * complex(*delta)
        yield (
            "dwell error (m)",
            f"switching by 90 degrees every {seconds:g} s",
            predicted,
            float(np.abs(p - p[0] - z).max()),
        )


def strip(n: int) -> TargetFormation:
    """Equilateral triangles in a row, each agent sensing the two before it."""
    places = np.array([[0.5 * k, (k % 2) * np.sqrt(3.0) / 2.0] for k in range(n)])
    return TargetFormation(SensingGraph(np.array([[k - 2, k - 1] for k in range(2, n)])), places)


def _last_stable() -> int:
    """The largest delay, control periods, at which the late envelope of a small error decays."""
    low, high, shape = 30, 60, open_experiment("shape")
    end = end_configuration(shape.target, *shape.initial_points(0)[:2])
    near = [f"agents.{row + 1}.start={(end[row] + 1e-4).tolist()}" for row in range(2, 6)]
    while high - low > 1:
        middle = (low + high) // 2
        keys = ("plant.name=unicycle", "sensor.own_motion=turn", f"sensor.delay_periods={middle}", *LITERAL, *near)
        run = simulate(open_experiment("shape", keys, duration=200.0), 0)
        error = np.linalg.norm(run.points - end, axis=-1).max(axis=1)
        thirds = error[len(error) // 3 : 2 * len(error) // 3].max(), error[2 * len(error) // 3 :].max()
        low, high = (middle, high) if thirds[1] < thirds[0] else (low, middle)
    return low


def _longest_stable(delay: int) -> float:
    """The control period, seconds, at which held commands of old measurements begin to grow, by simulating them."""
    loop = Cascade.of(open_experiment("shape").target)
    low, high = 0.05, 3.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        x = [np.concatenate([[0.0, 0.0], np.ones(4)]).astype(complex)] * (delay + 1)
        with np.errstate(over="ignore", invalid="ignore"):  # what grows may grow beyond numbers
            for _ in range(3000):
                x.append(x[-1] + middle * loop.apply(x[-1 - delay]))
        late = [float(np.abs(each).max()) for each in x]
        low, high = (middle, high) if max(late[2700:]) < max(late[300:600]) else (low, middle)
    return 0.5 * (low + high)


def _apart(a: float, b: float) -> str:
    return "" if a == 0.0 else f"{abs(b / a - 1.0):.1%}"


TAIL = """
Late rates are slopes of the log distance over one window, from 2 cm of the follower and of all upstream of it to
0.1 um, predicted by the same fit to the exact motion from the state at which the window begins, with commands held
where the plant holds them. No filter is part of it: one that still acts within the window moves the rate, as the row
`with filter` shows.
"""

if __name__ == "__main__":
    main()
