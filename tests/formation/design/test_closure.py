"""The searches find the best graphs: against brute force over all leader-first-follower graphs of few agents."""

from itertools import combinations, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formation import TargetFormation, decay_rates, random_target
from formation.analysis.cascade import Cascade
from formation.analysis.closed_loop import settling_of
from formation.analysis.noise import noise_power, noise_rms
from formation.design.candidates import Task, choose, evaluate, propose, unbeaten
from formation.design.closure import best_leaders, fastest, quietest, shallow
from formation.design.field import Field
from formation.plane import as_complex, as_vectors

SEEDS = st.integers(0, 2**32 - 1)


def brute(field: Field, leaders: tuple[int, int]) -> float:
    """The largest smallest rate over all orders of the followers and all pairs of allowed agents before each."""
    best = 0.0
    for order in permutations(set(range(field.n)) - set(leaders)):
        rate, before = 1.0, list(leaders)
        for k in order:
            pairs = [(i, j) for i, j in combinations(before, 2) if field.allowed[k, i] and field.allowed[k, j]]
            rate = min(rate, max((sine2(field, k, i, j) for i, j in pairs), default=0.0))
            before.append(k)
        best = max(best, rate)
    return best


def sine2(field: Field, k: int, i: int, j: int) -> float:
    a, b = field.positions[i] - field.positions[k], field.positions[j] - field.positions[k]
    return float((a[0] * b[1] - a[1] * b[0]) ** 2 / (a @ a) / (b @ b))


@settings(max_examples=25)
@given(seed=SEEDS, n=st.integers(3, 7), sparse=st.booleans())
def test_the_best_rate_is_that_of_brute_force_over_all_graphs(seed: int, n: int, sparse: bool) -> None:
    rng = np.random.default_rng(seed)
    field = Field.open(rng.normal(size=(n, 2)))
    if sparse:
        field = Field(field.positions, field.allowed & (rng.uniform(size=(n, n)) < 0.7))
    for leaders in list(combinations(range(n), 2))[:4]:
        rate, choice = fastest(field, leaders)
        assert rate == pytest.approx(brute(field, leaders), abs=1e-9)
        if choice.whole:
            assert decay_rates(choice.target(field.positions)).min() == pytest.approx(rate, abs=1e-9)
            observer, observed = choice.order[choice.graph().edges[1:]].T
            assert field.allowed[observer, observed].all()


@settings(max_examples=15)
@given(seed=SEEDS, n=st.integers(3, 6))
def test_the_best_leaders_are_those_of_brute_force_and_no_shallower_ones_have_their_rate(seed: int, n: int) -> None:
    field = Field.open(np.random.default_rng(seed).normal(size=(n, 2)))
    rates = {leaders: brute(field, leaders) for leaders in combinations(range(n), 2)}
    found = best_leaders(field, needs_edge=False)
    assert found is not None
    rate, choice = found
    assert rate == pytest.approx(max(rates.values()), abs=1e-8)
    depths = [
        shallow(field, leaders, rate - 1e-9).depth.max() for leaders, best in rates.items() if best >= rate - 1e-9
    ]
    assert choice.depth.max() == min(depths)


@settings(max_examples=25)
@given(seed=SEEDS, rate=st.floats(0.05, 0.95), quiet=st.booleans())
def test_a_shallow_graph_has_the_least_depth_of_every_agent_at_its_rate(seed: int, rate: float, quiet: bool) -> None:
    field = Field.open(np.random.default_rng(seed).normal(size=(8, 2)))
    choice = shallow(field, (0, 1), rate, quiet)
    inside, depth = {0: 0, 1: 1}, 1
    while True:
        depth += 1
        able = {
            k: depth
            for k in set(range(8)) - set(inside)
            if any(sine2(field, k, i, j) >= rate for i, j in combinations(inside, 2))
        }
        if not able:
            break
        inside |= able
    assert {k: d for k, d in enumerate(choice.depth.tolist()) if d >= 0} == inside


