"""What the safety filter did in a run, for ``result.json``: interventions, infeasible problems, deadlocks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from formation import agents
from robots.safety.protocol import WALLS
from scenarios.definition.experiment import Experiment
from scenarios.simulation.trajectory import Trajectory

Numbering = Callable[[int], int]
"""Maps the row of an agent to its number."""

NOTICEABLE = 1e-3
"""m/s from which a change of the law's velocity counts as an intervention."""

SIDES = ("south", "east", "north", "west")


def safety_result(experiment: Experiment, trajectory: Trajectory) -> dict[str, Any]:
    """The keys ``interventions``, ``relaxed`` and ``deadlocks`` of a single run."""
    return {
        "interventions": _interventions(trajectory),
        "relaxed": _relaxed(trajectory, experiment.number),
        "deadlocks": deadlocks(trajectory, experiment.filter_settings.stuck_time, experiment.number),
    }


def deadlocks(trajectory: Trajectory, stuck_time: float, number: Numbering = agents.number) -> list[dict[str, Any]]:
    """Every declared deadlock: the agent, from when it was stuck, and when it had moved on, null if never."""
    found = []
    stuck = trajectory.stuck >= stuck_time
    edges = np.diff(stuck.astype(np.int8), axis=0, prepend=0)
    for row in np.flatnonzero(stuck.any(axis=0)).tolist():
        starts, ends = (np.flatnonzero(edges[:, row] == sign) for sign in (1, -1))
        for place, start in enumerate(starts):
            until = float(trajectory.t[ends[place]]) if place < len(ends) else None
            found.append({"agent": number(row), "from_s": float(trajectory.t[start]), "until_s": until})
    return sorted(found, key=lambda d: (d["from_s"], d["agent"]))


def _interventions(trajectory: Trajectory) -> dict[str, Any]:
    change = trajectory.intervention[1:]
    noticed = change > NOTICEABLE
    return {
        "threshold_m_s": NOTICEABLE,
        "share": float(noticed.mean()),
        "agent_shares": noticed.mean(axis=0).tolist(),
        "largest_m_s": float(np.nan_to_num(change).max(initial=0.0)),
    }


def _relaxed(trajectory: Trajectory, number: Numbering) -> dict[str, Any]:
    amount = trajectory.relaxation
    n = amount.shape[1]
    problems = amount > 0.0
    involved = []
    for row in np.flatnonzero(problems.any(axis=0)).tolist():
        first = int(problems[:, row].argmax())
        involved.append(
            {
                "agent": number(row),
                "count": int(problems[:, row].sum()),
                "largest_m_s": float(amount[:, row].max()),
                "first": {
                    "time_s": float(trajectory.t[first]),
                    "rows": [row_name(code, n, number) for code in trajectory.blockers[first, row] if code >= 0],
                },
            }
        )
    return {
        "count": int(problems.sum()),
        "of": (len(amount) - 1) * n,
        "largest_m_s": float(amount.max(initial=0.0)),
        "agents": involved,
    }


def row_name(code: int | np.signedinteger[Any], n: int, number: Numbering = agents.number) -> str:
    """What a row of a filter's problem belongs to, among ``n`` robots: ``agent 3``, ``east wall`` or ``obstacle 1``.

    >>> row_name(2, 6), row_name(7, 6), row_name(10, 6)
    ('agent 3', 'east wall', 'obstacle 1')
    """
    if code < n:
        return f"agent {number(int(code))}"
    if code < n + WALLS:
        return f"{SIDES[int(code) - n]} wall"
    return f"obstacle {int(code) - n - WALLS + 1}"
