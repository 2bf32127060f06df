"""Random scenarios through both ways of stepping them: ``python -m tests.fuzz.paths [300]``, or ``... paths 17 18``.

A run of the compiled period is the run that Python steps, up to rounding. How far rounding takes a run is measured: its
copies from starts that differ in the twelfth digit, some ten thousand roundings, tell.
"""

from __future__ import annotations

import sys
from dataclasses import fields

import numpy as np

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.simulation.compiled.ability import unable
from scenarios.simulation.loop import simulate, step_by_step
from scenarios.simulation.trajectory import Trajectory
from scenarios.studies.check.perturbed import perturbed
from scenarios.studies.check.quantities import MARGIN

WHOLE = 300
ROUNDING = 1e-10
"""Metres, radians, m/s, rad/s: a few thousand roundings of one period, carried through some 120 periods."""

COPIES = 2

NAMES = ("shape", "maneuver", "maneuver", "scale-only", "orientation-only", "circle", "circle", "figure-eight")
PLANTS = ("single_integrator", "unicycle", "saturated", "pymunk")
OBSTACLES = "obstacles=[{vertices_m=[[0.2, 0.1]], radius_m=0.05}, {vertices_m=[[-0.4, -0.3], [-0.2, 0.4]]}]"
EVENTS = (
    "{t_s=1.0, kind='stop', agent=4, until_s=2.0}",
    "{t_s=1.5, kind='push', agent=3, displacement_m=[0.05, -0.05]}",
    "{t_s=1.0, kind='dropout', agent=5, until_s=1.7}",
)
TWO_PHASES = (
    "phases=[{name='a', duration_s=1.3, velocity_m_s=[0.05, 0.02], displacement_m=[0.6, 0.1]}, "
    "{name='b', duration_s=1.7, displacement_m=[0.4, -0.3]}]"
)
LAWS = (
    ("law.gain='normalised'",),
    ("agents.4.gain=1.7",),
    ("law.activation='sequential'", "law.settled_m=0.4", "law.feedforward=false"),
    ("law.feedforward=false",),
)
REFERENCES = (
    "reference.clockwise=true",
    "reference.orientation='kept'",
    "reference={kind='ramps', displacement_m=[0.4, 0.1], velocities=[{t_s=0}, {t_s=1.1, velocity_m_s=[0.06, 0.02], "
    "scale=0.9, turn_deg=20}, {t_s=2.3, velocity_m_s=[0.02, -0.05], turn_deg=-30}]}",
    "reference={kind='way-points', displacement_m=[-0.3, 0.3], points=[{t_s=0, position_m=[0, 0]}, {t_s=1.5, "
    "position_m=[0.1, 0.1], scale=1.2}, {t_s=3, position_m=[0.2, 0], turn_deg=60}]}",
)
OWN_MOTION = ("measured", "turn", "unknown")


def scenario(number: int) -> Experiment:
    """The random scenario of a number."""
    rng = np.random.default_rng(number)

    def maybe(share: float, *changes: str) -> tuple[str, ...]:
        return changes if rng.random() < share else ()

    plant = PLANTS[number % len(PLANTS)]
    name = str(rng.choice(NAMES))
    continuous, on_curve = plant == "single_integrator", name in ("circle", "figure-eight")
    changes = (
        f"plant.name='{plant}'",
        f"safety.filter='{rng.choice(['none', 'decentralised'])}'",
        "random_start.x_m=[-0.9, 0.9]",
        f"robot.saturation='{rng.choice(['scale', 'clip'])}'",
        f"robot.projection_distance_m={rng.uniform(0.02, 0.06):.3f}",
        f"plant.control_period_s={rng.uniform(0.02, 0.05):.3f}",
        f"safety.turn_rad={rng.uniform(0.0, 1.0):.2f}",
        f"safety.stuck_time_s={rng.uniform(0.2, 2.0):.2f}",
        f"arena.walls={rng.choice(['true', 'false'])}",
        *maybe(0.4, f"sensor.position_noise_m={rng.uniform(0.0, 0.02):.4f}", "sensor.bearing_noise_deg=2"),
        *maybe(0.4, OBSTACLES),
        *(maybe(0.5, TWO_PHASES) if name == "maneuver" else ()),
        *(maybe(0.3, "law.first_follower='spiral'") if name == "maneuver" else ()),
        *maybe(0.15, f"events=[{EVENTS[number % len(EVENTS)]}]"),
        *(() if continuous else maybe(0.2, f"sensor.delay_periods={rng.integers(1, 9)}")),
        *maybe(0.5, f"sensor.own_motion='{rng.choice(OWN_MOTION)}'"),
        *maybe(0.4, *LAWS[rng.integers(len(LAWS))]),
        *(maybe(0.5, f"reference.period_s={rng.uniform(3.0, 30.0):.2f}") if on_curve else ()),
        *(maybe(0.6, str(rng.choice(REFERENCES))) if on_curve else ()),
        *(maybe(0.3, "velocity_known_by='leader'") if on_curve or name == "maneuver" else ()),
        *maybe(0.1, "sensor.edge_loss=0.1"),
    )
    return open_experiment(name, changes, 3.0)


def difference(number: int) -> str | None:
    """What is wrong with the two ways of the scenario of a number; None where they agree."""
    experiment = scenario(number)
    found, stepped = simulate(experiment, number), step_by_step(experiment, number)
    if unable(experiment) is not None:
        return None if _apart(found, stepped) == {} else "Python steps it, and not always alike"
    spread: dict[str, float] = {}
    for copy in range(1, COPIES + 1):
        for name, apart in _apart(step_by_step(perturbed(experiment, copy), number), stepped).items():
            spread[name] = max(apart, spread.get(name, 0.0))
    for name, apart in _apart(found, stepped).items():
        if not apart <= ROUNDING + MARGIN * spread.get(name, 0.0):
            return f"{name} differs by {apart:.1e}, from starts that differ by rounding by {spread.get(name, 0.0):.1e}"
    return None


def _apart(one: Trajectory, other: Trajectory) -> dict[str, float]:
    """By how much the fields of two trajectories differ that do, relative to 1 where they are larger."""
    found = {}
    for field in fields(Trajectory):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if a.shape != b.shape:
            found[field.name] = np.inf
        elif not np.array_equal(a, b, equal_nan=a.dtype.kind == "f"):
            found[field.name] = float(np.nanmax(np.abs(a * 1.0 - b * 1.0) / np.maximum(1.0, np.abs(b))))
    return found


def main(arguments: list[str]) -> int:
    """Try all scenarios, or those of the numbers that are given after the first; 1 where a pair differs."""
    numbers = range(int(arguments[0]) if arguments else WHOLE) if len(arguments) < 2 else map(int, arguments)
    compiled = tried = wrong = 0
    for number in numbers:
        tried += 1
        compiled += unable(scenario(number)) is None
        if said := difference(number):
            wrong += 1
            print(f"{number}: {said}", flush=True)
    print(f"{tried} scenarios, {compiled} of them compiled as a whole, {wrong} differ")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
