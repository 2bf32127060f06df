"""`formation new`: a scenario to begin with."""

from collections.abc import Callable
from pathlib import Path

import pytest

from scenarios.definition.experiment import open_experiment

Cli = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize("options", [(), ("--law",)])
def test_a_new_scenario_runs_as_it_is_and_reaches_its_goal(cli: Cli, options: tuple[str, ...]) -> None:
    code, out, err = cli("new", "my-own", *options)
    assert (code, err) == (0, "")
    [written] = [line for line in out.splitlines() if line.endswith(".toml")][:1]
    code, out, _ = cli("run", written, "--plant", "saturated", "--no-recording")
    assert code == 0
    assert "outcome: converged" in out


def test_a_new_law_is_the_one_that_runs(cli: Cli) -> None:
    assert cli("new", "my-own", "--law")[0] == 0
    law = open_experiment("my-own.toml").file.law
    assert law is not None
    assert law.source == Path("my_own_law.py").read_bytes()


def test_nothing_of_ones_own_is_replaced(cli: Cli) -> None:
    assert cli("new", "mine")[0] == 0
    code, out, err = cli("new", "mine", "--law")
    assert (code, out) == (2, "")
    assert "mine.toml exists" in err


@pytest.mark.parametrize("name", ["../mine", "", "a b", "-x/y", "ä"])
def test_a_name_that_is_no_plain_name_is_refused_in_one_line(cli: Cli, name: str) -> None:
    code, out, err = cli("new", "--", name)
    assert (code, out, err.count("\n")) == (2, "", 1)
