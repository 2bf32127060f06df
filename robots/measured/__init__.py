"""Robots as logs and firmware show them: between a command and the wheels, between the robots and the cameras.

What a data sheet says of them is not here: :mod:`robots.model` has it.
"""

from robots.measured.model import MEASURED as MEASURED
from robots.measured.model import MeasuredModel as MeasuredModel

__all__ = ["camera", "link", "model", "streams", "wheels", "world"]
