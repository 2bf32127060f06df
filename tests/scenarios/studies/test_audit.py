"""The audit of a scenario's law, as the command line gives it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenarios.cli import BAD_INPUT, DONE, MISSED
from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.simulation.loop import simulate
from scenarios.studies.audit import audit_scenario, markdown, passed
from scenarios.studies.shares import share_reaching

LAW = """
import numpy as np
from formation import AngleLaw

class MyLaw:
    needs_compass = False

    def __init__(self, target, gain=1.0):
        self.law, self.gain = AngleLaw(target), gain

    def __call__(self, relative, compass, delta):
        return self.gain * self.law(relative)
"""

Cli = Callable[..., tuple[int, str, str]]


def nothing(done: int, total: int) -> None:
    """A progress bar that shows nothing."""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The scenario `shape` with a law of its own, in an empty working folder."""
    monkeypatch.chdir(tmp_path)
    text = (LIBRARY / "shape.toml").read_text(encoding="utf-8")
    table = '\n[law]\nname = "own"\nfile = "my_law.py"\nfactory = "MyLaw"\n'
    (tmp_path / "mine.toml").write_text(text + table, encoding="utf-8")
    (tmp_path / "my_law.py").write_text(LAW, encoding="utf-8")
    return "./mine.toml"


@pytest.mark.parametrize(
    "scenario", ["shape", "maneuver", "law-displacement", "law-bearing", "law-distance", "random-50", "own-law"]
)
def test_every_law_of_the_library_passes(cli: Cli, scenario: str) -> None:
    code, out, err = cli("audit", scenario, "--starts", "0")
    assert (code, err) == (DONE, "")
    assert "the law passes" in out
    assert "fails" not in out
    assert "convergence" not in out


def test_a_law_that_fails_is_told_in_the_table_and_by_the_exit_code(cli: Cli, mine: str) -> None:
    code, out, err = cli("audit", mine, "--starts", "0", "--set", "law.parameters.gain=-1")
    assert (code, err) == (MISSED, "")
    failing = [line.split("fails")[0].strip() for line in out.splitlines() if " fails " in line]
    assert failing == ["local stability", "control period"]
    assert "agent 4, edges (4, 2) (4, 3)" in out
    assert out.endswith("the law fails\n")


def test_shares_of_random_starts_are_those_of_the_comparison_of_laws() -> None:
    shares = {}
    for scenario in ("law-displacement", "law-distance"):
        found = audit_scenario(scenario, (), 20, nothing)[1]
        shares[scenario] = [(f.measured, f.remark) for f in found if f.check == "convergence"]
    exact, biased = shares["law-displacement"]
    assert exact == (100.0, "of 20 random starts reach the goal")
    assert biased == (0.0, "of 20 random starts reach the goal with 5 deg compass error")
    (distance,) = shares["law-distance"]
    assert distance[0] is not None
    assert distance[0] < 50.0


def test_a_run_that_diverges_does_not_decide_for_the_others(mine: str) -> None:
    far = "np.linalg.norm(relative[..., :1, :], axis=-1, keepdims=True) > 1.0"
    source = LAW.replace("self.gain * self.law(relative)", f"np.where({far}, np.nan, self.law(relative))")
    Path("my_law.py").write_text(source, encoding="utf-8")
    changes = ("plant.name=single_integrator", "random_start={}")
    experiment = open_experiment(mine, changes, 30.0)
    apart = [np.isfinite(simulate(experiment, seed).points[-1]).all() for seed in range(12)]
    assert 0 < sum(apart) < 12
    assert share_reaching(experiment, 12, nothing) == pytest.approx(np.mean(apart))


def test_a_law_too_fast_for_its_clock_fails_and_diverges_without_a_warning(cli: Cli, mine: str) -> None:
    code, out, err = cli("audit", mine, "--starts", "2", "--set", "law.parameters.gain=100")
    assert (code, err) == (MISSED, "")
    assert "0.02 s  the longest that is stable; the scenario's is 0.033 s" in out
    assert "0 %  of 2 random starts reach the goal" in out


def test_a_law_that_does_not_take_batches_is_told_and_served(cli: Cli, mine: str) -> None:
    source = LAW.replace("return", "assert relative.ndim == 2; return")
    Path("my_law.py").write_text(source, encoding="utf-8")
    code, out, err = cli("audit", mine, "--starts", "1")
    assert (code, err) == (DONE, "")
    assert "not taken (AssertionError): states are asked one by one" in out
    assert "100 %  of 1 random starts" in out


def test_the_speed_at_the_start_is_that_of_the_first_command() -> None:
    experiment = open_experiment("shape")
    observer, observed = experiment.graph.edges.T
    p = experiment.initial_points(0)
    fastest = np.linalg.norm(experiment.law(p[observed] - p[observer]), axis=1)
    shape = {f.check: f for f in audit_scenario("shape", (), 0, nothing)[1]}["speed at the start"]
    assert shape.measured == pytest.approx(fastest.max())
    assert shape.remark == f"agent {fastest.argmax() + 1}; the wheels do 0.2 m/s: cut"
    assert shape.holds is None


def test_the_speed_at_the_start_has_the_common_velocity_in_it() -> None:
    changes = ('phases=[{name="a", duration_s=1.0, displacement_m=[0.5, 0.5], velocity_m_s=[3.0, 4.0]}]',)
    starts = tuple(f"agents.{k}.start={p}" for k, p in enumerate(_at_rest(), start=1))
    found = {f.check: f for f in audit_scenario("maneuver", changes + starts, 0, nothing)[1]}
    assert found["speed at the start"].measured == pytest.approx(5.0)


def _at_rest() -> list[list[float]]:
    """The target, turned and scaled so that agent 2 is displaced by (0.5, 0.5) m."""
    p = open_experiment("maneuver").target.positions
    return (p @ np.array([[0.5, 0.5], [-0.5, 0.5]])).tolist()


def test_the_table_in_the_documents_is_current() -> None:
    page = Path(__file__).parents[3] / "docs" / "own-law-audit.md"
    experiment, findings = audit_scenario("own-law", (), 100, nothing)
    assert passed(findings)
    current = markdown(experiment, findings, "own-law", (), 100)
    assert page.read_text(encoding="utf-8") == current, "run `formation audit own-law --markdown docs/own-law-audit.md`"


def test_a_report_that_cannot_be_written_is_refused(cli: Cli, mine: str) -> None:
    Path("file").write_text("mine", encoding="utf-8")
    code, _, err = cli("audit", mine, "--starts", "0", "--markdown", "file/audit.md")
    assert code == BAD_INPUT
    assert err.startswith("formation: --markdown file/audit.md: cannot be written")
