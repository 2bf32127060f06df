"""The Robotarium's programming interface over our worlds, for scripts that were written for ``rps.robotarium``.

The class is that of ``rps`` 2.1, :class:`robots.rps.version2.robotarium.Robotarium`, whose draws are its own: nothing
here touches numpy's global generator. ``formation script`` runs scripts as they are, see :mod:`robots.rps`.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from robots.rps.starts import MOST_ROBOTS as MOST_ROBOTS
from robots.rps.version2 import robotarium as version2
from robots.rps.version2.barrier_certificates import (
    create_si_barrier_certificate_with_boundary as create_si_barrier_certificate_with_boundary,
)


class Robotarium(version2.Robotarium):
    """N robots on the testbed's floor, driven step by step, in the very worlds of the scenarios.

    Args:
        number_of_robots: 1 to 50; -1 takes as many as ``initial_conditions`` has columns.
        show_figure: whether there is a figure from the start; else there is one as soon as it is asked for.
        sim_in_real_time: accepted; a step never waits.
        initial_conditions: (3, N) poses at which the robots stand; absent or empty, they are drawn.
        plant: ``unicycle``, ``saturated`` or ``pymunk``; see :mod:`robots.worlds`.
        seed: of the poses that are drawn, and of the sensors' noise.
        others: as in ``rps`` 2.1.

    Raises:
        ValueError: no such plant, no such number of robots, or poses that have another shape or are not finite.
    """

    held = False

    def __init__(
        self,
        number_of_robots: int = -1,
        show_figure: bool = False,
        sim_in_real_time: bool = False,
        initial_conditions: ArrayLike | None = None,
        *,
        plant: str = "pymunk",
        seed: int = 0,
        **others: Any,
    ) -> None:
        super().__init__(
            number_of_robots, show_figure, sim_in_real_time, initial_conditions, plant=plant, seed=seed, **others
        )