def test_with_leaders_1_and_2_the_papers_graph_has_the_best_rate_and_1_and_4_are_the_best_leaders(
    paper: TargetFormation,
) -> None:
    field = Field.open(paper.positions)
    assert fastest(field, (0, 1))[0] == pytest.approx(decay_rates(paper).min()) == pytest.approx(0.5)
    found = best_leaders(field, needs_edge=False)
    assert found is not None
    rate, choice = found
    assert rate == pytest.approx(0.64)
    assert choice.leaders == (0, 3)
    assert choice.depth.max() == 2
    assert {tuple(pair) for pair in choice.pairs[[1, 2, 4, 5]].tolist()} == {(0, 3)}


@settings(max_examples=10)
@given(seed=SEEDS)
def test_the_quietest_graph_is_no_noisier_than_the_shallow_and_the_fastest_one(seed: int) -> None:
    field = Field.open(np.random.default_rng(seed).normal(size=(20, 2)))

    def noise(choice: object) -> float:
        target = choice.target(field.positions)  # type: ignore[attr-defined]
        loop = Cascade.of(target, 1.0)
        return float(noise_rms(loop, 0.033, noise_power(loop, target.positions, 1.0)).max())

    estimate, quiet = quietest(field, (0, 1), 0.1, 0.033, steered=True)
    assert noise(quiet) <= 1.1 * min(noise(fastest(field, (0, 1))[1]), noise(shallow(field, (0, 1), 0.1)))
    assert noise(quiet) == pytest.approx(estimate, rel=0.35)


def test_edges_may_be_bound_by_range_and_by_who_stands_in_the_way() -> None:
    line = Field.open(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 3.0]]))
    assert line.within(1.5).allowed.sum() == 4
    seen = line.in_sight(0.1).allowed
    assert not seen[0, 2]
    assert not seen[2, 0]
    assert seen.sum() == 10


def test_candidates_have_the_figures_of_their_graphs_and_the_best_of_each_objective_is_unbeaten() -> None:
    rng = np.random.default_rng(4)
    target = random_target(12, rng)
    field = Field.open(target.positions)
    delta = complex(*(target.positions[1] - target.positions[0]))
    task = Task(rng.uniform(-1.0, 1.0, (12, 2)), "displacement")
    found = propose(field, task, (0, 1))
    front = unbeaten(found)
    assert len({c.name for c in found}) > 3
    for objective in ("settling", "noise", "both"):
        assert choose(found, objective) in front
    assert choose(found, "settling").settling == min(c.settling for c in found if c.settling is not None)
    assert choose(found, "noise").noise == min(c.noise for c in found)
    one = found[0]
    again = evaluate("again", field, task, one.choice)
    chosen = one.choice.target(target.positions)
    start = task.start[one.choice.order]
    end = start[0] + chosen.positions - chosen.positions[0]
    assert again.settling == settling_of(Cascade.of(chosen, 1.0), start - end, task.bound)
    assert again.rate == pytest.approx(decay_rates(chosen).min())
    assert abs(delta) > 0.0


def test_a_candidate_settles_where_its_task_sends_it() -> None:
    places, factor = random_target(6, np.random.default_rng(5)).positions, 0.5 + 1.0j
    field, there = Field.open(places), as_vectors(as_complex(places) * factor)
    choice = fastest(field, (0, 1))[1]
    arrived, left = (evaluate("", field, Task(there, "displacement", each), choice).settling for each in (factor, 1.0))
    assert arrived is not None
    assert left is not None
    assert arrived <= 0.05 < 1.0 < left


@pytest.mark.slow
def test_a_chosen_graph_of_fifty_settles_seven_times_sooner_with_a_quarter_of_the_noise() -> None:
    from scenarios.definition.experiment import open_experiment

    experiment = open_experiment("random-50")
    field, places = Field.open(experiment.target.positions), experiment.target.positions
    factor = complex(*experiment.phases[0].delta or ()) / complex(*(places[1] - places[0]))
    best = choose(propose(field, Task(experiment.initial_points(0), "displacement", factor), None), "both")
    assert best.settling is not None
    assert best.settling <= 9.5
    assert best.noise <= 0.25
