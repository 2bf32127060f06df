"""The loop: sense, law, (safety), NID, drive, world, once per control period, for one run or a batch of runs."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from formation import Phase, SequentialActivation
from robots import make_world
from robots.sensors import disturb
from scenarios.experiment import Experiment
from scenarios.guard import SafetyRecord, make_guard
from scenarios.trajectory import Trajectory

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


class Controller:
    """The formation law as the robots run it: body-frame velocities of the projected points from what they sense.

    A law gets relative positions in body frames and, only if it says that it needs one, a compass. It never sees a
    position or a heading. The common velocity v_r is stated in the common frame, so following it takes a compass too.

    Attributes:
        active: (..., n) which agents follow the law; the others hold still but for v_r.
        guard: the safety filter; None without one.
    """

    def __init__(self, experiment: Experiment, generators: Sequence[np.random.Generator], batch: tuple[int, ...]):
        self._law = experiment.law
        self._sensor = experiment.sensor
        self._estimator = experiment.estimator
        self._generators = generators
        self._batch = batch
        self._noise: tuple[Real, Real] | None = None
        self._commanded = np.zeros(2)
        self._velocity: Real | None = None
        self._delta: Real | None = None
        self.guard = make_guard(experiment, batch)
        scenario = experiment.scenario
        self._delay = scenario.sensor.delay_periods
        self._history: deque[tuple[Real, Real]] = deque(maxlen=self._delay + 1)
        self._compass_error = self._draw_compass(np.radians(scenario.sensor.compass_bias_deg), experiment.n)
        self._activation = None
        self.active = np.ones((*batch, experiment.n), dtype=bool)
        if scenario.law.activation == "sequential":
            self._activation = SequentialActivation(experiment.target, scenario.law.settled_m, batch)
            self.active = self._activation.active
        if self._estimator is not None:
            self._velocity = np.zeros((*batch, experiment.n, 2))

    def begin_phase(self, phase: Phase) -> None:
        """Take the commands of a phase."""
        self._commanded = np.array(phase.velocity)
        self._delta = None if phase.delta is None else np.array(phase.delta)
        if self._estimator is None:
            self._velocity = self._commanded if self._commanded.any() else None

    def begin_period(self, points: Real, headings: Real, period: float) -> None:
        """Do what happens once per control period: draw noise, exchange estimates of v_r, activate followers."""
        self._history.append((points, headings))
        points, headings = self._sensed(points, headings)
        noise = [self._sensor.noise(rng) for rng in self._generators]
        if noise[0] is not None:
            turn, offset = (np.stack(part).reshape(*self._batch, -1, 2) for part in zip(*noise, strict=True))
            self._noise = turn, offset
        if self.guard is not None:
            self.guard.begin_period(self._generators, self._batch, self._noise, period)
        if self._estimator is not None and self._velocity is not None:
            self._velocity = self._estimator.step(self._velocity, self._commanded, period)
        if self._activation is not None:
            self._activation.update(self._feedback(points, headings))

    def __call__(self, points: Real, headings: Real) -> Real:
        points, headings = self._sensed(points, headings)
        feedback = self._feedback(points, headings)
        if self._activation is not None:
            feedback *= self.active[..., None]
        if self._velocity is None:
            return feedback if self.guard is None else self.guard(points, headings, feedback, np.zeros_like(feedback))
        velocity = np.ascontiguousarray(self._velocity).view(np.complex128)
        common = (velocity * self._compass(headings)).view(np.float64)
        return feedback + common if self.guard is None else self.guard(points, headings, feedback, common)

    def _sensed(self, points: Real, headings: Real) -> tuple[Real, Real]:
        """The state that the measurements are of: that of ``delay_periods`` ago, the first one until then."""
        return self._history[0] if self._delay else (points, headings)

    def _feedback(self, points: Real, headings: Real) -> Real:
        """The law's own velocities, without v_r."""
        relative = disturb(self._sensor.measure(points, headings), self._noise)
        compass = self._compass(headings).view(np.float64) if self._law.needs_compass else None
        return self._law(relative, compass, self._delta)

    def _compass(self, headings: Real) -> Complex:
        """(..., n, 1) the common x axis in each body frame as a complex number, as each robot's compass shows it."""
        compass = np.conj(headings.view(np.complex128))
        return compass if self._compass_error is None else compass * self._compass_error

    def _draw_compass(self, deviation: float, n: int) -> Complex | None:
        if deviation == 0.0:
            return None
        errors = np.stack([rng.normal(0.0, deviation, n) for rng in self._generators])
        return np.exp(1j * errors).reshape(*self._batch, n, 1)


@np.errstate(over="ignore", invalid="ignore")  # a diverged run is an outcome, not a warning
def simulate(
    experiment: Experiment,
    seed: int | Sequence[int] = 0,
    on_period: Callable[[int, int], None] | None = None,
    on_state: Callable[[Trajectory, int], None] | None = None,
) -> Trajectory:
    """Run an experiment.

    Args:
        experiment: what to run.
        seed: of the run, or the seeds of a batch of runs, which only the plants without contact accept.
        on_period: called after each control period with the number of periods done and of all periods.
        on_state: called after each control period with the trajectory, which has room for all periods, and the row of
            the newest state; rows after it are not written yet.

    Returns:
        The recorded states; cut short after the first state that is not finite.
    """
    seeds = [seed] if isinstance(seed, int) else list(seed)
    batch = () if isinstance(seed, int) else (len(seeds),)
    generators = [np.random.default_rng(s) for s in seeds]
    points_0, theta_0 = (
        np.stack(part).reshape(*batch, experiment.n, -1)
        for part in zip(*(experiment.starts.draw(rng) for rng in generators), strict=True)
    )
    world = make_world(
        experiment.plant,
        points_0,
        theta_0[..., 0],
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
    active = np.empty((total + 1, *controller.active.shape), dtype=bool)
    safety = SafetyRecord(total + 1, (*batch, experiment.n), controller.guard)
    t[0], poses[0], points[0], active[0] = 0.0, world.poses, world.points, controller.active
    trajectory = Trajectory(
        t,
        poses,
        points,
        wheel_speeds,
        phase_index,
        active,
        safety.intervention,
        safety.relaxation,
        safety.blockers,
        safety.stuck,
    )
    done, start = 0, 0.0
    for index, (phase, count, period) in enumerate(schedule):
        controller.begin_phase(phase)
        for step in range(1, count + 1):
            controller.begin_period(world.points, world.headings, period)
            world.step(controller, period)
            done += 1
            t[done] = start + phase.duration * (step / count)
            poses[done], points[done], wheel_speeds[done] = world.poses, world.points, world.wheel_speeds
            phase_index[done], active[done] = index, controller.active
            safety.take(done)
            if on_period is not None:
                on_period(done, total)
            if on_state is not None:
                on_state(trajectory, done)
            if not np.isfinite(world.poses.sum()):
                total = done
                break
        if total == done:
            break
        start += phase.duration
    return trajectory.until(total + 1)


def periods(phase: Phase, control_period: float) -> tuple[int, float]:
    """How many control periods fit a phase, and their length, seconds, stretched so that they fit exactly."""
    count = max(1, round(phase.duration / control_period))
    return count, phase.duration / count
