"""Runs that advance together through the compiled period, a chunk of control periods at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from formation import Phase
from formation.laws.angle import AngleLaw
from robots.safety.protocol import BLOCKERS
from scenarios.definition.experiment import Experiment
from scenarios.simulation.schedule import schedule

if TYPE_CHECKING:
    from scenarios.simulation.compiled.period import Commands

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
        from formation.laws.angle_loop import gains  # numba is loaded only where it is used
        from robots.safety.rows import Noise, constants, things
        from robots.worlds import lanes
        from scenarios.simulation.compiled.period import Guard

        self._phases = experiment.phases
        self._parts = schedule(experiment)
        self._free = experiment.plant == "single_integrator"
        starts = [experiment.starts.draw(np.random.default_rng(seed)) for seed in seeds]
        points, theta = (np.stack(part) for part in zip(*starts, strict=True))
        n, runs, nid = experiment.n, len(seeds), experiment.nid
        ahead = 0.0 if self._free else float(nid.projection_distance)
        poses = np.concatenate([points, theta[..., None]], axis=-1) if self._free else nid.poses(points, theta)
        self.state = lanes.new_state(poses, ahead)
        if self._free:
            self.state[[lanes.LEFT, lanes.RIGHT]] = np.nan
        law = cast(AngleLaw, experiment.law)  # nothing else is able
        self._law = gains(law, experiment.target, experiment.first_follower)
        saturation = experiment.scenario.robot.saturation if experiment.plant == "saturated" else None
        self._wheels = lanes.wheels(experiment.robot.drive, nid, saturation)
        silence = np.empty((runs, n, 0, 2))
        self._guard = Guard(
            experiment.safety != "none",
            constants(experiment.filter_settings, experiment.robot.drive, nid, experiment.n),
            things(experiment.arena),
            Noise(silence, silence),
        )

    def advance(self, most: int, fields: int = MOTION, blocked: bool = False) -> Iterator[Chunk]:
        """All periods, in chunks of ``most`` at most, each of one phase.

        Args:
            most: periods in a chunk.
            fields: of the states that a chunk has.
            blocked: whether it has each period's blockers; else they are those of its last period.
        """
        from scenarios.simulation.compiled.period import advance, integrate

        _, n, runs = self.state.shape
        rows = np.empty((most, fields, n, runs))
        blockers = np.full((most if blocked else 1, n, runs, BLOCKERS), -1, dtype=np.int32)
        first = 1
        for part in self._parts:
            commands = _commands(self._phases[part.index], part.period)
            for done in range(0, part.count, most):
                room = rows[: part.count - done]
                if self._free:
                    integrate(self.state, room, self._law, commands)
                else:
                    after = blockers[: len(room)]
                    advance(self.state, room, after, self._law, commands, self._guard, self._wheels)
                yield Chunk(first, part.index, room, blockers)
                first += len(room)


def _commands(phase: Phase, period: float) -> Commands:
    from scenarios.simulation.compiled.period import Commands

    (vx, vy), (dx, dy) = phase.velocity, phase.delta or (0.0, 0.0)
    return Commands(float(vx), float(vy), float(dx), float(dy), period)
