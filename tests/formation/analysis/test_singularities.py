"""How far the first follower's motion is from its nearest singularity: as long as a step may be that is still exact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formation.analysis.first_follower import SETTLED, motion

LENGTHS = st.floats(0.05, 4.0)


@given(start=LENGTHS, wanted=LENGTHS, share=st.floats(0.0, 2.0))
def test_by_distance_no_step_reaches_the_singularity_and_none_is_far_shorter(
    start: float, wanted: float, share: float
) -> None:
    """e has a root in its denominator where e^{-2 D^2 t} = s / (s - 1), s = (e_0 / D)^2."""
    s, rate = (start / wanted) ** 2, 2.0 * wanted**2
    if abs(s - 1.0) < 1e-9:
        return
    singular = np.log(complex((s - 1.0) / s)) / rate
    far = motion("distance", start + 0j, wanted + 0j)
    for t in {share / rate, max(0.0, singular.real)}:
        nearest = min(abs(t - singular - 2j * np.pi * m / rate) for m in (-1, 0, 1))
        assert far.nearest(t) <= nearest * (1.0 + 1e-9)
        least = nearest / 1.4 if s >= 2.0 else 1.0 / (rate * s)
        assert far.nearest(t) >= min(least, np.pi / rate) * (1.0 - 1e-9)
    assert far.nearest(1.01 * SETTLED / rate) == np.inf
    assert far.nearest(0.99 * SETTLED / rate) < np.inf


@given(length=LENGTHS, turn=st.floats(0.1, 3.0), share=st.floats(0.0, 3.0))
def test_by_bearing_a_step_is_as_long_as_the_singularity_may_be_near(length: float, turn: float, share: float) -> None:
    """The direction has no angle where e^{-t / |e_0|} = i cot(phi_0 / 2)."""
    far = motion("bearing", length * np.exp(1j * turn), 0.3 + 0j)
    late = -length * np.log(1.0 / np.tan(turn / 2.0))
    nearest = min(abs(share * length - complex(late, side * np.pi * length / 2.0)) for side in (1.0, -1.0))
    assert far.nearest(share * length) <= nearest * (1.0 + 1e-9)
    assert far.nearest(share * length) == pytest.approx(np.pi * length / 2.0)
    assert far.nearest(1.01 * SETTLED * length) == np.inf


def test_of_many_motions_at_once_the_nearest_singularity_of_all_counts() -> None:
    starts = np.array([0.2, 1.0, 2.0]) + 0j
    together = motion("bearing", starts * 1j, 1.0 + 0j)
    assert together.nearest(0.0) == pytest.approx(0.1 * np.pi)
    assert together.nearest(0.5 * SETTLED) == pytest.approx(0.1 * np.pi)
    assert together.nearest(2.1 * SETTLED) == np.inf
    assert motion("distance", starts, 1.0 + 0j).nearest(0.0) == pytest.approx(1.0 / 8.0)


@pytest.mark.parametrize("law", ["stationary", "displacement"])
def test_a_motion_without_singularity_allows_any_step(law: str) -> None:
    assert motion(law, 1.0 + 0j, 1j).nearest(0.0) == np.inf


def test_a_first_follower_that_is_told_nothing_stays() -> None:
    for law in ("displacement", "distance", "bearing", "spiral"):
        still = motion(law, np.array([1.0 + 2j, 3.0]), None)
        np.testing.assert_array_equal(still.at(np.array([0.5, 7.0])), [1.0 + 2j, 3.0])
