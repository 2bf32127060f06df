"""Candidates of every kind are proposed, with the figures of their loops, and compared fairly."""

from itertools import pairwise

import numpy as np
import pytest

from formation import TargetFormation, random_target
from formation.analysis.cascade import Cascade
from formation.analysis.closed_loop import settling_of
from formation.analysis.margins import delay_margin
from formation.analysis.noise import bias_gains, noise_power, noise_rms
from formation.design import candidates
from formation.design.candidates import (
    FEW_RATES,
    FINALISTS,
    QUIET_RATES,
    SHALLOW_RATES,
    Candidate,
    Task,
    choose,
    evaluate,
    propose,
    unbeaten,
)
from formation.design.closure import TIE, best_leaders, fastest, leader_pairs, quietest, shallow
from formation.design.field import Choice, Field
from formation.plane import as_complex, as_vectors

HEXAGON = as_vectors(np.exp(2j * np.pi * np.arange(6) / 6.0))
"""From opposite agents all others are at a right angle: every rate up to 1 can be had."""


def names(field: Field, task: Task, leaders: tuple[int, int] | None) -> list[str]:
    return [name for name, choice in candidates._kinds(field, task, leaders) if choice.whole]


def test_rates_are_rates_that_exist_and_grow() -> None:
    for rates in (SHALLOW_RATES, QUIET_RATES, FEW_RATES["shallow"], FEW_RATES["quiet"]):
        assert all(0.0 < slow < fast for slow, fast in pairwise([*rates, 1.0]))
    assert set(FEW_RATES["shallow"]) <= set(SHALLOW_RATES)
    assert set(FEW_RATES["quiet"]) <= set(QUIET_RATES)


def test_with_given_leaders_there_is_one_graph_of_each_kind_at_each_rate() -> None:
    found = names(Field.open(HEXAGON), Task(HEXAGON), (0, 3))
    expected = ["best rate, shallow", "best rate"]
    for rate in SHALLOW_RATES:
        expected += [f"shallow {rate:g}", f"shallow, quiet {rate:g}"]
    assert found == expected + [f"quiet {rate:g}" for rate in QUIET_RATES]


def test_with_free_leaders_the_best_six_of_each_kind_are_computed_through_and_of_many_agents_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    field, task = Field.open(HEXAGON), Task(HEXAGON, "displacement")
    found = list(candidates._kinds(field, task, None))
    best = best_leaders(field, needs_edge=True)
    assert best is not None
    assert [name for name, _ in found[:2]] == ["best rate, shallow", "best rate"]
    assert found[0][1].leaders == found[1][1].leaders == best[1].leaders
    pairs = list(leader_pairs(field, needs_edge=True))
    for rate in SHALLOW_RATES:
        ours = [choice for name, choice in found if name == f"shallow {rate:g}"]
        every = [choice for pair in pairs if (choice := shallow(field, pair, rate)).whole]
        depths = sorted((max(each.depth), float(np.mean(each.depth))) for each in every)
        assert [(max(each.depth), float(np.mean(each.depth))) for each in ours] == depths[:FINALISTS]
        for choice, (_, quiet) in zip(ours, [f for f in found if f[0] == f"shallow, quiet {rate:g}"], strict=True):
            expected = shallow(field, choice.leaders, rate, quiet=True)
            assert quiet.leaders == choice.leaders
            assert quiet.pairs.tolist() == expected.pairs.tolist()
    for rate in QUIET_RATES:
        noises = sorted(quietest(field, pair, rate, task.period, True)[0] for pair in pairs)
        noises = [noise for noise in noises if noise < np.inf]
        ours = [choice for name, choice in found if name == f"quiet {rate:g}"]
        assert [quietest(field, each.leaders, rate, task.period, True)[0] for each in ours] == noises[:FINALISTS]
    monkeypatch.setattr(candidates, "MANY", 5)
    few = [name for rate in FEW_RATES["shallow"] for name in (f"shallow {rate:g}", f"shallow, quiet {rate:g}")]
    quiet = [f"quiet {rate:g}" for rate in FEW_RATES["quiet"]]
    assert [name for name, _ in candidates._kinds(field, task, None)] == few  # the first pair has no quiet graph
    assert names(field, task, (0, 3)) == ["best rate, shallow", "best rate", *few, *quiet]


