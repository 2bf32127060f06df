"""Agents that each take another velocity for v_r, held or continuous, and first followers that are told nothing."""

from itertools import islice

import numpy as np
import pytest

from formation import Phase, TargetFormation, random_target
from formation.analysis.cascade import Cascade
from formation.analysis.exact import held, ideal, informed, points
from formation.plane import as_complex, as_vectors
from formation.references.curves import ClosedCurve

PERIOD, STEPS = 0.2, 6
CURVE = ClosedCurve("circle", (1.0, 1.0), 9.0)


def drawn(n: int = 6) -> tuple[TargetFormation, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    target = random_target(n, rng)
    return target, as_complex(rng.normal(size=(n, 2))), as_complex(rng.normal(0.0, 0.1, (STEPS, n, 2)))


def euler(
    target: TargetFormation, start: np.ndarray, phase: Phase, told: np.ndarray, parts: int, steered: bool, begin: float
) -> np.ndarray:
    """The loop in ``parts`` steps of the midpoint rule in each period (one plain step of 1), states at the periods."""
    loop, states, h = Cascade.of(target), [start], PERIOD / parts
    delta = phase.displacement

    def velocity(p: np.ndarray, t: float, own: np.ndarray) -> np.ndarray:
        u = loop.apply(p) + own
        if steered and delta is not None:
            u[1] += delta * (1.0 if phase.reference is None else phase.reference.factor(t)) - (p[1] - p[0])
        return u

    for index in range(STEPS):
        p = states[-1]
        for part in range(parts):
            t = begin + index * PERIOD + part * h
            if parts == 1:
                p = p + h * velocity(p, t, told[index])
            else:
                p = p + h * velocity(p + h / 2.0 * velocity(p, t, told[index]), t + h / 2.0, told[index])
        states.append(p)
    return np.array(states)


@pytest.mark.parametrize("reference", [None, CURVE])
@pytest.mark.parametrize(
    ("delta", "law"), [(None, "displacement"), ((0.3, 0.4), "displacement"), ((0.3, 0.4), "stationary")]
)
def test_agents_move_with_what_each_takes_for_the_common_velocity(
    reference: ClosedCurve | None, delta: tuple[float, float] | None, law: str
) -> None:
    target, start, told = drawn()
    phase = Phase("p", 2.0, (0.05, -0.02), delta, reference)
    steered = law == "displacement" and delta is not None
    loop = Cascade.of(target, 0.5 if steered else 0.0)  # a steered one has its own rate
    found = list(informed(loop, start, phase, law, PERIOD, list(told), 0.7))
    expected = euler(target, start, phase, told, 400, steered, 0.7)
    assert len(found) >= STEPS
    np.testing.assert_allclose(np.array(found)[: STEPS + 1], expected[: len(found)], atol=2e-5)
    commanded = list(held(loop, start, phase, law, PERIOD, 0.7, list(told)))
    np.testing.assert_allclose(commanded, euler(target, start, phase, told, 1, steered, 0.7), atol=1e-12)


@pytest.mark.parametrize("law", ["displacement", "distance", "bearing", "spiral"])
def test_a_first_follower_that_is_told_nothing_keeps_its_place_beside_the_leader(law: str) -> None:
    target, start, _ = drawn()
    phase = Phase("p", 2.0, (0.05, -0.02))
    for move in (ideal, held):
        states = points(move(Cascade.of(target), start, phase, law, PERIOD), STEPS)  # type: ignore[operator]
        away = PERIOD * np.arange(STEPS + 1)[:, None] * np.array(phase.velocity)
        for agent in (0, 1):
            np.testing.assert_allclose(states[:, agent], as_vectors(start[agent]) + away, atol=1e-12)


def test_on_a_reference_held_commands_are_those_of_the_instant_at_which_they_begin() -> None:
    target, start, _ = drawn()
    phase = Phase("p", 2.0, (9.0, 9.0), (0.3, 0.4), CURVE)
    told = np.array([[CURVE.velocity(0.7 + k * PERIOD)] * 6 for k in range(STEPS)])
    found = list(islice(held(Cascade.of(target), start, phase, "displacement", PERIOD, 0.7), STEPS + 1))
    np.testing.assert_allclose(found, euler(target, start, phase, told, 1, True, 0.7), atol=1e-12)
