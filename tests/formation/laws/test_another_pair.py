"""Followers that switch between pairs of earlier agents: one place of rest, reached under any switching."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import AngleLaw, SensingGraph, TargetFormation, end_configuration
from formation.laws.another_pair import AnotherPairLaw

P = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]])
TARGET = TargetFormation(SensingGraph([[0, 1], [1, 2], [0, 3], [0, 3]]), P)
LAW = AnotherPairLaw(TARGET)


def measured(points: np.ndarray, lost: np.ndarray) -> np.ndarray:
    observer, observed = LAW.edges.T
    relative = points[observed] - points[observer]
    relative[lost] = np.nan
    return relative


def test_with_all_neighbours_it_is_the_angle_law() -> None:
    points = np.random.default_rng(0).normal(size=(6, 2))
    relative = measured(points, np.zeros(len(LAW.edges), dtype=bool))
    assert (LAW(relative) == AngleLaw(TARGET)(relative[:9])).all()


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_target_is_at_rest_whatever_is_lost(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, scale, shift = np.exp(1j * rng.uniform(0.0, 6.0)), rng.uniform(0.2, 3.0), rng.normal(size=2)
    points = (P.view(np.complex128) * turn * scale).view(np.float64) + shift
    u = LAW(measured(points, rng.random(len(LAW.edges)) < 0.6))
    assert np.nan_to_num(np.abs(u)).max() < 1e-12


def test_a_follower_without_a_pair_has_no_velocity_and_the_others_have_theirs() -> None:
    lost = LAW.edges[:, 0] == 4
    u = LAW(measured(np.random.default_rng(1).normal(size=(6, 2)), lost))
    assert np.isnan(u).all(axis=-1).tolist() == [False, False, False, False, True, False]


@pytest.mark.parametrize("interval", [0.05, 0.5])
def test_random_switching_converges_to_the_place_of_the_paper_s_law(interval: float) -> None:
    rng, h = np.random.default_rng(2), 0.05
    points = rng.uniform(-1.5, 1.5, (6, 2))
    end = end_configuration(TARGET, *points[:2])
    lost = np.zeros(len(LAW.edges), dtype=bool)
    for step in range(int(300.0 / h)):
        if step % round(interval / h) == 0:
            lost = rng.random(len(LAW.edges)) < 0.4
        points = points + h * np.nan_to_num(LAW(measured(points, lost)))
    assert np.abs(points - end).max() < 1e-6


def test_collinear_pairs_are_never_used() -> None:
    shape = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [2.0, 0.0]])
    law = AnotherPairLaw(TargetFormation(SensingGraph([[0, 1], [0, 2]]), shape))
    lost = (law.edges == [3, 2]).all(axis=1)
    points = np.random.default_rng(3).normal(size=(4, 2))
    relative = points[law.edges[:, 1]] - points[law.edges[:, 0]]
    relative[lost] = np.nan
    assert np.isnan(law(relative)[3]).all()
