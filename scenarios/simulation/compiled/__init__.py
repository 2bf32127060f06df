"""Experiments whose whole control period is compiled: many runs at once. No measure, and no run that Python steps."""

__all__ = ["ability", "period", "runs"]
