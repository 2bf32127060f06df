"""Targets from angles (paper, Lemma 1): two angles fix each triangle, the triangles fix the shape.

A named angle alpha(v; a, b) of the triangle (i, j, k) is one of its interior signed angles

    a_i = alpha(i; k, j),   a_j = alpha(j; i, k),   a_k = alpha(k; j, i)

or its complement to 2 pi. All three interior angles turn the same way: they lie in (0, pi) and add up to pi, or lie in
(pi, 2 pi) and add up to 5 pi. Positions follow from the proof's recursion p_k = -A_k^{-1} (A_i p_i + A_j p_j).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from formation import agents
from formation.angles import TURN, AngleSet, angle_name, wrap
from formation.constraint import constraint_coefficients
from formation.graph.sensing import SensingGraph
from formation.plane import Real, as_vectors
from formation.target import DEGENERATE_SINE, TargetFormation

NEXT_VERTEX = {0: (2, 1), 1: (0, 2), 2: (1, 0)}
"""For the corner at place c of (i, j, k): the places of the corners that its interior angle turns from and to."""


def target_from_angles(
    graph: SensingGraph, angles: AngleSet, values: ArrayLike, tolerance: float = 1e-9
) -> TargetFormation:
    """The target formation with the given angles, with p_1 = (0, 0) and p_2 = (1, 0).

    Args:
        graph: the sensing graph.
        angles: at least two angles of each follower's triangle and none of any other triangle.
        values: (m,) their values, radians.
        tolerance: radians by which angles that are given twice over may disagree.

    Raises:
        ValueError: an angle belongs to no triangle; a triangle has fewer than two angles; its angles turn opposite ways
            (wrong orientation), cannot close the triangle, contradict each other, or make it degenerate. The message
            names the triangle.
    """
    interior = interior_from_angles(graph, angles, np.asarray(values, dtype=np.float64), tolerance)
    return TargetFormation(graph, positions_from_interior(graph, interior))


def positions_from_interior(graph: SensingGraph, interior: Real) -> Real:
    """(n, 2) the recursion of Lemma 1's proof from interior angles (n - 2, 3), radians; p_1 = (0, 0), p_2 = (1, 0)."""
    a_i, a_j, a_k = constraint_coefficients(interior).T
    weight_i, weight_j = (-a_i / a_k).tolist(), (-a_j / a_k).tolist()
    p: list[complex] = [0j, 1 + 0j]
    for (i, j), w_i, w_j in zip(graph.neighbours.tolist(), weight_i, weight_j, strict=True):
        p.append(w_i * p[i] + w_j * p[j])
    return as_vectors(np.array(p))


def interior_from_angles(graph: SensingGraph, angles: AngleSet, values: Real, tolerance: float = 1e-9) -> Real:
    """(n - 2, 3) interior signed angles of each triangle (i, j, k), radians. Arguments and errors as above."""
    follower_of = {tuple(sorted(t)): row for row, t in enumerate(graph.triangles.tolist())}
    interior = np.full((len(graph.triangles), 3), np.nan)
    for triple, value in zip(angles.triples.tolist(), values, strict=True):
        row = follower_of.get(tuple(sorted(triple)))
        if row is None:
            raise ValueError(f"{angle_name(triple)} belongs to no follower's triangle")
        corners = graph.triangles[row].tolist()
        place = corners.index(triple[0])
        forward = triple[1] == corners[NEXT_VERTEX[place][0]]
        angle = np.mod(value if forward else -value, TURN)
        known = interior[row, place]
        if np.isfinite(known) and not abs(wrap(known - angle)) <= tolerance:
            raise ValueError(f"{angle_name(triple)} contradicts another value for the same corner")
        interior[row, place] = angle
    for row, found in enumerate(interior):
        interior[row] = _close(found, tuple(agents.numbers(graph.triangles[row]).tolist()), tolerance)
    return interior


def _close(found: Real, triangle: tuple[int, ...], tolerance: float) -> Real:
    """The three interior angles of one triangle from two or three of them."""
    given = np.isfinite(found)
    if given.sum() < 2:
        raise ValueError(f"the triangle {triangle} has {given.sum()} of the 2 angles that fix it")
    if (np.abs(np.sin(found[given])) <= DEGENERATE_SINE).any():
        raise ValueError(f"the triangle {triangle} is degenerate: an angle of {_degrees(found[given])} degrees")
    clockwise = found[given] > np.pi
    if clockwise.any() != clockwise.all():
        raise ValueError(
            f"the angles of the triangle {triangle} have a wrong orientation: {_degrees(found[given])} degrees turn "
            "opposite ways"
        )
    total = 5.0 * np.pi if clockwise.all() else np.pi
    closed = found.copy()
    if given.all():
        if not abs(found.sum() - total) <= 3.0 * tolerance:
            raise ValueError(
                f"the angles of the triangle {triangle} cannot close it: {_degrees(found)} degrees add up to "
                f"{np.degrees(found.sum()):.4f}, expected {np.degrees(total):.0f}"
            )
        return closed
    last = total - found[given].sum()
    low, high = (np.pi, TURN) if clockwise.all() else (0.0, np.pi)
    if not low < last < high:
        raise ValueError(
            f"the angles of the triangle {triangle} cannot close it: {_degrees(found[given])} degrees leave "
            f"{np.degrees(last):.4f} for the third"
        )
    closed[~given] = last
    return closed


def _degrees(angles: Real) -> str:
    return " and ".join(f"{a:.4f}" for a in np.degrees(angles))
