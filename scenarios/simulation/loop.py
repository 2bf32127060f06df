"""The loop: sense, law, (safety), NID, drive, world, once per control period, for one run or a batch of runs.

Where :mod:`scenarios.simulation.compiled` can do all that an experiment asks for, it advances the runs; what it cannot
do is stepped here, by a call of Python for every part of every period.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robots import make_world
from robots.worlds import NOTHING, UnsupportedVersionError, World
from scenarios.definition.events.event import OBSTACLE
from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.simulation.compiled.ability import side_by_side, unable
from scenarios.simulation.controller import Controller
from scenarios.simulation.guard import SafetyRecord
from scenarios.simulation.outages import Outages, pushes, standing
from scenarios.simulation.schedule import Part, schedule
from scenarios.simulation.told import runge_kutta_steps
from scenarios.simulation.trajectory import OnPeriod, OnState, Trajectory


@np.errstate(over="ignore", invalid="ignore")  # a diverged run is an outcome, not a warning
def simulate(
    experiment: Experiment,
    seed: int | Sequence[int] = 0,
    on_period: OnPeriod | None = None,
    on_state: OnState | None = None,
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

    Raises:
        InputError: a package is of a version that this plant cannot use.
    """
    try:
        return _simulated(experiment, seed, on_period, on_state)
    except UnsupportedVersionError as error:
        raise InputError(f"{experiment.file.name}: plant.name: {experiment.plant}: {error}") from error


def _simulated(
    experiment: Experiment, seed: int | Sequence[int], on_period: OnPeriod | None, on_state: OnState | None
) -> Trajectory:
    if unable(experiment) is not None:
        return step_by_step(experiment, seed, on_period, on_state)
    from scenarios.simulation.compiled.record import as_batch, record

    if isinstance(seed, int):
        return record(experiment, [seed], on_period, on_state, alone=True)
    if side_by_side(experiment):
        return record(experiment, seed, on_period, on_state)
    return as_batch([record(experiment, [each], on_period, on_state) for each in seed])


@np.errstate(over="ignore", invalid="ignore")
def step_by_step(
    experiment: Experiment,
    seed: int | Sequence[int] = 0,
    on_period: OnPeriod | None = None,
    on_state: OnState | None = None,
) -> Trajectory:
    """The same by calls of Python, whatever the experiment is."""
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
        nid=experiment.fleet.nid,
        robot=replace(experiment.robot, drive=experiment.fleet.drive),
        bodies=experiment.fleet.bodies,
        saturation=experiment.scenario.robot.saturation,
        arena=experiment.arena,
        measured=experiment.measured,
        generators=generators,
        steps=runge_kutta_steps(experiment),
    )
    controller = Controller(experiment, generators, batch)
    parts = schedule(experiment)
    total = sum(part.count for part in parts)
    t = np.empty(total + 1)
    poses = np.empty((total + 1, *world.poses.shape))
    points = np.empty((total + 1, *world.points.shape))
    wheel_speeds = np.empty_like(points)
    wish, command = np.zeros_like(points), np.zeros_like(points)
    phase_index = np.zeros(total + 1, dtype=np.intp)
    contact = np.full(points.shape[:-1], NOTHING)
    active = np.empty((total + 1, *controller.active.shape), dtype=bool)
    safety = SafetyRecord(total + 1, (*batch, experiment.n), controller.guard)
    t[0], poses[0], points[0], wheel_speeds[0] = 0.0, world.poses, world.points, world.wheel_speeds
    active[0] = controller.active
    trajectory = Trajectory(
        t,
        poses,
        points,
        wheel_speeds,
        phase_index,
        contact,
        active,
        safety.intervention,
        safety.relaxation,
        safety.blockers,
        safety.stuck,
        wish,
        command,
    )
    done = 0
    for part in parts:
        if part.begins:
            controller.begin_phase(part.index)
        if experiment.events:
            _happen(experiment, part, world, controller)
        index, period = part.index, part.period
        for step in range(1, part.count + 1):
            controller.begin_period(*world.seen, period)
            world.step(controller, period)
            done += 1
            t[done] = part.start + part.duration * (step / part.count)
            poses[done], points[done], wheel_speeds[done] = world.poses, world.points, world.wheel_speeds
            phase_index[done], contact[done], active[done] = index, world.contacts, controller.active
            wish[done], command[done] = controller.wish, controller.command
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
    return trajectory.until(total + 1)


def _happen(experiment: Experiment, part: Part, world: World, controller: Controller) -> None:
    """Let happen what happens at the begin of a part of the run."""
    controller.take(Outages.at(experiment, part.start, part.index))
    if (way := pushes(experiment, part.start)) is not None:
        world.push(np.broadcast_to(way, world.points.shape))
    if any(event.kind == OBSTACLE for event in experiment.events):
        there = standing(experiment, part.start)
        world.stand(there)
        controller.avoid(there)
