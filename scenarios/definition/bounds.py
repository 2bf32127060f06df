"""How large a scenario may be: every number that something is allocated by, or counted with, has its bound here.

A size beyond a bound is refused in one line before anything is allocated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenarios.errors import InputError

if TYPE_CHECKING:
    from scenarios.definition.schema import Scenario

LARGEST = 1e6
"""Largest magnitude of any number in a file, in its own unit: squares and products of such numbers stay finite."""

SMALLEST = 1e-9
"""Smallest number in a file that must be positive, in its own unit: quotients of such numbers stay finite."""

LARGEST_INTEGER = 2**63 - 1
"""Of TOML: an integer beyond it, or below its negative, is refused wherever it stands."""

MOST_AGENTS = 10_000
"""Agents: matrices of all pairs (the velocity estimator, an audited closed loop) stay below 2 GB each."""

MOST_OBSTACLES = 1_000
"""Obstacles, and vertices of one."""

MOST_EVENTS = 1_000
"""Events of one run: each may split a control period."""

LONGEST_RUN = 1_000_000
"""Control periods whose states are kept in memory; nine hours of the Robotarium's."""

MOST_BYTES = 4_000_000_000
"""Of a run's states, with what is measured of them: twenty million robots times control periods on an open floor."""

STATE_BYTES, VERTEX_BYTES = 200, 64
"""Of one robot in one control period: its own, and for each vertex of the obstacles."""

MOST_STARTS = 1_000_000
"""Random starts that a law is tried from."""


def check_size(path: str, scenario: Scenario, duration: float | None) -> None:
    """Refuse a run whose states would not fit, counted in robots times control periods.

    Args:
        path: of the scenario file, for messages.
        scenario: validated.
        duration: seconds, where it is not the scenario's own.

    Raises:
        InputError: too many control periods, or too many for so many robots.
    """
    period = scenario.plant.control_period_s
    lengths = [phase.duration_s for phase in scenario.phases] or [scenario.duration_s or 0.0]
    seconds = sum(lengths) if duration is None else duration
    periods = max(seconds / period, len(lengths))  # a phase shorter than a period takes one all the same
    field = "duration_s" if duration is None else "--duration"
    if not periods <= LONGEST_RUN:
        raise InputError(
            f"{path}: {field}: expected at most {LONGEST_RUN} control periods of {period:g} s, got {seconds:g} s"
        )
    robots = len(scenario.agents) or (scenario.random_formation.agents if scenario.random_formation else 0)
    vertices = sum(len(obstacle.vertices_m) for obstacle in scenario.obstacles)
    vertices += sum(len(event.vertices_m or ()) for event in scenario.events)
    needed = robots * periods * (STATE_BYTES + VERTEX_BYTES * vertices)
    if not needed <= MOST_BYTES:
        among = f" among {vertices} vertices of obstacles" if vertices else ""
        raise InputError(
            f"{path}: {field}: {robots} robots for {periods:.0f} control periods{among} need {needed / 1e9:.3g} GB, "
            f"expected at most {MOST_BYTES / 1e9:g} GB: fewer robots, a shorter run or a longer control period"
        )
