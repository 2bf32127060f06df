"""The theory: graphs, angles, targets, laws, predictions. numpy only; knows no robot, no clock, no file."""

from formation.angle_law import AngleLaw as AngleLaw
from formation.angle_law import follower_gains as follower_gains
from formation.angles import AngleSet as AngleSet
from formation.angles import signed_angle as signed_angle
from formation.angles import wrap as wrap
from formation.constraint import constraint_coefficients as constraint_coefficients
from formation.constraint import interior_angles as interior_angles
from formation.first_follower import FIRST_FOLLOWER_LAWS as FIRST_FOLLOWER_LAWS
from formation.graph import SensingGraph as SensingGraph
from formation.maneuver import Phase as Phase
from formation.maneuver import pair_ends as pair_ends
from formation.plane import rotation as rotation
from formation.prediction import Similarity as Similarity
from formation.prediction import decay_rates as decay_rates
from formation.prediction import end_configuration as end_configuration
from formation.prediction import end_similarity as end_similarity
from formation.target import TargetFormation as TargetFormation
