"""Who touched what in a run, for ``result.json``."""

from __future__ import annotations

from typing import Any

import numpy as np

from robots.safety.protocol import WALLS
from robots.worlds import NOTHING
from scenarios.definition.experiment import Experiment
from scenarios.measures.safety_result import row_name
from scenarios.simulation.outages import standing
from scenarios.simulation.trajectory import Trajectory


def contacts(experiment: Experiment, trajectory: Trajectory) -> dict[str, Any]:
    """In how many control periods any agent touched another one, a wall or an obstacle, who, and what came first."""
    touches = trajectory.contact != NOTHING
    periods = np.flatnonzero(touches.any(axis=1))
    if not periods.size:
        return {"periods": 0, "agents": [], "first": None}
    first = int(periods[0])
    return {
        "periods": len(periods),
        "agents": experiment.numbered(np.flatnonzero(touches.any(axis=0))).tolist(),
        "first": {
            "time_s": float(trajectory.t[first]),
            "agents": experiment.numbered(np.flatnonzero(touches[first])).tolist(),
            "touching": touching(experiment, trajectory, first),
        },
    }


def touching(experiment: Experiment, trajectory: Trajectory, row: int) -> list[list[str]]:
    """Each pair that touches in a row of the trajectory, by name: two agents, or an agent and a wall or an obstacle.

    A contact with the arena does not say with which part of it: the one nearest to the chassis is named.
    """
    n, pairs = experiment.n, set()
    for agent, other in enumerate(trajectory.contact[row].tolist()):
        if other == n:
            pose, t = trajectory.poses[row, agent], float(trajectory.t[max(0, row - 1)])
            pairs.add((agent, n + _nearest_thing(experiment, agent, pose, t)))
        elif other != NOTHING:
            pairs.add((min(agent, other), max(agent, other)))
    return [[row_name(one, n), row_name(other, n)] for one, other in sorted(pairs)]


def _nearest_thing(experiment: Experiment, agent: int, pose: np.ndarray, t: float) -> int:
    """The wall or the obstacle, counted in this order, that is nearest to an agent's chassis at a pose (3,).

    Of the obstacles that stand in the control period that begins at ``t``, seconds.
    """
    arena, (x, y, theta) = experiment.arena, pose
    turn = np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])
    corners = experiment.fleet.bodies[agent].outline @ turn + [x, y]
    border = np.concatenate(
        [corners + share * (np.roll(corners, -1, axis=0) - corners) for share in (0.0, 0.25, 0.5, 0.75)]
    )
    walls = (border @ arena.half_planes[:, :2].T - arena.half_planes[:, 2]).min(axis=0)
    there = zip(arena.obstacles, standing(experiment, t), strict=True)
    to_things = [thing.distance(border).min() if stands else np.inf for thing, stands in there]
    return int(np.argmin([*(walls if arena.walls else [np.inf] * WALLS), *to_things]))