def test_with_given_leaders_the_shallow_graph_has_the_best_rate_to_within_a_tie() -> None:
    field = Field.open(random_target(8, np.random.default_rng(2)).positions)
    found = dict(candidates._kinds(field, Task(field.positions), (0, 1)))
    rate, choice = fastest(field, (0, 1))
    assert found["best rate"].pairs.tolist() == choice.pairs.tolist()
    assert found["best rate, shallow"].depth.tolist() == shallow(field, (0, 1), rate - TIE).depth.tolist()


@pytest.mark.parametrize("law", ["stationary", "displacement"])
def test_the_figures_of_a_candidate_are_those_of_its_loop(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(4)
    places, factor = random_target(7, rng).positions, 0.8 - 0.4j
    field, task = Field.open(places), Task(rng.normal(size=(7, 2)), law, factor, 0.05, 0.02)
    choice = fastest(field, (3, 1))[1]
    found, target = evaluate("name", field, task, choice), choice.target(places)
    start, steered = as_complex(task.start[choice.order]), law == "displacement"
    loop = Cascade.of(target, float(steered))
    z = as_complex(target.positions)
    e = factor * (z[1] - z[0]) if steered else start[1] - start[0]
    end = start[0] + (z - z[0]) / (z[1] - z[0]) * e
    assert found.name == "name"
    assert found.settling == settling_of(loop, as_vectors(start - end), 0.02, 0.05)
    assert found.rate == pytest.approx(loop.rates[1:].min())
    assert found.noise == pytest.approx(noise_rms(loop, 0.05, noise_power(loop, target.positions, 1.0)).max())
    assert found.bias == pytest.approx(bias_gains(loop).max())
    assert found.delay_margin == pytest.approx(delay_margin(-loop.rates[loop.rates > 0.0]))
    observed = target.graph.edges[0 if steered else 1 :, 1].tolist()
    assert found.sensed_by == max(observed.count(agent) for agent in range(7))
    assert found.depth == choice.depth.max()
    monkeypatch.setattr(candidates, "MANY", 6)
    coarse = evaluate("", field, task, choice).settling
    assert coarse == settling_of(loop, as_vectors(start - end), 0.02, 0.5)


def test_a_leader_whom_all_sense_counts_the_first_follower_only_where_it_is_steered() -> None:
    field = Field.open(np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 1.0]]))
    choice = shallow(field, (0, 1))
    sensed = [
        evaluate("", field, Task(field.positions, law), choice).sensed_by for law in ("stationary", "displacement")
    ]
    assert sensed == [1, 2]


def made(name: str, settling: float | None, noise: float) -> Candidate:
    choice = Choice((0, 1), np.full((2, 2), -1), np.array([0, 1]))
    return Candidate(name, choice, 0.5, settling, noise, 1.0, 1.0, 1)


def test_what_another_beats_in_one_figure_and_not_in_the_other_is_left_out() -> None:
    given = [
        made("fast", 5.0, 4.0), made("as fast, louder", 5.0, 4.5), made("between", 6.0, 2.0), made("same", 6.0, 2.0),
        made("slower", 7.0, 2.0), made("quiet", 30.0, 1.0), made("never", None, 1.0), made("never, 0.5", None, 0.5),
    ]  # fmt: skip
    assert [each.name for each in unbeaten(given)] == ["fast", "between", "same", "quiet", "never, 0.5"]
    assert [choose(given, each).name for each in ("settling", "noise", "both")] == [
        "fast",
        "never, 0.5",
        "between",
    ]
    assert choose(given[5:], "settling").name == "quiet"


def test_proposals_are_sorted_by_settling_then_noise_and_none_is_given_twice(paper: TargetFormation) -> None:
    field = Field.open(paper.positions)
    found = propose(field, Task(np.random.default_rng(1).normal(size=(6, 2)), "displacement"), None)
    keys = [(np.inf if each.settling is None else each.settling, each.noise) for each in found]
    assert keys == sorted(keys)
    graphs = {(each.choice.order.tobytes(), each.choice.pairs.tobytes()) for each in found}
    assert len(graphs) == len(found) > 3
    assert propose(Field(field.positions, np.zeros((6, 6), dtype=bool)), Task(field.positions), (0, 1)) == []


def test_a_graph_with_a_triangle_flatter_than_assumption_2_allows_is_no_candidate() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [1e6, 1.0], [1.0, 1.0], [1.5, -0.5], [-0.5, 1.5]])
    field, task = Field.open(places), Task(places + 0.1, "stationary", period=0.033)
    for found in propose(field, task, (0, 1)):
        found.choice.target(places)  # is one
    assert len(propose(field, task, (0, 1))) < len(names(field, task, (0, 1)))
