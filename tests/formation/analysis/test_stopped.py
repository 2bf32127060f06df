"""What a stopped agent does to the others, beside the plain integration of the closed loop."""

import numpy as np
import pytest

from formation import SensingGraph, TargetFormation
from formation.analysis.cascade import Cascade
from formation.analysis.exact import spread

TARGET = TargetFormation(
    SensingGraph([[0, 1], [1, 2], [0, 3], [0, 3]]),
    np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]]),
)


@pytest.mark.parametrize("row", range(6))
def test_the_spread_of_a_stop_is_the_difference_of_two_integrated_motions(row: int) -> None:
    loop, v = Cascade.of(TARGET, 1.0), 0.03 - 0.01j
    t = np.linspace(0.0, 5.0, 401)
    found = spread(loop, row, -v * t, t)
    errors, h = np.zeros(6, dtype=complex), t[1] / 20.0
    for _ in range(20 * 400):  # the midpoint rule in the frame that moves along: the stopped agent falls behind
        slope = loop.apply(errors)
        slope[row] = -v
        middle = loop.apply(errors + h / 2.0 * slope)
        middle[row] = -v
        errors = errors + h * middle
    np.testing.assert_allclose(found[-1], errors, atol=1e-8)


def test_on_a_long_stop_the_others_fall_behind_by_their_share_less_their_lag() -> None:
    loop, v, row = Cascade.of(TARGET, 1.0), 0.02, 3
    t = np.linspace(0.0, 200.0, 4001)
    found = spread(loop, row, -v * t + 0j, t)[-1]
    share, lag = np.zeros(6, dtype=complex), np.zeros(6, dtype=complex)
    share[row] = 1.0
    for k, (i, j) in zip((4, 5), TARGET.graph.neighbours[2:].tolist(), strict=True):
        w = loop.weights[k - 2]
        share[k] = (1.0 - w) * share[i] + w * share[j]
        lag[k] = (1.0 - w) * lag[i] + w * lag[j] + share[k] / loop.rates[k - 1]
    np.testing.assert_allclose(found, -(share * t[-1] - lag) * v, atol=1e-12)
    assert (found[:3] == 0.0).all()
