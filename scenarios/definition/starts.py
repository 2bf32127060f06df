"""Where a run starts: positions and headings, the scenario's or drawn from the seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import Framework, agents, end_similarity
from robots import GTERNAL, Arena
from robots.obstacles import Obstacle
from scenarios.definition.schema import RandomStartTable, Scenario
from scenarios.definition.targets import in_order
from scenarios.errors import InputError, located

Real = NDArray[np.float64]

MAX_DRAWS = 10_000
"""Places tried for one robot before the rectangle counts as full."""


@dataclass(frozen=True, eq=False)
class Starts:
    """The initial state, as far as the scenario fixes it.

    Attributes:
        path: of the scenario file, for messages.
        points: (n, 2) initial projected points, metres; None where the seed decides.
        headings: (n,) initial headings, radians; NaN where the seed decides.
        random: how points are drawn.
        obstacles: no robot is drawn closer to one than ``clearance``, metres.
    """

    path: str
    points: Real | None
    headings: Real
    random: RandomStartTable | None
    obstacles: tuple[Obstacle, ...] = ()
    clearance: float = 0.0

    def draw(self, rng: np.random.Generator) -> tuple[Real, Real]:
        """Projected points (n, 2), metres, and headings (n,), radians, of one run.

        Raises:
            InputError: the rectangle of ``random_start`` has no room for all robots.
        """
        drawn = rng.uniform(-np.pi, np.pi, len(self.headings))
        headings = np.where(np.isnan(self.headings), drawn, self.headings)
        if self.points is not None:
            return self.points, headings
        return self._scatter(rng), headings

    def _scatter(self, rng: np.random.Generator) -> Real:
        table = self.random or RandomStartTable()
        low, high = np.array([table.x_m, table.y_m]).T
        points = np.empty((len(self.headings), 2))
        for row in range(len(points)):
            for _ in range(MAX_DRAWS):
                points[row] = rng.uniform(low, high)
                if any(obstacle.distance(points[row]) < self.clearance for obstacle in self.obstacles):
                    continue
                if (np.linalg.norm(points[:row] - points[row], axis=1) >= table.min_separation_m).all():
                    break
            else:
                raise InputError(
                    f"{self.path}: random_start: no place left for {agents.name(row)} at a separation of "
                    f"{table.min_separation_m:g} m"
                )
        return points


def build_starts(path: str, scenario: Scenario, formation: Framework, arena: Arena) -> Starts:
    """The starts of a scenario.

    Raises:
        InputError: a start is missing, lies in an obstacle, or agents 1 and 2 coincide.
    """
    ordered = in_order(scenario.agents)
    degrees = [np.nan if agent.heading_deg is None else agent.heading_deg for agent in ordered]
    headings = np.radians(degrees) if ordered else np.full(formation.graph.n, np.nan)
    random = scenario.random_start
    if random is not None:
        for axis, (low, high) in (("x_m", random.x_m), ("y_m", random.y_m)):
            if not low < high:
                raise InputError(
                    f"{path}: random_start.{axis}: expected [low, high] with low < high, got [{low}, {high}]"
                )
        return Starts(path, None, headings, random, arena.obstacles, scenario.safety.clearance_m)
    if not ordered:
        raise InputError(f"{path}: random_start: missing, random_formation has no starts of its own")
    for agent in ordered:
        if agent.start is None:
            raise InputError(f"{path}: agents[id {agent.id}].start: missing")
        for number, obstacle in enumerate(arena.obstacles, start=1):
            if (distance := float(obstacle.distance(agent.start))) < GTERNAL.chassis.radius:
                raise InputError(
                    f"{path}: agents[id {agent.id}].start: expected at least {GTERNAL.chassis.radius:.3f} m from "
                    f"obstacle {number}, got {distance:.3f} m"
                )
    points = np.array([agent.start for agent in ordered])
    with located(path, "agents[id 2].start"):
        end_similarity(formation, points[agents.LEADER], points[agents.FIRST_FOLLOWER])
    return Starts(path, points, headings, None)
