"""How the reports write places, and what stands where the theory has nothing to say."""

from __future__ import annotations

from typing import Any

NO_PREDICTION = "no closed-form prediction for an own law or a leaderless one: `formation audit` measures what it does"
"""What stands where the theory speaks of the other laws."""

CHANGING = "changing"
"""What stands for a command that a reference changes all the time."""

MOST_PHASES = 12
"""Phases that a table tells of."""

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


def chosen(count: int) -> tuple[int, ...]:
    """Which of so many phases a table tells of: all, or so many that are equally far apart, the last among them.

    >>> chosen(3), chosen(720)[:2], chosen(720)[-1], len(chosen(720))
    ((0, 1, 2), (59, 119), 719, 12)
    """
    if count <= MOST_PHASES:
        return tuple(range(count))
    return tuple((count * part) // MOST_PHASES - 1 for part in range(1, MOST_PHASES + 1))
