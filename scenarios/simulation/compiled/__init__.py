"""Experiments whose whole control period is compiled, one run or many. No measure, and no run that Python steps."""

__all__ = ["ability", "orders", "period", "record", "runs"]
