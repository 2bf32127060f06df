"""The loop: sense, law, (safety), NID, drive, world, once per control period, for one run or a batch of runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from formation import Phase
from robots import make_world
from robots.sensors import disturb
from scenarios.experiment import Experiment
from scenarios.trajectory import Trajectory

Real = NDArray[np.float64]


class Controller:
    """The formation law as the robots run it: body-frame velocities of the projected points from what they sense.

    A law gets relative positions in body frames and, only if it says that it needs one, a compass. It never sees a
    position or a heading. The common velocity v_r is stated in the common frame, so following it takes a compass too.
    """

    def __init__(self, experiment: Experiment, generators: Sequence[np.random.Generator], batch: tuple[int, ...]):
        self._law = experiment.law
        self._sensor = experiment.sensor
        self._generators = generators
        self._batch = batch
        self._noise: tuple[Real, Real] | None = None
        self._velocity = 0j
        self._delta: Real | None = None

    def begin_phase(self, phase: Phase) -> None:
        """Take the commands of a phase."""
        self._velocity = complex(*phase.velocity)
        self._delta = None if phase.delta is None else np.array(phase.delta)

    def begin_period(self) -> None:
        """Draw the measurement noise that holds for one control period."""
        noise = [self._sensor.noise(rng) for rng in self._generators]
        if noise[0] is not None:
            turn, offset = (np.stack(part).reshape(*self._batch, -1, 2) for part in zip(*noise, strict=True))
            self._noise = turn, offset

    def __call__(self, points: Real, headings: Real) -> Real:
        relative = disturb(self._sensor.measure(points, headings), self._noise)
        compass = np.conj(headings.view(np.complex128)) if self._law.needs_compass or self._velocity else None
        given = compass.view(np.float64) if compass is not None and self._law.needs_compass else None
        velocity = self._law(relative, given, self._delta)
        if compass is not None and self._velocity:
            velocity += (self._velocity * compass).view(np.float64)
        return velocity


def simulate(
    experiment: Experiment,
    seed: int | Sequence[int] = 0,
    on_period: Callable[[int, int], None] | None = None,
) -> Trajectory:
    """Run an experiment.

    Args:
        experiment: what to run.
        seed: of the run, or the seeds of a batch of runs, which only the plants without contact accept.
        on_period: called after each control period with the number of periods done and of all periods.

    Returns:
        The recorded states; cut short after the first state that is not finite.
    """
    seeds = [seed] if isinstance(seed, int) else list(seed)
    batch = () if isinstance(seed, int) else (len(seeds),)
    generators = [np.random.default_rng(s) for s in seeds]
    theta = np.stack([initial_headings(experiment, rng) for rng in generators]).reshape(*batch, experiment.n)
    world = make_world(
        experiment.plant,
        np.broadcast_to(experiment.start, (*batch, experiment.n, 2)).copy(),
        theta,
        nid=experiment.nid,
        robot=experiment.robot,
        saturation=experiment.scenario.robot.saturation,
        arena=experiment.arena,
    )
    controller = Controller(experiment, generators, batch)
    schedule = [(phase, *periods(phase, experiment.scenario.plant.control_period_s)) for phase in experiment.phases]
    total = sum(count for _, count, _ in schedule)
    t = np.empty(total + 1)
    poses = np.empty((total + 1, *world.poses.shape))
    points = np.empty((total + 1, *world.points.shape))
    wheel_speeds = np.zeros_like(points) * world.wheel_speeds
    phase_index = np.zeros(total + 1, dtype=np.intp)
    t[0], poses[0], points[0] = 0.0, world.poses, world.points
    done, start = 0, 0.0
    for index, (phase, count, period) in enumerate(schedule):
        controller.begin_phase(phase)
        for step in range(1, count + 1):
            controller.begin_period()
            world.step(controller, period)
            done += 1
            t[done] = start + phase.duration * (step / count)
            poses[done], points[done], wheel_speeds[done] = world.poses, world.points, world.wheel_speeds
            phase_index[done] = index
            if on_period is not None:
                on_period(done, total)
            if not np.isfinite(world.poses.sum()):
                end = done + 1
                return Trajectory(t[:end], poses[:end], points[:end], wheel_speeds[:end], phase_index[:end])
        start += phase.duration
    return Trajectory(t, poses, points, wheel_speeds, phase_index)


def periods(phase: Phase, control_period: float) -> tuple[int, float]:
    """How many control periods fit a phase, and their length, seconds, stretched so that they fit exactly."""
    count = max(1, round(phase.duration / control_period))
    return count, phase.duration / count


def initial_headings(experiment: Experiment, rng: np.random.Generator) -> Real:
    """(n,) headings, radians: the scenario's, and uniform over the circle where it leaves them to the seed."""
    drawn = rng.uniform(-np.pi, np.pi, experiment.n)
    return np.where(np.isnan(experiment.headings), drawn, experiment.headings)
