"""The compiled searches over pairs beside the same searches written down plainly, pair by pair."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation.design import closure, kernel
from formation.design.closure import best_leaders, fastest, leader_pairs, quietest, shallow
from formation.design.field import NONDEGENERATE, Choice, Field
from formation.plane import as_complex

SEEDS = st.integers(0, 2**32 - 1)
EXAMPLES = settings(max_examples=25)
PERIOD = 0.05

Pair = tuple[int, int]


def drawn(seed: int, n: int = 9) -> tuple[Field, Pair]:
    """Places, who may sense whom, and two leaders, neither of them in the first row."""
    rng = np.random.default_rng(seed)
    allowed = (rng.uniform(size=(n, n)) < 0.8) & ~np.eye(n, dtype=bool)
    a, b = (rng.choice(n - 1, 2, replace=False) + 1).tolist()
    return Field(rng.normal(size=(n, 2)), allowed), (a, b)


def sine2(field: Field, k: int, i: int, j: int) -> float:
    p = as_complex(field.positions)
    return float(np.sin(np.angle((p[j] - p[k]) / (p[i] - p[k]))) ** 2)


def pairs_of(field: Field, inside: list[int], k: int) -> list[Pair]:
    return [(i, j) for i, j in combinations(sorted(inside), 2) if field.allowed[k, i] and field.allowed[k, j]]


def spread(field: Field, k: int, pair: Pair) -> tuple[float, float]:
    """|1 - w|^2 and |w|^2."""
    p = as_complex(field.positions)
    w = (p[k] - p[pair[0]]) / (p[pair[1]] - p[pair[0]])
    return abs(1.0 - w) ** 2, abs(w) ** 2


def depth_of(depth: dict[int, int], pair: Pair) -> int:
    return 1 + max(depth[pair[0]], depth[pair[1]])


def check(field: Field, leaders: Pair, choice: Choice, depth: dict[int, int], pairs: dict[int, Pair]) -> None:
    """Whether a choice is the one written down."""
    assert choice.leaders == leaders
    assert choice.depth.tolist() == [depth.get(k, -1) for k in range(field.n)]
    assert [tuple(pair) for pair in choice.pairs.tolist()] == [pairs.get(k, (-1, -1)) for k in range(field.n)]


@EXAMPLES
@given(seed=SEEDS, floor=st.sampled_from([NONDEGENERATE, 0.8]))
def test_the_fastest_graph_takes_in_the_agent_with_the_best_pair_until_none_is_above_the_floor(
    seed: int, floor: float
) -> None:
    field, leaders = drawn(seed)
    depth, pairs, rate = {leaders[0]: 0, leaders[1]: 1}, {}, 1.0
    while True:
        options = [
            (sine2(field, k, *pair), k, pair)
            for k in set(range(field.n)) - set(depth)
            for pair in pairs_of(field, list(depth), k)
        ]
        s, k, pair = max(options, default=(0.0, 0, (0, 0)))
        if s <= floor:
            break
        rate, pairs[k], depth[k] = min(rate, s), pair, depth_of(depth, pair)
    found, choice = fastest(field, leaders, floor)
    check(field, leaders, choice, depth, pairs)
    assert found == pytest.approx(rate if len(depth) == field.n else 0.0)
    assert choice.whole == (len(depth) == field.n)


@EXAMPLES
@given(seed=SEEDS, rate=st.floats(0.1, 0.9), quiet=st.booleans())
def test_a_shallow_graph_takes_of_the_pairs_of_least_depth_the_fastest_or_the_quietest(
    seed: int, rate: float, quiet: bool
) -> None:
    field, leaders = drawn(seed)
    depth, pairs = {leaders[0]: 0, leaders[1]: 1}, {}

    def merit(k: int, pair: Pair) -> tuple[float, float]:
        return -depth_of(depth, pair), -sum(spread(field, k, pair)) if quiet else sine2(field, k, *pair)

    while True:
        joined = {}
        for k in set(range(field.n)) - set(depth):
            options = [pair for pair in pairs_of(field, list(depth), k) if sine2(field, k, *pair) >= rate]
            if options:
                joined[k] = max(options, key=lambda pair, k=k: merit(k, pair))  # type: ignore[misc]
        if not joined:
            break
        pairs |= joined
        depth |= {k: depth_of(depth, pair) for k, pair in joined.items()}
    choice = shallow(field, leaders, rate, quiet)
    close = any(sine2(field, k, *pair) > kernel.GOOD_ENOUGH for k, pair in pairs.items())
    if close and not quiet:  # of pairs so good the search takes any
        pairs = {k: tuple(choice.pairs[k].tolist()) for k in pairs}
        assert all(sine2(field, k, *pair) >= rate for k, pair in pairs.items())
    check(field, leaders, choice, depth, pairs)


@EXAMPLES
@given(seed=SEEDS, rate=st.floats(0.05, 0.6), steered=st.booleans())
def test_the_quietest_graph_takes_in_the_agent_with_the_least_noise_first(
    seed: int, rate: float, steered: bool
) -> None:
    field, leaders = drawn(seed)
    own = PERIOD**2 * 2.0 / (1.0 - (1.0 - PERIOD) ** 2)  # steady: c = (1 - T)^2 c + 2 T^2
    cost, depth, pairs = {leaders[0]: 0.0, leaders[1]: own if steered else 0.0}, {leaders[0]: 0, leaders[1]: 1}, {}
    worst = 0.0
    while True:
        options = []
        for k in set(range(field.n)) - set(depth):
            for pair in pairs_of(field, list(depth), k):
                s = sine2(field, k, *pair)
                towards_i, towards_j = spread(field, k, pair)
                c = towards_i * cost[pair[0]] + towards_j * cost[pair[1]] + PERIOD * s * (towards_i + towards_j)
                options += [(c, k, pair)] if s >= rate else []
        if not options:
            break
        c, k, pair = min(options)
        cost[k], pairs[k], depth[k] = c, pair, depth_of(depth, pair)
        worst = max(worst, c)
    noise, choice = quietest(field, leaders, rate, PERIOD, steered)
    check(field, leaders, choice, depth, pairs)
    assert noise == pytest.approx(np.sqrt(worst) if len(depth) == field.n else np.inf)


@EXAMPLES
@given(seed=SEEDS, rate=st.floats(0.1, 0.9))
def test_two_agents_lead_at_once_all_whom_they_are_a_pair_for(seed: int, rate: float) -> None:
    field, _ = drawn(seed)
    found = kernel.direct(field.directions, field.allowed, rate)
    for i, j in combinations(range(field.n), 2):
        able = [k for k in range(field.n) if (i, j) in pairs_of(field, [i, j], k) and sine2(field, k, i, j) >= rate]
        assert found[i, j] == found[j, i] == len(able)
    assert not np.diagonal(found).any()


def test_of_many_agents_only_the_six_pairs_that_lead_most_at_once_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    field, _ = drawn(3, 12)
    count = kernel.direct(field.directions, field.allowed, 0.8)
    few = sorted((count[i, j] for i, j in combinations(range(12), 2)), reverse=True)
    monkeypatch.setattr(closure, "EXHAUSTIVE", 11)
    tried = list(leader_pairs(field, needs_edge=False))
    assert len(set(tried)) == 6
    assert all(a < b for a, b in tried)
    assert sorted((count[pair] for pair in tried), reverse=True) == few[:6]


@given(seed=SEEDS)
def test_leaders_are_tried_once_and_the_way_round_in_which_the_first_follower_may_sense_the_leader(seed: int) -> None:
    field, _ = drawn(seed, 5)
    assert list(leader_pairs(field, needs_edge=False)) == list(combinations(range(5), 2))
    tried = list(leader_pairs(field, needs_edge=True))
    for a, b in combinations(range(5), 2):
        wanted = [(a, b)] if field.allowed[b, a] else [(b, a)] if field.allowed[a, b] else []
        assert [pair for pair in tried if set(pair) == {a, b}] == wanted


def test_agents_in_one_place_do_not_lead_together() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.3, 1.0]])
    assert (0, 2) not in list(leader_pairs(Field.open(places), needs_edge=False))
    assert not Field.open(places).directions[0, 2].any()
    np.testing.assert_allclose(Field.open(places).directions[0, 1], [1.0, 0.0])


@settings(max_examples=10)
@given(seed=SEEDS, needs_edge=st.booleans())
def test_of_the_leaders_with_the_best_rate_those_of_the_least_depth_are_best(seed: int, needs_edge: bool) -> None:
    """Depth is the largest over the agents, then the mean, then the smallest rows: on a grid many rates are equal."""
    rng = np.random.default_rng(seed)
    places = np.array([[x, y] for x in range(3) for y in range(3)], dtype=float)[rng.permutation(9)[:7]]
    field = Field(places, (rng.uniform(size=(7, 7)) < 0.85) & ~np.eye(7, dtype=bool))
    found = best_leaders(field, needs_edge)
    rated = {pair: fastest(field, pair)[0] for pair in leader_pairs(field, needs_edge)}
    best = max(rated.values())
    if best == 0.0:
        assert found is None
        return
    choices = [shallow(field, pair, best - 1e-9) for pair, rate in rated.items() if rate > best - 1e-9]
    expected = min(choices, key=lambda each: (max(each.depth), sum(each.depth), each.leaders))
    assert found is not None
    assert found[0] == pytest.approx(best)
    assert found[1].leaders == expected.leaders
    assert found[1].depth.tolist() == expected.depth.tolist()


def test_the_deepest_agent_counts_before_the_mean_depth() -> None:
    """Of two pairs of leaders with the same rate and mean the one with the smaller rows is deeper here."""
    rng = np.random.default_rng(272)
    places = np.array([[x, y] for x in range(4) for y in range(3)], dtype=float)[rng.permutation(12)[:8]]
    field = Field(places, (rng.uniform(size=(8, 8)) < 0.75) & ~np.eye(8, dtype=bool))
    found = best_leaders(field, needs_edge=False)
    assert found is not None
    other = shallow(field, (0, 4), found[0] - 1e-9)
    assert other.whole
    assert other.depth.sum() == found[1].depth.sum()
    assert other.depth.max() > found[1].depth.max()
    assert found[1].leaders > other.leaders


@given(seed=SEEDS, radius=st.floats(0.05, 0.5), reach=st.floats(0.3, 3.0))
def test_an_edge_is_in_sight_where_no_disc_is_on_its_line_and_within_reach_where_it_is_short(
    seed: int, radius: float, reach: float
) -> None:
    field, _ = drawn(seed, 6)
    p = as_complex(field.positions)
    seen, near = field.in_sight(radius).allowed, field.within(reach).allowed
    for k in range(6):
        for i in range(6):
            hidden = False
            for m in set(range(6)) - {k, i}:
                along = ((p[m] - p[k]) * np.conj(p[i] - p[k]) / abs(p[i] - p[k])) if i != k else 0j
                hidden |= 0.0 < along.real < abs(p[i] - p[k]) and abs(along.imag) < radius
            assert seen[k, i] == (field.allowed[k, i] and not hidden)
            assert near[k, i] == (field.allowed[k, i] and abs(p[i] - p[k]) <= reach)


def test_the_field_of_a_graph_allows_its_edges_and_an_open_one_all() -> None:
    field = Field.of_edges(np.eye(4, 2), np.array([[2, 0], [2, 1], [3, 3], [3, 2]]))
    assert np.argwhere(field.allowed).tolist() == [[2, 0], [2, 1], [3, 2]]
    assert Field.open(np.eye(4, 2)).allowed.sum() == 12
    assert not np.diagonal(Field.open(np.eye(4, 2)).allowed).any()
