"""Figures of many runs, and of logs: what a study draws. The figures of one run are not here."""

__all__ = ["dependence", "ladder", "residuals"]
