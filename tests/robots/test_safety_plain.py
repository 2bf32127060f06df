"""The compiled filter beside its own description, written down plainly: one robot, one row, one step after another."""

from __future__ import annotations

import daqp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism
from robots.obstacles import Obstacle, disc
from robots.safety import FilterSettings, make_filter
from robots.worlds.lanes import SIDE

AHEAD, PERIOD = 0.025, 0.1
NID = NearIdentityDiffeomorphism(AHEAD)
LIMIT = GTERNAL.drive.speed_limit * (1.0 - 1e-6)
WEIGHT = GTERNAL.drive.base_length / (2.0 * AHEAD)
DIAMOND = np.array([[x, y * WEIGHT] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
OBSTACLES = (disc((0.25, 0.1), 0.06), Obstacle(np.array([[-0.3, -0.25], [-0.1, -0.3]]), 0.02))
SETTINGS = FilterSettings(0.16, 0.31, 0.085, 4.0, 0.6, 0.5)

Row = tuple[complex, float, float]


def share(v: np.ndarray, g: np.ndarray) -> float:
    """The largest s <= 1 with v + s g within the wheels' limits, of a v within them, to 1e-12."""
    if np.abs(DIAMOND @ (v + g)).max() <= LIMIT:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if (DIAMOND @ (v + middle * g)).max() <= LIMIT else (low, middle)
    return low


class Plain:
    """One robot's memory, and what the filter does with it."""

    def __init__(self) -> None:
        self.stuck, self.side = 0.0, 1.0

    def rows(
        self, i: int, p: np.ndarray, arena: Arena, frame: complex, v: np.ndarray
    ) -> list[tuple[complex, float, float]]:
        """Normals in the body frame, thresholds, m/s, and how close each thing is."""
        found, window = [], SETTINGS.sensing_range - SETTINGS.safe_distance
        for j in set(range(len(p))) - {i}:
            e = complex(*(p[i] - p[j])) * np.conj(frame)
            distance = abs(e)
            if distance < SETTINGS.sensing_range:
                n = e / distance
                h = distance**2 - SETTINGS.safe_distance**2
                level = (np.conj(n) * complex(*v)).real - SETTINGS.gain * h / (4.0 * distance)
                found.append((n, level, (SETTINGS.sensing_range - distance) / window))
        things = [obstacle.nearest(p[i]) for obstacle in arena.obstacles]
        if arena.walls:
            (x, y), (left, right), (low, high) = p[i], arena.x, arena.y
            things += [(x - left, [1, 0]), (right - x, [-1, 0]), (y - low, [0, 1]), (high - y, [0, -1])]
        for distance, away in things:
            if distance < SETTINGS.clearance + window:
                room = float(distance) - SETTINGS.clearance
                found.append((complex(*away) * np.conj(frame), -SETTINGS.gain * room, 1.0 - room / window))
        return [(n, level, min(max(close, 0.0), 1.0)) for n, level, close in found]

    def step(self, rows: list[Row], g: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, float]:
        """The command and the intervention; the stuck time and the side go on."""
        law = complex(*g)
        crowding = max([0.0] + [-close * (np.conj(n) * law).real / abs(law) for n, _, close in rows])
        turn = SETTINGS.turn * crowding + min(1.5, 0.5 * max(0.0, self.stuck - SETTINGS.stuck_time))
        turned = law * np.exp(1j * turn * self.side)
        turned_g = np.array([turned.real, turned.imag])
        wish = v + share(v, turned_g) * turned_g
        a = np.array([[n.real, n.imag] for n, _, _ in rows] + [list(side) for side in -DIAMOND])
        b = np.array([level for _, level, _ in rows] + [-LIMIT] * 4)
        u, _, flag, _ = daqp.solve(np.eye(2), -wish, a, np.full(len(b), 1e30), b, np.zeros(len(b), dtype=np.int32))
        assert flag == 1
        intervention = float(np.linalg.norm(u - v - share(v, g) * g))
        wished = float(np.linalg.norm(wish - v))
        if np.linalg.norm(u - v) < 0.3 * wished and wished > 0.01:
            self.stuck += PERIOD
            if self.stuck >= SETTINGS.stuck_time + 3.0:
                self.stuck, self.side = SETTINGS.stuck_time, -self.side
        else:
            self.stuck = max(0.0, self.stuck - 0.4 * PERIOD)
            self.side = 1.0 if self.stuck == 0.0 else self.side
        return u, intervention


@settings(max_examples=3)
@given(seed=st.integers(0, 2**32 - 1), walls=st.booleans())
def test_a_period_is_that_of_its_description(seed: int, walls: bool) -> None:
    rng, n = np.random.default_rng(seed), 6
    arena = Arena((-0.45, 0.5), (-0.4, 0.45), walls, OBSTACLES)
    places: list[np.ndarray] = []
    while len(places) < n:
        place = rng.uniform([-0.36, -0.31], [0.41, 0.36])
        far = all(np.linalg.norm(place - other) > 0.165 for other in places)
        if far and all(obstacle.distance(place) > 0.09 for obstacle in OBSTACLES):
            places.append(place)
    points, headings = np.array(places), np.exp(1j * rng.uniform(-3.0, 3.0, n))
    filtered = make_filter("decentralised", (n,), GTERNAL.drive, NID, SETTINGS, arena)
    plain = [Plain() for _ in range(n)]
    frames = np.stack([headings.real, headings.imag], axis=1)
    for period in range(45):
        if period % 15 == 0:
            g = rng.normal(0.0, 0.15, (n, 2))
            world = complex(*rng.uniform(-0.01, 0.01, 2)) * (not walls)
            v = np.stack([(world * np.conj(headings)).real, (world * np.conj(headings)).imag], axis=1)
        u = filtered.filter(points, frames, g, v, PERIOD)
        for i in range(n):
            expected, intervention = plain[i].step(plain[i].rows(i, points, arena, headings[i], v[i]), g[i], v[i])
            np.testing.assert_allclose(u[i], expected, atol=1e-7)
            assert filtered.intervention[i] == pytest.approx(intervention, abs=1e-7)
            assert filtered.stuck[i] == pytest.approx(plain[i].stuck, abs=1e-9)
            assert filtered._states[0][SIDE, i, 0] == plain[i].side
    assert not filtered.relaxation.any()
    assert (filtered.blockers == -1).all()
