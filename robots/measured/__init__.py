"""Robots as logs and firmware show them: between a command and the wheels, between the robots and the cameras."""

from robots.measured.model import MEASURED as MEASURED
from robots.measured.model import MeasuredModel as MeasuredModel
