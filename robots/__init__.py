"""The machines: drive, NID map, arena, worlds, safety filters, sensors, testbed rules. Knows no formation law, no file.

Physical constants live here, each with its unit and source. Rooms of their own have :mod:`robots.worlds` and
:mod:`robots.safety`.
"""

from typing import TYPE_CHECKING, Any

from robots.arena import ROBOTARIUM_FLOOR as ROBOTARIUM_FLOOR
from robots.arena import Arena as Arena
from robots.drive import DifferentialDrive as DifferentialDrive
from robots.instruments import Imperfections as Imperfections
from robots.instruments import Instruments as Instruments
from robots.model import GTERNAL as GTERNAL
from robots.model import Chassis as Chassis
from robots.model import Fleet as Fleet
from robots.model import RobotModel as RobotModel
from robots.nid import NearIdentityDiffeomorphism as NearIdentityDiffeomorphism
from robots.sensors import RelativePositionSensor as RelativePositionSensor
from robots.testbed import Verdict as Verdict
from robots.testbed import judge as judge
from robots.worlds import PLANTS as PLANTS
from robots.worlds import World as World
from robots.worlds import make_world as make_world

__all__ = [
    "Arena",
    "Chassis",
    "DifferentialDrive",
    "Fleet",
    "GTERNAL",
    "Imperfections",
    "Instruments",
    "NearIdentityDiffeomorphism",
    "PLANTS",
    "ROBOTARIUM_FLOOR",
    "RelativePositionSensor",
    "RobotModel",
    "Verdict",
    "World",
    "__version__",
    "judge",
    "make_world",
]


if not TYPE_CHECKING:  # type checkers would take any name for one that is there

    def __getattr__(name: str) -> Any:
        """``__version__``, looked up when it is asked for: that takes longer than to load the package."""
        if name == "__version__":
            from importlib.metadata import version

            return version("angle-formation")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
