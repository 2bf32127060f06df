"""How the reports write places, and what stands where the theory has nothing to say."""

from __future__ import annotations

from typing import Any

NO_PREDICTION = "no closed-form prediction for an own law or a leaderless one: `formation audit` measures what it does"
"""What stands where the theory speaks of the other laws."""

ROUNDED = 5e-5
"""Coordinates below this are written as zero."""


def place(point: Any) -> str:
    """A point, a displacement or a velocity: two numbers, or None where it is not finite.

    >>> place((0.12345, -1e-9)), place((None, None))
    ('(0.1235, 0)', 'nowhere')
    """
    if None in point:
        return "nowhere"
    x, y = (float(c) + 0.0 if abs(c) > ROUNDED else 0.0 for c in point)
    return f"({x:.4g}, {y:.4g})"
