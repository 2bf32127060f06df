"""`--json`: the output is JSON and nothing else, what people read stands on the error stream."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import library
from scenarios.report.foretold import foretold
from scenarios.studies.check import baseline

Cli = Callable[..., tuple[int, str, str]]


def test_the_list_names_the_library_with_numbers_as_numbers(cli: Cli) -> None:
    code, out, err = cli("list", "--json")
    listed = json.loads(out)
    assert (code, err) == (0, "")
    assert [scenario["scenario"] for scenario in listed] == library()
    assert all(scenario["agents"] > 2 and scenario["duration_s"] > 0.0 for scenario in listed)


def test_a_run_gives_its_result_and_its_exit_code(cli: Cli) -> None:
    code, out, err = cli(
        "run", "shape", "--plant", "saturated", "--duration", "1", "--no-recording", "--out", "r", "--json"
    )
    assert code == 1
    assert json.loads(out) == json.loads(Path("r/result.json").read_text())
    assert "outcome: not converged" in err


def test_a_sweep_gives_its_summary(cli: Cli) -> None:
    code, out, err = cli(
        "sweep", "shape", "--seeds", "2", "--plant", "saturated", "--duration", "0.5", "--workers", "1", "--out", "s",
        "--json",
    )  # fmt: skip
    assert code == 0
    assert json.loads(out) == json.loads(Path("s/summary.json").read_text())
    assert json.loads(out)["runs"] == 1
    assert "rows:" in err


def test_what_is_foretold_is_what_the_library_says_with_numbers_as_numbers(cli: Cli) -> None:
    code, out, err = cli("show", "shape", "--json")
    told = json.loads(out)
    assert (code, err) == (0, "")
    assert told["agents"][3]["senses"] == [2, 3]
    assert [round(agent["rate_per_s"], 2) for agent in told["agents"][2:]] == [0.5, 1.0, 0.64, 0.64]
    assert [[round(x, 9) + 0.0 for x in place] for place in told["phases"][0]["end_m"]] == [
        [0.0, 0.5], [-0.5, 0.0], [0.5, 0.0], [0.0, -0.5], [-1.0, 0.0], [1.0, 0.0],
    ]  # fmt: skip
    assert told["angles"][0] == {"name": "alpha(1;2,3)", "target_deg": 90.0}


@pytest.mark.parametrize("name", ["gap", "law-affine-undirected", "law-triangle-angles", "own-law", "reshape"])
def test_scenarios_of_every_kind_are_foretold_as_json(name: str) -> None:
    experiment = open_experiment(name)
    told = json.loads(json.dumps(foretold(experiment, 0), allow_nan=False))
    assert len(told["agents"]) == experiment.n
    assert (told["phases"] is None) == (not experiment.predicted)


def test_a_comparison_gives_its_runs_and_what_they_missed(cli: Cli, tmp_path: Path) -> None:
    content = json.loads(baseline.path_of("fastest", baseline.FOLDER).read_text(encoding="utf-8"))
    content["cases"] = [{"plant": "saturated", "seeds": [0, 1], "changes": []}]
    content["runs"] = [run for run in content["runs"] if run["plant"] == "saturated"]
    content["runs"][1]["numbers"]["settling_time_s"] = [99.0, 0.1]
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "fastest.json").write_text(json.dumps(content), encoding="utf-8")
    code, out, err = cli("check", "--baselines", "b", "--workers", "1", "--json")
    told = json.loads(out)
    assert code == 1
    assert [[miss["quantity"] for miss in run["misses"]] for run in told["runs"]] == [[], ["settling_time_s"]]
    [miss] = told["runs"][1]["misses"]
    assert miss["baseline"] == 99.0
    assert miss["difference"] == abs(miss["now"] - 99.0)
    assert Path(told["runs"][1]["folder"], "result.json").is_file()
    assert "missed" in err
    assert cli("check", "--update", "--json")[0] == 2
