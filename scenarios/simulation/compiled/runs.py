"""Runs that advance together through the compiled period, a chunk of control periods at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from formation import SequentialActivation, agents
from formation.laws.angle import AngleLaw
from robots.safety.protocol import BLOCKERS
from robots.senses.noise import Noise, draw_key
from scenarios.definition.experiment import Experiment
from scenarios.simulation.compiled.orders import orders

if TYPE_CHECKING:
    from robots.worlds.contact import Contact

Real = NDArray[np.float64]

MOTION = 7
"""Fields of :mod:`robots.worlds.lanes` that tell where robots are and how their wheels turn."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """Some control periods of all runs. The arrays are used again for the next chunk.

    Attributes:
        first: row of a trajectory that the first of them has; 1 for the first period of all.
        phase: index of the phase that they belong to.
        rows: (K, F, n, L) the first fields of the states, see :mod:`robots.worlds.lanes`.
        blockers: (K, n, L, 3) see :class:`robots.safety.SafetyFilter`.
    """

    first: int
    phase: int
    rows: Real
    blockers: NDArray[np.int32]


class Runs:
    """Runs of one experiment that :func:`scenarios.simulation.compiled.ability.unable` has nothing against.

    Attributes:
        state: (FIELDS, n, L) of all runs, see :mod:`robots.worlds.lanes`.
    """

    def __init__(self, experiment: Experiment, seeds: Sequence[int]) -> None:
        from formation.laws.angle_loop import gains
        from robots.safety.rows import constants, things
        from robots.safety.step import room
        from robots.senses.late import late
        from robots.worlds import lanes
        from robots.worlds.bodies import no_chassis
        from scenarios.simulation.compiled.period import Guard, Law

        self._experiment = experiment
        self._free = experiment.plant == "single_integrator"
        self._generators = [np.random.default_rng(seed) for seed in seeds]
        starts = [experiment.starts.draw(rng) for rng in self._generators]
        points, theta = (np.stack(part) for part in zip(*starts, strict=True))
        n, fleet = experiment.n, experiment.fleet
        nid, drive = fleet.nid, fleet.drive
        poses = np.concatenate([points, theta[..., None]], axis=-1) if self._free else nid.poses(points, theta)
        self.state = lanes.new_state(poses, 0.0 if self._free else nid.ahead)
        self._world = _contact(experiment, points, theta) if experiment.plant == "pymunk" else None
        self._chassis = no_chassis() if self._world is None else self._world.chassis
        if self._free:
            self.state[[lanes.LEFT, lanes.RIGHT]] = np.nan
        law = cast(AngleLaw, experiment.law)  # nothing else is able
        edges = experiment.instruments.edges.astype(np.int64)
        sensor = experiment.scenario.sensor
        self._law = Law(
            gains(law, experiment.target, experiment.first_follower),
            edges,
            late(self.state, sensor.delay_periods, sensor.own_motion),
            self._wait(lanes.ACTIVE, lanes.SETTLED),
            np.empty((2, len(edges), len(seeds))),
        )
        self._imperfections = experiment.instruments.imperfections
        saturation = experiment.scenario.robot.saturation if experiment.plant != "unicycle" else None
        self._wheels = lanes.wheels(drive, nid, saturation, n, len(seeds))
        around, settings = things(experiment.arena), constants(experiment.filter_settings, drive, nid, n)
        self._guard = Guard(experiment.safety != "none", settings, around, room(n, len(seeds), around))
        self._room = np.empty((3, 2, n, len(seeds)))

    def advance(self, most: int, recorded: bool = False) -> Iterator[Chunk]:
        """All periods, in chunks of ``most`` at most, each of one phase.

        Args:
            most: periods in a chunk.
            recorded: whether a chunk has all that a trajectory holds; else where robots are and how their wheels turn,
                and the blockers of its last period.
        """
        from robots.worlds.lanes import RECORDED
        from scenarios.simulation.compiled.period import advance, integrate

        _, n, runs = self.state.shape
        rows = np.empty((most, RECORDED if recorded else MOTION, n, runs))
        blockers = np.full((most if recorded else 1, n, runs, BLOCKERS), -1, dtype=np.int32)
        first = 1
        for part in orders(self._experiment):
            for done in range(0, part.count, most):
                room = rows[: part.count - done]
                noise, commands = self._noise(len(room)), part.between(done, done + len(room))
                if self._free:
                    integrate(self.state, room, self._law, noise, commands, self._room)
                else:
                    after = blockers[: len(room)]
                    advance(
                        self.state, room, after, self._law, noise, commands, self._guard, self._wheels, self._chassis
                    )
                yield Chunk(first, part.phase, room, blockers)
                first += len(room)

    def _wait(self, active: int, settled: int) -> float:
        """Let agents wait, by two fields of the state, until others are so near their places, metres; 0 for nobody."""
        law = self._experiment.scenario.law
        if law.activation != "sequential":
            return 0.0
        self.state[active] = SequentialActivation(self._experiment.target, law.settled_m).active[:, None]
        self.state[settled, : agents.FIRST_ORDINARY] = 1.0
        return law.settled_m

    def _noise(self, periods: int) -> Noise:
        """The noise of the next periods, keys (K, L)."""
        has = self._imperfections
        if not (has.position or has.bearing):
            return Noise(np.zeros((periods, len(self._generators)), dtype=np.uint64), 0.0, 0.0)
        keys = [[draw_key(rng) for _ in range(periods)] for rng in self._generators]
        return Noise(np.array(keys, dtype=np.uint64).T.copy(), float(has.position), float(has.bearing))


def _contact(experiment: Experiment, points: Real, theta: Real) -> Contact:
    """The bodies of one run, points (1, n, 2)."""
    from robots.worlds.contact import Contact  # pymunk is loaded only where bodies collide

    fleet = experiment.fleet
    (poses,) = fleet.nid.poses(points, theta)
    robot = replace(experiment.robot, drive=fleet.drive)
    saturation = experiment.scenario.robot.saturation
    return Contact(poses, fleet.nid, robot, saturation, experiment.arena, bodies=fleet.bodies)
