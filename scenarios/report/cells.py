"""How the reports write places, and what stands where the theory has nothing to say."""

from __future__ import annotations

from typing import Any

NO_PREDICTION = "no closed-form prediction for an own law or a leaderless one: `formation audit` measures what it does"
"""What stands where the theory speaks of the other laws."""

ROUNDED = 5e-5
"""Coordinates below this are written as zero."""


def digits(value: float, decimals: int) -> str:
    """A number with so many decimals, or with two digits and an exponent where these would hide it.

    >>> digits(0.5, 3), digits(1e-8, 3), digits(0.0, 3)
    ('0.500', '1.0e-08', '0.000')
    """
    return f"{value:.1e}" if 0.0 < abs(value) < 10.0 ** (1 - decimals) else f"{value:.{decimals}f}"


def place(point: Any) -> str:
    """A point, a displacement or a velocity: two numbers, or None where it is not finite.

    >>> place((0.12345, -1e-9)), place((None, None))
    ('(0.1235, 0)', 'nowhere')
    """
    if None in point:
        return "nowhere"
    x, y = (float(c) + 0.0 if abs(c) > ROUNDED else 0.0 for c in point)
    return f"({x:.4g}, {y:.4g})"
