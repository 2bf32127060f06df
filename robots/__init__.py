"""The machines: drive, NID map, arena, worlds, sensors, testbed rules. Knows no formation law."""

from robots.arena import ROBOTARIUM_FLOOR as ROBOTARIUM_FLOOR
from robots.arena import Arena as Arena
from robots.drive import DifferentialDrive as DifferentialDrive
from robots.model import GTERNAL as GTERNAL
from robots.model import Chassis as Chassis
from robots.model import RobotModel as RobotModel
from robots.nid import NearIdentityDiffeomorphism as NearIdentityDiffeomorphism
from robots.sensors import RelativePositionSensor as RelativePositionSensor
from robots.testbed import Verdict as Verdict
from robots.testbed import judge as judge
from robots.worlds import PLANTS as PLANTS
from robots.worlds import World as World
from robots.worlds import make_world as make_world
