"""Figures of many runs at once: where they begin and how they end. No figure here shows a single run's course."""

__all__ = ["shapes"]
