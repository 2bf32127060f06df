"""Any numbering, any superset: the graph inside what a scenario lists is found, or its absence explained."""

from typing import Any

import numpy as np
import pytest

from scenarios.definition.experiment import Experiment, build, open_experiment
from scenarios.definition.load import ScenarioFile, validate
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.simulation.loop import simulate

ZHAO = [(2.0, 0.0), (1.0, 1.0), (1.0, -1.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
"""Seven agents of Zhao 2018, and their neighbours as a paper numbers them."""

UNDIRECTED = [(2, 3, 4, 5), (1, 4, 7), (1, 5, 6), (1, 2, 5, 6), (1, 3, 4, 7), (3, 4, 7), (2, 5, 6)]
CASCADE = [(), (1,), (1, 5), (1, 2), (1, 4), (3, 4), (2, 5)]
CYCLE = [(), (1,), (2, 4), (3, 5), (1, 4)]
PENTAGON = [(0.0, 0.0), (-1.9021, -1.3820), (-1.1756, -3.6180), (1.1756, -3.6180), (1.9021, -1.3820)]


def scenario(neighbours: list[tuple[int, ...]], places: list[tuple[float, float]], **keys: Any) -> Experiment:
    agents = [
        {"id": number, "neighbours": list(senses), "target": list(place)}
        for number, (senses, place) in enumerate(zip(neighbours, places, strict=True), start=1)
    ]
    content = {"title": "t", "duration_s": 60.0, "agents": agents, "random_start": {}, "graph": "subgraph"} | keys
    return build(ScenarioFile("made", "made", "", validate(content, "made")))


@pytest.mark.parametrize("neighbours", [UNDIRECTED, CASCADE])
def test_a_papers_own_numbers_and_edges_to_spare_run_and_converge(neighbours: list[tuple[int, ...]]) -> None:
    experiment = scenario(neighbours, ZHAO, plant={"name": "saturated"}, goal={"angle_error_sum_rad": 0.05})
    assert sorted(experiment.numbers) == list(range(1, 8))
    for k, i in experiment.numbered(experiment.graph.edges[1:]).tolist():
        assert i in neighbours[k - 1]
    order = np.argsort(experiment.numbers)
    np.testing.assert_array_equal(experiment.target.positions[order], ZHAO)
    run = simulate(experiment, 0)
    metrics = measure(experiment, run)
    assert metrics.outcome == "converged"
    content = result(experiment, 0, run, metrics)
    assert content["agents"] == list(experiment.numbers)
    named = {angle["name"] for angle in content["angles"]}
    assert f"alpha(3;{experiment.angle_names[0].split(';')[1]}" in named or len(named) == 10


def test_what_a_person_writes_and_reads_is_in_the_files_numbers() -> None:
    angles = {"3;1,5": 45.0}
    with pytest.raises(InputError, match=r"target.angles_deg.*degrees, got 45"):
        scenario(CASCADE, ZHAO, target={"angles_deg": angles})
    exact = {"5;1,4": 63.43}
    with pytest.raises(InputError, match=r"the target positions have"):
        scenario(CASCADE, ZHAO, target={"angles_deg": exact | {"6;3,4": 1.0}})


def test_a_graph_without_one_inside_is_explained_and_mended_by_what_is_proposed() -> None:
    with pytest.raises(InputError) as raised:
        scenario(CYCLE, PENTAGON)
    message = str(raised.value)
    assert "agents 3, 4, 5 cannot be reached; the edges (4, 1), (4, 2) would do, and no fewer" in message
    assert "with leaders = [1, 4] the edge (2, 4)" in message
    mended = list(CYCLE)
    mended[3] = (3, 5, 1, 2)
    assert scenario(mended, PENTAGON).n == 5
    one = list(CYCLE)
    one[1] = (1, 4)
    assert scenario(one, PENTAGON, leaders=[1, 4]).numbers[:2] == (1, 4)


def test_the_first_followers_edge_is_demanded_only_where_its_law_uses_it() -> None:
    blind = [(), (), (1, 2), (1, 3), (1, 4)]
    assert scenario(blind, PENTAGON).n == 5
    steered = {"law": {"first_follower": "displacement"}, "duration_s": None}
    phases = [{"name": "p", "duration_s": 5.0, "displacement_m": [1.0, 0.0]}]
    with pytest.raises(InputError, match=r"agent 2 must sense 1; the edge \(2, 1\) would do"):
        scenario(blind, PENTAGON, phases=phases, **steered)


def test_the_product_chooses_from_the_target_where_it_is_asked_to() -> None:
    designed = open_experiment("random-50", ('graph="design"',))
    assert designed.numbers[:2] == (1, 2)
    assert designed.target.graph.depth.max() == 3
    given = open_experiment("random-50")
    np.testing.assert_array_equal(designed.target.positions[np.argsort(designed.numbers)], given.target.positions)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"leaders": [1, 9]}, "leaders: no agent 9"),
        ({"leaders": [3, 3]}, "leaders: expected two agents, got 3 twice"),
        ({"graph": "given", "leaders": [1, 2]}, 'leaders: only for graph = "subgraph" or "design"'),
    ],
)
def test_leaders_that_cannot_be_are_refused(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        scenario(CASCADE, ZHAO, **keys)


def test_neighbours_that_are_no_agents_are_refused() -> None:
    wrong = list(CASCADE)
    wrong[3] = (1, 8)
    with pytest.raises(InputError, match=r"agents\[id 4\].neighbours: expected numbers of other agents, got 8"):
        scenario(wrong, ZHAO)
