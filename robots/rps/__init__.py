"""The programming interface of the Robotarium's public simulator, ``rps``, over our worlds.

Both generations of it, written from what they publish: ``version2`` is 2.1 of 2026, ``version1`` what was there from
2018 on. Here alone robots are columns: poses are (3, N) arrays x, y, theta of the axle's centres, metres and radians,
single-integrator states and velocities (2, N), unicycle commands (2, N) v, omega, m/s and rad/s. Robots are counted
from 0, as the scripts index them.

:mod:`robots.rps.hook` serves all of it as modules named ``rps``, so that scripts run as they are. Run folders, figures
of runs and recordings are not made here.
"""

__all__ = [
    "certificates",
    "columns",
    "constants",
    "distances",
    "hook",
    "inertial",
    "picture",
    "robotarium",
    "session",
    "simulation",
    "starts",
    "version1",
    "version2",
    "words",
]
