"""What the decentralised filter keeps from period to period, and what it does where it is already too late."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism
from robots.obstacles import disc
from robots.safety import FilterSettings, make_filter, solver
from robots.safety.barrier import STUCK_RECOVERY

NID = NearIdentityDiffeomorphism(0.025)


@given(bearing=st.floats(-np.pi, np.pi), theta=st.floats(-np.pi, np.pi), depth=st.floats(0.001, 0.04))
def test_a_robot_inside_an_obstacle_leaves_it_by_the_shortest_way(bearing: float, theta: float, depth: float) -> None:
    away = np.exp(1j * bearing)
    points = (0.05 - depth) * np.array([[away.real, away.imag]])
    safety = make_filter(
        "decentralised",
        (1,),
        GTERNAL.drive,
        NID,
        FilterSettings(),
        Arena((-9, 9), (-9, 9), False, (disc((0, 0), 0.05),)),
    )
    still = np.zeros((1, 2))
    u = safety.filter(points, np.array([[np.cos(theta), np.sin(theta)]]), still, still, 0.033)
    outward = (complex(*u[0]) * np.exp(1j * theta) * np.conj(away)).real
    heading = theta - bearing
    fastest = max(0.2 * abs(np.cos(heading)), 0.2 / 2.2 * abs(np.sin(heading)))  # a corner of the wheels' diamond
    assert outward == pytest.approx(fastest, rel=1e-5)
    assert safety.relaxation[0] == pytest.approx(5.0 * (depth + 0.08) - outward, abs=1e-6)


@pytest.mark.parametrize("period", [0.033, 0.1])
def test_the_stuck_time_grows_by_the_period_and_shrinks_at_its_own_rate(period: float) -> None:
    """Head-on at the safe distance nobody moves; alone, the law is followed."""
    together = np.array([[0.0, 0.0], [0.155, 0.0]])
    headings = np.array([[1.0, 0.0], [-1.0, 0.0]])
    g, v_r = np.array([[0.1, 0.0], [0.1, 0.0]]), np.zeros((2, 2))
    safety = make_filter("decentralised", (2,), GTERNAL.drive, NID, FilterSettings(turn=0.0))
    for _ in range(5):
        safety.filter(together, headings, g, v_r, period)
    np.testing.assert_allclose(safety.stuck, 5.0 * period)
    safety.filter(together * 9.0, headings, g, v_r, period)
    np.testing.assert_allclose(safety.stuck, (5.0 - STUCK_RECOVERY) * period)


@pytest.mark.parametrize(("lack", "told"), [(2e-10, 0.0), (2e-7, 1e-7)])
def test_a_relaxation_by_rounding_is_no_relaxation(lack: float, told: float) -> None:
    rows = np.empty((solver.WHEEL_ROWS + 2, 3))
    solver.wheel_rows(rows, 0.2, 2.2)
    rows[-2:] = [[1.0, 0.0, 0.05], [-1.0, 0.0, lack - 0.05]]
    x, y, relaxation = solver.project(rows, len(rows), np.empty_like(rows), 0.2, 2.2, 0.0, 0.0)
    assert relaxation == pytest.approx(told, rel=1e-3, abs=1e-15)
    np.testing.assert_allclose([x, y], [0.05 - lack / 2.0, 0.0], atol=1e-9)


def test_the_settings_are_those_of_the_documents_unless_they_are_told() -> None:
    told = FilterSettings(safe_distance=0.155, sensing_range=0.3, clearance=0.08, gain=5.0, turn=0.7, stuck_time=2.0)
    assert FilterSettings() == told
    assert told.safe_distance - 0.1487 == pytest.approx(0.0063, abs=1e-4)
    for name in ("safe_distance", "sensing_range", "clearance", "gain", "stuck_time"):
        for bad in (0.0, -1.0, np.inf, np.nan):
            with pytest.raises(ValueError, match=f"{name} must be a positive number"):
                FilterSettings(**{name: bad})
    assert FilterSettings(turn=0.0).turn == 0.0
    with pytest.raises(ValueError, match="turn must be a positive number"):
        FilterSettings(turn=-0.1)
    with pytest.raises(ValueError, match=r"sensing_range must be beyond safe_distance 0\.155 m, got 0\.155 m"):
        FilterSettings(sensing_range=0.155)
