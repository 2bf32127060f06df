"""`--json`: the output is JSON and nothing else, what people read stands on the error stream."""

import json
from collections.abc import Callable
from pathlib import Path

from scenarios.definition.load import library

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
