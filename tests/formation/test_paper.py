"""What the paper states inconsistently, and that the resolutions hold, by their number in docs/paper.md."""

import numpy as np
import pytest

from formation import AngleLaw, AngleSet, SensingGraph, TargetFormation, agents, decay_rates, end_configuration, wrap

GRAPH = SensingGraph(agents.rows([[1, 2], [2, 3], [1, 4], [1, 4]]))
STAR = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]])
START = np.array([[0.0, 0.5], [-0.5, 0.0], [0.0, 0.025], [0.25, 0.4], [0.5, -0.35], [0.6, 0.2]])
LISTED_DEG = {
    (1, 2, 3): 90.0,
    (2, 1, 3): 315.0,
    (3, 2, 4): 45.0,
    (4, 2, 3): 270.0,
    (4, 1, 5): 63.43,
    (5, 1, 4): 306.87,
    (4, 1, 6): 296.57,
    (6, 1, 4): 53.13,
}
PRINTED = 0.005
TARGET = TargetFormation(GRAPH, STAR)


def test_read_vertex_first_all_eight_listed_angles_belong_to_the_target() -> None:
    """Resolution 1."""
    measured = AngleSet(agents.rows(list(LISTED_DEG))).measure(STAR)
    assert np.degrees(measured) == pytest.approx(list(LISTED_DEG.values()), abs=PRINTED)


def test_read_with_the_vertex_in_the_middle_two_listed_angles_contradict_each_other() -> None:
    """Resolution 1: alpha_324 and alpha_423 would be one angle both ways, which adds up to one turn."""
    middle_first = agents.rows([[2, 3, 4], [2, 4, 3]])
    measured = np.degrees(AngleSet(middle_first).measure(STAR))
    assert measured.sum() == pytest.approx(360.0)
    assert LISTED_DEG[3, 2, 4] + LISTED_DEG[4, 2, 3] != pytest.approx(360.0)


def test_counter_clockwise_the_robots_end_symmetric_about_the_arenas_centre() -> None:
    """Resolution 2."""
    end = end_configuration(TARGET, START[0], START[1])
    expected = [[0.0, 0.5], [-0.5, 0.0], [0.5, 0.0], [0.0, -0.5], [-1.0, 0.0], [1.0, 0.0]]
    np.testing.assert_allclose(end, expected, atol=1e-12)
    assert sorted(map(tuple, np.round(-end, 9) + 0.0)) == sorted(map(tuple, np.round(end, 9) + 0.0))


def test_clockwise_one_robot_would_end_on_the_arenas_edge_and_one_beyond_it() -> None:
    """Resolution 2: clockwise angles belong to the mirrored target; the floor ends at y = 1 m."""
    mirrored = TargetFormation(GRAPH, STAR * [1.0, -1.0])
    end = end_configuration(mirrored, START[0], START[1])
    np.testing.assert_allclose(end[[2, 5]], [[-0.5, 1.0], [-0.5, 1.5]], atol=1e-12)


def test_the_followers_rates_are_those_of_the_error_and_half_of_the_lyapunov_functions() -> None:
    """Resolution 4, checked on the derivative of V = |p_k - p_k_dagger|^2 / 2 with settled neighbours."""
    np.testing.assert_allclose(np.degrees(TARGET.follower_angles), [315.0, 90.0, 53.13, 306.87], atol=PRINTED)
    np.testing.assert_allclose(decay_rates(TARGET), [0.5, 1.0, 0.64, 0.64], atol=1e-12)
    observer, observed = GRAPH.edges.T
    for k, rate in zip(GRAPH.followers, decay_rates(TARGET), strict=True):
        points = STAR.copy()
        points[k] += [0.3, -0.2]
        error = points[k] - STAR[k]
        u = AngleLaw(TARGET)(points[observed] - points[observer])[k]
        assert u @ error == pytest.approx(-2.0 * rate * (error @ error / 2.0))


def test_two_decimals_of_a_degree_leave_a_floor_under_the_sum_of_errors() -> None:
    """Resolution 7."""
    angles = AngleSet(agents.rows(list(LISTED_DEG)))
    listed = np.radians(list(LISTED_DEG.values()))
    assert np.abs(wrap(angles.measure(STAR) - listed)).sum() == pytest.approx(1.76e-4, abs=0.01e-4)
    assert np.abs(angles.errors(STAR, angles.measure(STAR))).sum() == 0.0
