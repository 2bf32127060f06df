"""One step of the safety filters in a crowd of constant density, beside the public simulator's own certificate.

That one is measured where the simulator can be imported:

    pip install git+https://github.com/robotarium/robotarium_python_simulator
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle
from time import perf_counter

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from robots import GTERNAL, Arena, NearIdentityDiffeomorphism
from robots.safety import FilterSettings, SafetyFilter, make_filter
from robots.safety.certificate import BARRIER_GAIN, MAGNITUDE_LIMIT, SAFETY_RADIUS

NID = NearIdentityDiffeomorphism(0.025)
PERIOD = 0.033
SPACING = 0.2
TARGETS = {6: 60.0, 20: 400.0, 50: 400.0, 100: 1000.0, 1000: 10000.0}
"""Microseconds; those for 6 and 50 are the project's, the others keep them honest."""

PEERS = (
    "create_si_barrier_certificate_with_boundary",
    "create_single_integrator_barrier_certificate_with_boundary",
)
"""The certificate's name since ``rps`` 2.1, and before."""

Crowd = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def crowds(n: int) -> list[Crowd]:
    """Robots on shaken grids, each with about ten others within its sensing range, all of whom want to move.

    Many of them: a processor that meets one scene again and again learns its branches by heart, small ones best.
    """
    rng = np.random.default_rng(n)
    side = int(np.ceil(np.sqrt(n)))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)[:n] - (side - 1) / 2.0
    scenes = []
    for _ in range(max(3, 20_000 // n)):
        theta = rng.uniform(-np.pi, np.pi, n)
        headings = np.stack([np.cos(theta), np.sin(theta)], axis=1)
        points = SPACING * grid + rng.uniform(-0.02, 0.02, (n, 2))
        scenes.append((points, headings, rng.normal(0.0, 0.1, (n, 2)), np.zeros((n, 2))))
    return scenes


def per_step(safety: SafetyFilter, scenes: list[Crowd]) -> float:
    """Mean microseconds of a step, in the best of five passes through the scenes."""
    best = np.inf
    for _ in range(5):
        start = perf_counter()
        for scene in scenes:
            safety.filter(*scene, PERIOD)
        best = min(best, perf_counter() - start)
    return 1e6 * best / len(scenes)


def build(name: str, n: int) -> SafetyFilter:
    half = SPACING * np.sqrt(n) + 1.0
    arena = Arena((-half, half), (-half, half))
    safety = make_filter(name, (n,), GTERNAL.drive, NID, FilterSettings(), arena)
    assert safety is not None
    return safety


@pytest.mark.parametrize("n", TARGETS)
def test_decentralised(benchmark: BenchmarkFixture, target: Callable[..., None], n: int) -> None:
    safety, scenes = build("decentralised", n), crowds(n)
    ahead = cycle(scenes)
    benchmark(lambda: safety.filter(*next(ahead), PERIOD))
    target(f"decentralised filter, {n} robots", per_step(safety, scenes), TARGETS[n], "us")


@pytest.mark.parametrize("n", [6, 20, 50, 100, 1000])
@pytest.mark.parametrize("name", ["centralised", "robotarium"])
def test_joint_filters(benchmark: BenchmarkFixture, name: str, n: int) -> None:
    safety, ahead = build(name, n), cycle(crowds(n))
    measured(benchmark, lambda: safety.filter(*next(ahead), PERIOD), once=n > 100)


@pytest.mark.parametrize("n", [6, 20, 50, 100, 200, 500])
def test_the_public_simulators_certificate(benchmark: BenchmarkFixture, n: int) -> None:
    """With the figures of our own, so that both solve one problem; its velocities are of the world frame."""
    module = pytest.importorskip("rps.utilities.barrier_certificates", reason="rps is not installed")
    make = next(getattr(module, name) for name in PEERS if hasattr(module, name))
    half = SPACING * np.sqrt(n) + 1.0
    certificate = make(
        barrier_gain=BARRIER_GAIN,
        safety_radius=SAFETY_RADIUS,
        magnitude_limit=MAGNITUDE_LIMIT,
        boundary_points=np.array([-half, half, -half, half]),
    )
    ahead = cycle([(velocities.T.copy(), points.T.copy()) for points, _, velocities, _ in crowds(n)])
    measured(benchmark, lambda: certificate(*next(ahead)), once=n > 100)


def measured(benchmark: BenchmarkFixture, step: Callable[[], object], once: bool) -> None:
    """Time many steps, or a single one where a step takes seconds."""
    if once:
        benchmark.pedantic(step, rounds=1)
    else:
        benchmark(step)


def test_growth_is_linear(benchmark: BenchmarkFixture, target: Callable[..., None]) -> None:
    small, large = (per_step(build("decentralised", n), crowds(n)) for n in (100, 1000))
    benchmark(lambda: None)
    target("decentralised filter, 1000 robots over 100", large / small, 12.0, "times")
