"""Sequential activation and the lemma on collision-free motion."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import (
    AngleLaw,
    SensingGraph,
    SequentialActivation,
    TargetFormation,
    collision_margins,
    decay_rates,
    end_configuration,
    random_target,
)


@settings(max_examples=30)  # of thousands of steps each
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(3, 8))
def test_followers_start_in_the_order_of_the_cascade_and_keep_the_lemmas_distance(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    target = random_target(n, rng, min_angle=np.radians(25.0))
    p = rng.uniform(-2.0, 2.0, (n, 2))
    end = end_configuration(target, *p[:2])
    margins = collision_margins(target, p, end)
    law, edges = AngleLaw(target), target.graph.edges
    tolerance, h = 1e-4, 0.05
    activation = SequentialActivation(target, tolerance)
    i, j, k = target.graph.triangles.T
    nearest = np.full(n - 2, np.inf)
    for _ in range(20_000):
        u = law(p[edges[:, 1]] - p[edges[:, 0]])
        activation.update(u)
        assert (activation.active[k] <= (activation.active[i] & activation.active[j])).all()
        p = p + h * u * activation.active[:, None]
        moving = activation.active[k]
        gap = np.minimum(np.linalg.norm(p[k] - p[i], axis=1), np.linalg.norm(p[k] - p[j], axis=1))
        nearest = np.where(moving, np.minimum(nearest, gap), nearest)
        if activation.active.all() and np.abs(u).max() < 1e-7:
            break
    assert activation.active.all()
    reach = 50.0 * tolerance * n  # a neighbour counts as settled while it is still this far from its place
    assert (nearest >= margins - reach).all()


def test_the_leader_and_the_first_follower_are_always_active_and_nobody_stops_again() -> None:
    target = random_target(5, np.random.default_rng(2))
    activation = SequentialActivation(target, 0.01, batch=(3,))
    assert activation.active[..., :2].all()
    activation.update(np.zeros((3, 5, 2)))
    before = activation.active.copy()
    activation.update(np.full((3, 5, 2), 9.0))
    assert (activation.active >= before).all()


def test_the_margin_is_the_condition_of_the_lemma() -> None:
    target = random_target(3, np.random.default_rng(5))
    end = target.positions
    start = end.copy()
    nearest = min(np.linalg.norm(end[2] - end[0]), np.linalg.norm(end[2] - end[1]))
    np.testing.assert_allclose(collision_margins(target, start, end), [nearest])
    start[2] += [3.0 * nearest, 0.0]
    np.testing.assert_allclose(collision_margins(target, start, end), [-2.0 * nearest])


def test_a_follower_has_arrived_by_its_distance_which_is_its_speed_over_its_rate() -> None:
    """Of two velocities of one size that at the slower follower means the greater distance."""
    target = random_target(12, np.random.default_rng(7))
    rates = decay_rates(target)
    tolerance = 0.01
    for follower in range(10):
        if (target.graph.neighbours[follower] >= 2).any():
            continue  # it waits for others
        ready = [k for k, pair in enumerate(target.graph.neighbours) if set(pair) <= {0, 1, follower + 2}]
        for share, arrived in ((0.999, True), (1.001, False)):
            activation = SequentialActivation(target, tolerance)
            velocity = np.full((12, 2), 9.0)
            velocity[follower + 2] = share * tolerance * rates[follower], 0.0
            activation.update(velocity)
            expected = {k + 2 for k in ready if arrived or follower + 2 not in target.graph.neighbours[k]}
            assert set(np.flatnonzero(activation.active)) == expected | {0, 1}


def test_who_has_arrived_stays_so_while_others_come() -> None:
    """Agent 5 waits for 3 and 4, which arrive one after the other, each only for an instant."""
    graph = SensingGraph(np.array([[0, 1], [0, 1], [2, 3]]))
    target = TargetFormation(graph, np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8], [0.6, -0.7], [1.5, 0.4]]))
    activation = SequentialActivation(target, 0.01)
    for arrived in (2, 3):
        assert not activation.active[4]
        velocity = np.full((5, 2), 9.0)
        velocity[arrived] = 0.0
        activation.update(velocity)
    assert activation.active.all()
