"""Every law on every scenario of the library: it runs, or one line says why it cannot."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from formation import LAWS
from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.errors import InputError
from scenarios.simulation.loop import simulate

MANY = "random-50"
SCENARIOS = sorted(path.stem for path in Path(LIBRARY).glob("*.toml"))


@pytest.mark.parametrize(
    "scenario", [pytest.param(each, marks=pytest.mark.slow) if each == MANY else each for each in SCENARIOS]
)
@pytest.mark.parametrize("graph", ["given", "design"])
def test_every_law_runs_on_every_scenario_or_one_line_says_why_not(scenario: str, graph: str) -> None:
    found = Counter[str]()
    for law in LAWS:
        changes = (f"law.name={law}", *((f"graph={graph}",) if graph == "design" else ()))
        try:
            experiment = open_experiment(scenario, changes, duration=0.1)
        except InputError as refused:
            message = str(refused)
            assert message.startswith(scenario)
            assert "\n" not in message
            assert len(message) < 300
            found["refused"] += 1
            continue
        run = simulate(experiment, 0)
        assert np.isfinite(run.points).all()
        found["ran"] += 1
    assert found.total() == len(LAWS)
    if scenario == "shape" and graph == "design":
        assert found["refused"] == 2  # the laws of three agents


@pytest.mark.parametrize("law", ["triangle-angles", "triangle-mixed"])
def test_no_graph_is_offered_where_none_can_be_built(law: str) -> None:
    with pytest.raises(InputError, match="expected 3 agents, got 6") as refused:
        open_experiment("shape", (f"law.name={law}",))
    assert "builds one" not in str(refused.value)
