"""The league of laws, and the laws on the runner."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from formation import LAWS, Framework, agents
from formation.analysis.flow import Flow
from formation.laws.displacement import drift
from formation.plane import as_complex, as_vectors
from scenarios.cli import BAD_INPUT, DONE
from scenarios.definition.experiment import open_experiment
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate
from scenarios.studies import shares
from scenarios.studies.league.beside import FIRST, beside
from scenarios.studies.league.citations import CITATIONS
from scenarios.studies.league.ends import ENDS, ends
from scenarios.studies.league.entries import Player, chosen, player
from scenarios.studies.league.ideal import random_starts, run
from scenarios.studies.league.picture import overlaid
from scenarios.studies.shares import RANDOM_START, share_reaching

Cli = Callable[..., tuple[int, str, str]]
PAPER = open_experiment("shape").formation


def row(name: str) -> Player:
    return next(player(entry, PAPER) for entry in chosen((name,)) if entry.name == name)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("angle", 1.0, 1.0),
        ("ratio", 1.0, 1.0),
        ("redundant", 1.0, 1.0),
        ("displacement", 1.0, 1.0),
        ("displacement-undirected", 1.0, 1.0),
        ("area", 1.0, 1.0),
        ("triangular", 1.0, 1.0),
        ("distance", 0.0, 0.4),
        ("affine", 0.0, 0.0),
    ],
)
def test_random_starts_end_as_theory_says(name: str, low: float, high: float) -> None:
    one = row(name)
    found = run(one, random_starts(one, 30), one.entry.horizon)
    assert low <= np.isfinite(found.settled).mean() <= high


def test_the_kinds_of_ends_are_told_apart() -> None:
    p = PAPER.positions
    flipped = p.copy()
    k, (i, j) = 5, PAPER.graph.edges[PAPER.graph.edges[:, 0] == 5, 1]
    axis = as_complex(p[j] - p[i])
    flipped[k] = p[i] + as_vectors(np.conj(as_complex(p[k] - p[i]) / axis) * axis)
    points = np.stack(
        [3.0 * p + 1.0, p * [1.0, -1.0], flipped, p + [[0, 0], [0.3, 0]] * 3, p * [1.0, 2.0], np.full_like(p, np.inf)]
    )
    velocity = np.zeros_like(points)
    velocity[4] = 1.0
    found = ends(PAPER, Flow(points, velocity, np.zeros(6), np.zeros(6)))
    assert [ENDS[kind] for kind in found] == ["right", "mirrored", "flipped", "wrong rest", "moving", "diverged"]


@pytest.mark.parametrize("seed", range(3))
def test_with_compass_errors_the_undirected_displacement_law_drifts_as_its_formula_says(seed: int) -> None:
    one = row("displacement-undirected")
    errors = np.random.default_rng(seed).normal(0.0, np.radians(5.0), (4, 6))
    errors[0] = errors[0, 0]  # one common error turns the formation and moves it nowhere
    found = run(one, random_starts(one, 4), 30.0, errors)
    expected = np.linalg.norm(drift(one.formation, errors), axis=-1)
    np.testing.assert_allclose(found.drift, expected, rtol=0.01, atol=1e-4)
    assert expected[0] < 1e-12


@pytest.mark.parametrize("seed", range(2))
def test_the_undirected_bearing_law_drifts_at_the_mean_of_what_its_agents_see_turned(seed: int) -> None:
    """Exactly at the bearings b in the end, mean_k sum_j P(b_kj) R(beta_k) b*_kj; at those of p* to first order."""
    one = row("bearing-undirected")
    errors = np.random.default_rng(seed).normal(0.0, np.radians(2.0), (5, 6))
    found = run(one, random_starts(one, 5), 200.0, errors)
    k, i = one.formation.graph.edges.T

    def mean(points: np.ndarray) -> np.ndarray:
        e, star = (as_complex(p[..., i, :] - p[..., k, :]) for p in (points, one.formation.positions))
        b, wanted = e / np.abs(e), np.exp(1j * errors[:, k]) * star / np.abs(star)
        return np.abs((wanted - b * (np.conj(b) * wanted).real).sum(axis=-1)) / 6.0

    np.testing.assert_allclose(found.drift, mean(found.points), rtol=0.01)
    np.testing.assert_allclose(found.drift, mean(np.broadcast_to(PAPER.positions, found.points.shape)), rtol=0.3)


def test_every_key_of_the_papers_bibliography_names_a_law_that_exists_or_says_why_none() -> None:
    named = [law for cite in CITATIONS for law in cite.law.split(", ") if law]
    assert set(named) <= set(LAWS)
    assert all(cite.law or len(cite.remark) > 20 for cite in CITATIONS)
    declared = {source for law in LAWS.values() for source in law.sources}
    assert declared <= {cite.key for cite in CITATIONS}


def test_the_command_writes_tables_page_and_figure(cli: Cli, tmp_path: Path) -> None:
    code, out, err = cli("laws", "--law", "angle", "--law", "distance", "--starts", "5", "--markdown", "l.md",
                         "--figure", "l.png")  # fmt: skip
    assert (code, err) == (DONE, "")
    assert "Where random starts end" in out
    page = (tmp_path / "l.md").read_text(encoding="utf-8")
    assert "| angle | 100.0% |" in page
    assert "| Jing2020 | - |" in page
    assert (tmp_path / "l.png").read_bytes().startswith(b"\x89PNG")


def test_shares_agree_with_the_first_ones_where_their_difference_may_be_chance() -> None:
    assert set(FIRST) <= {entry.name for entry in chosen()}
    before = FIRST["distance"]
    same, near, far = (next(beside({"distance": (n, 1000)})) for n in (53, 80, 150))
    assert (same.agree, near.agree, far.agree) == (True, True, False)
    assert far.low < far.here - before.right / before.runs < far.high
    assert next(beside({"angle": (1000, 1000)})).agree
    assert not next(beside({"angle": (950, 1000)})).agree


def test_a_law_that_nobody_knows_is_one_line(cli: Cli) -> None:
    code, out, err = cli("laws", "--law", "cosin")
    assert (code, out) == (BAD_INPUT, "")
    assert err == "formation: --law: no such law 'cosin', did you mean 'cosine'?\n"


def test_ends_are_drawn_over_the_target_whatever_their_place_size_and_turn() -> None:
    moved = as_vectors(as_complex(PAPER.positions)[None] * 3.0 * np.exp(0.7j) + 2.0)
    centred = PAPER.positions - PAPER.positions.mean(axis=0)
    np.testing.assert_allclose(overlaid(Framework(PAPER.graph, PAPER.positions), moved)[0], centred, atol=1e-12)


# On the runner


def test_the_mirrored_equilibrium_has_right_distances_and_wrong_angles() -> None:
    experiment = open_experiment("law-distance", ("plant.name=single_integrator",), duration=120.0)
    trajectory = simulate(experiment, 0)
    k, i = experiment.graph.edges.T
    length = lambda p: np.linalg.norm(p[k] - p[i], axis=1)  # noqa: E731
    np.testing.assert_allclose(length(trajectory.points[-1]), length(experiment.target.positions), atol=1e-3)
    assert measure(experiment, trajectory).outcome == "not_converged"


@pytest.mark.parametrize("law", ["displacement", "bearing"])
def test_a_comparison_law_ends_where_its_prediction_says(law: str) -> None:
    experiment = open_experiment(f"law-{law}", ("plant.name=single_integrator",), duration=120.0)
    metrics = measure(experiment, simulate(experiment, 0))
    assert metrics.outcome == "converged"
    np.testing.assert_allclose(metrics.phases[-1].distances, 0.0, atol=1e-5)


@pytest.mark.parametrize("law", [name for name in LAWS if LAWS[name].graph != "triangle"])
def test_any_scenario_runs_any_law_that_builds_its_graph(law: str) -> None:
    changes = (f'law.name="{law}"', 'graph="design"', "plant.name=saturated")
    trajectory = simulate(open_experiment("shape", changes, duration=2.0))
    assert np.isfinite(trajectory.points).all()
    assert np.abs(trajectory.points[-1] - trajectory.points[0]).max() > 1e-3


@pytest.mark.parametrize(
    ("law", "why"), [("cosine", "edge (2, 1) is sensed from one end"), ("bisector", "graph that is signed angles")]
)
def test_a_law_on_a_graph_of_another_kind_is_refused_in_one_line_with_the_way_out(law: str, why: str) -> None:
    with pytest.raises(InputError) as refused:
        open_experiment("shape", (f'law.name="{law}"',))
    assert why in str(refused.value)
    assert 'graph = "design" builds one' in str(refused.value)


@pytest.mark.parametrize(("law", "scale", "turn"), [("displacement", 0.7, -1.0), ("bearing", 1.0, -1.0)])
def test_a_comparison_law_follows_what_it_can_of_a_maneuver(law: str, scale: float, turn: float) -> None:
    """A quarter turn to the right and a smaller formation, of a displacement that the phases command."""
    changes = ("plant.name=single_integrator", f"law.name={law}", "phases.3.duration_s=200")
    trajectory = simulate(open_experiment("maneuver", changes), 0)
    before, after = (trajectory.points[trajectory.phase <= last][-1] for last in (0, 2))
    e_before, e_after = (complex(*(p[1] - p[0])) for p in (before, after))
    assert e_after / e_before == pytest.approx(scale * np.exp(0.5j * np.pi * turn), abs=1e-3)


def test_a_law_that_follows_no_displacement_says_so() -> None:
    with pytest.raises(InputError, match=r"phases\.displacement_m: the triangular law follows none"):
        open_experiment("maneuver", ('law.name="triangular"', 'graph="design"'))


def test_a_share_does_not_depend_on_how_many_runs_advance_together(monkeypatch: pytest.MonkeyPatch) -> None:
    changes = ("law.name=distance", "plant.name=single_integrator", *RANDOM_START, "goal.angle_error_sum_rad=8.0")
    experiment = open_experiment("law-displacement", changes, 6.0)
    found, seen = [], []
    for states in (shares.BATCH_STATES, 6 * 182 * 4):
        monkeypatch.setattr(shares, "BATCH_STATES", states)
        found.append(share_reaching(experiment, 10, lambda *count: seen.append(count)))
    assert found[0] == found[1]
    assert 0.0 < found[0] < 1.0
    parts = [done / total for done, total in seen]
    half = len(parts) // 4
    assert parts[half - 1] == parts[-1] == 1.0  # one batch, then three
    assert parts[half:] == sorted(parts[half:])


def settled_with_loss(loss: float, runs: int, seed: int, period: float = 0.033) -> float:
    """The median time, seconds, to 1 cm of the paper's followers, each of whose edges is lost at random, by hand."""
    rng = np.random.default_rng(seed)
    star = as_complex(PAPER.positions)
    pairs = agents.rows([[1, 2], [2, 3], [1, 4], [1, 4]])
    w = (star[2:] - star[pairs[:, 0]]) / (star[pairs[:, 1]] - star[pairs[:, 0]])
    rate = np.sin(np.angle((star[pairs[:, 1]] - star[2:]) / (star[pairs[:, 0]] - star[2:]))) ** 2
    p = as_complex(rng.uniform(-1.5, 1.5, (runs, 6, 2))).copy()
    end = p[:, :1] + (star - star[0]) * ((p[:, 1] - p[:, 0]) / (star[1] - star[0]))[:, None]
    last, step = np.zeros(runs), 0
    while (away := np.abs(p - end).max(axis=1) > 0.01).any() and step * period < 400.0:
        step += 1
        seen = (rng.random((runs, 4, 2)) >= loss).all(axis=2)
        p[:, 2:] += period * seen * rate * ((1.0 - w) * p[:, pairs[:, 0]] + w * p[:, pairs[:, 1]] - p[:, 2:])
        last = np.where(away, step * period, last)
    return float(np.median(last))


@pytest.mark.slow
@pytest.mark.parametrize(("loss", "duration"), [(0.2, 35.0), (0.5, 80.0)], ids=["a fifth", "half"])
def test_lost_edges_slow_the_angle_law_as_an_independent_computation_says(loss: float, duration: float) -> None:
    """The median of the times to 1 cm; a run that takes longer than the duration counts as one that takes it all."""
    box = ("random_start.x_m=[-1.5, 1.5]", "random_start.y_m=[-1.5, 1.5]", "random_start.min_separation_m=0")
    changes = (f"sensor.edge_loss={loss}", "plant.name=single_integrator", *box)
    experiment = open_experiment("shape", changes, duration=duration)
    points = simulate(experiment, range(100)).points
    star = as_complex(PAPER.positions)
    p = as_complex(points)
    end = p[0, :, :1] + (star - star[0]) * ((p[0, :, 1] - p[0, :, 0]) / (star[1] - star[0]))[:, None]
    away = np.abs(p - end).max(axis=2) > 0.01
    last = np.where(away.any(axis=0), len(p) - 1 - away[::-1].argmax(axis=0), 0) * 0.033
    assert np.median(last) == pytest.approx(settled_with_loss(loss, 1000, 1), rel=0.05)
