"""`formation design`: candidates side by side, what is proved, and a scenario that runs."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenarios.cli import BAD_INPUT, DONE
from scenarios.definition.experiment import open_experiment
from scenarios.measures.predictions.forecast import forecast
from scenarios.studies.design import answer, ask, write_scenario

Cli = Callable[..., tuple[int, str, str]]
SQUARE = "x,y\n0,0\n1,0\n1,1\n0,1\n0.5,2\n"


def test_the_papers_graph_is_proved_best_for_its_leaders_and_others_are_proved_better(cli: Cli) -> None:
    code, out, _ = cli("design", "shape")
    assert code == DONE
    told = " ".join(out.split())
    assert "No graph with the leaders 1 and 2 has a rate above 0.5 1/s; which the given graph has." in told
    assert "No leaders allow more than 0.64 1/s; of those that allow it 1 and 4 have the least depth, 2." in told


def test_a_designed_scenario_is_the_chosen_graph_under_the_same_numbers_and_ends_in_the_same_place(
    tmp_path: Path,
) -> None:
    found = answer(ask("maneuver", leaders="free"), "settling")
    write_scenario(found, tmp_path / "designed.toml")
    designed, given = open_experiment(str(tmp_path / "designed.toml")), open_experiment("maneuver")
    assert designed.numbers[:2] == tuple(found.question.numbers[row] for row in found.chosen.choice.leaders)
    assert (given.first_follower, designed.first_follower) == ("displacement", "spiral")
    assert sorted(designed.numbers) == [1, 2, 3, 4, 5, 6]
    order = np.argsort(designed.numbers)
    np.testing.assert_allclose(designed.initial_points(0)[order], given.initial_points(0))
    ends = [forecast(each, each.initial_points(0))[0].end for each in (designed, given)]
    leader = designed.numbers[0] - 1
    shift = ends[0][order][leader] - ends[1][leader]
    np.testing.assert_allclose(ends[0][order] - shift, ends[1], atol=1e-9)


def test_places_in_a_csv_file_become_a_scenario(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "square.csv").write_text(SQUARE)
    code, out, _ = cli("design", "square.csv", "--leaders", "2,4", "--out", "square.toml")
    assert code == DONE
    assert "scenario: square.toml" in out
    experiment = open_experiment(str(tmp_path / "square.toml"))
    assert experiment.numbers[:2] == (2, 4)
    assert cli("design", "square.csv", "--out", "square.toml")[0] == BAD_INPUT


def test_edges_may_be_bound(tmp_path: Path) -> None:
    bound = answer(ask("shape", leaders="given", edges="given"))
    np.testing.assert_allclose([c.rate for c in bound.candidates], 0.5)
    near = answer(ask("shape", within=1.6))
    for candidate in near.candidates:
        order, graph = candidate.choice.order, candidate.choice.graph()
        observer, observed = order[graph.edges[1:]].T
        assert near.question.field.gaps[observer, observed].max() <= 1.6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("shape", "--leaders", "1,9"), "--leaders: expected given, free, or the numbers of two agents"),
        (("shape", "--leaders", "1,1"), "--leaders: expected two agents"),
        (("law-distance",), "law.name: expected the angle law"),
        (("none.csv",), "none.csv: cannot be read"),
        (("shape", "--within", "0.5"), "no leader-first-follower graph of allowed edges"),
        (("random-50", "--edges", "given"), "lists no neighbours"),
    ],
)
def test_what_cannot_be_used_is_one_line(cli: Cli, arguments: tuple[str, ...], message: str) -> None:
    code, _, err = cli("design", *arguments)
    assert code == BAD_INPUT
    assert message in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("line", ["0,0,0,0\n1,0,0,0\n", "0,0\n1,zero\n", "0,0\n1,nan\n2,2\n", "1,0,0\n1,1,0\n2,2,2\n"])
def test_a_list_of_places_is_checked_line_by_line(cli: Cli, tmp_path: Path, line: str) -> None:
    (tmp_path / "bad.csv").write_text(line)
    code, _, err = cli("design", "bad.csv")
    assert code == BAD_INPUT
    assert err.startswith("formation: bad.csv: ")
