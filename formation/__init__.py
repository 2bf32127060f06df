"""The theory: graphs, angles, targets, laws, predictions. numpy only; knows no robot, no clock, no file.

A row of an array is an agent. Rooms of their own have :mod:`formation.graph`, :mod:`formation.laws`,
:mod:`formation.analysis` and :mod:`formation.audit`.
"""

from typing import TYPE_CHECKING, Any

from formation.activation import SequentialActivation as SequentialActivation
from formation.activation import collision_margins as collision_margins
from formation.analysis.closed_loop import asymptotic_rates as asymptotic_rates
from formation.analysis.closed_loop import closed_loop_matrix as closed_loop_matrix
from formation.analysis.closed_loop import propagate as propagate
from formation.analysis.closed_loop import settling_bound as settling_bound
from formation.analysis.prediction import Similarity as Similarity
from formation.analysis.prediction import decay_rates as decay_rates
from formation.analysis.prediction import end_configuration as end_configuration
from formation.analysis.prediction import end_similarity as end_similarity
from formation.analysis.prediction import fit_similarity as fit_similarity
from formation.angles import AngleSet as AngleSet
from formation.angles import signed_angle as signed_angle
from formation.angles import wrap as wrap
from formation.constraint import constraint_coefficients as constraint_coefficients
from formation.constraint import interior_angles as interior_angles
from formation.estimator import VelocityEstimator as VelocityEstimator
from formation.framework import Framework as Framework
from formation.from_angles import target_from_angles as target_from_angles
from formation.graph.directed import DirectedGraph as DirectedGraph
from formation.graph.directed import Graph as Graph
from formation.graph.sensing import SensingGraph as SensingGraph
from formation.laws.angle import AngleLaw as AngleLaw
from formation.laws.angle import follower_gains as follower_gains
from formation.laws.base import Law as Law
from formation.laws.catalogue import LAWS as LAWS
from formation.laws.first_follower import EDGE_LAWS as EDGE_LAWS
from formation.laws.protocol import FormationLaw as FormationLaw
from formation.laws.protocol import Needs as Needs
from formation.laws.protocol import needs as needs
from formation.maneuver import Phase as Phase
from formation.maneuver import pair_ends as pair_ends
from formation.plane import rotation as rotation
from formation.random_target import random_target as random_target
from formation.target import TargetFormation as TargetFormation

__all__ = [
    "AngleLaw",
    "AngleSet",
    "DirectedGraph",
    "EDGE_LAWS",
    "FormationLaw",
    "Framework",
    "Graph",
    "LAWS",
    "Law",
    "Needs",
    "Phase",
    "SensingGraph",
    "SequentialActivation",
    "Similarity",
    "TargetFormation",
    "VelocityEstimator",
    "__version__",
    "asymptotic_rates",
    "closed_loop_matrix",
    "collision_margins",
    "constraint_coefficients",
    "decay_rates",
    "end_configuration",
    "end_similarity",
    "fit_similarity",
    "follower_gains",
    "interior_angles",
    "needs",
    "pair_ends",
    "propagate",
    "random_target",
    "rotation",
    "settling_bound",
    "signed_angle",
    "target_from_angles",
    "wrap",
]


if not TYPE_CHECKING:  # type checkers would take any name for one that is there

    def __getattr__(name: str) -> Any:
        """``__version__``, looked up when it is asked for: that takes longer than to load the package."""
        if name == "__version__":
            from importlib.metadata import version

            return version("angle-formation")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
