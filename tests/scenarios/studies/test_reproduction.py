"""The page with the paper's numbers: it is current, and the numbers are the theory's."""

import re
from pathlib import Path

import pytest

from formation import decay_rates
from robots import PLANTS
from scenarios.definition.experiment import open_experiment
from scenarios.studies.reproduction import MACHINE, SHAPE, Trial, markdown, reproduce, run_trial

PAGE = Path(__file__).parents[3] / "docs" / "reproduction.md"


def structure(page: str) -> list[str]:
    """The page without what plants measured and without versions."""
    lines = []
    measured = 0
    for line in page.splitlines():
        if line.startswith("| "):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if PLANTS[0] in cells:
                measured = len(PLANTS)
            elif "simulated" in cells:
                measured = 0
            lines.append(" | ".join(cells[: len(cells) - measured]))
        elif not line.startswith("Made with"):
            lines.append(line)
    return lines


@pytest.mark.slow
def test_the_committed_page_is_what_the_command_writes_but_for_measured_digits() -> None:
    page = markdown(reproduce(1, lambda done, total: None))
    assert structure(PAGE.read_text(encoding="utf-8")) == structure(page)


def test_the_committed_page_holds_the_papers_numbers() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for degrees in ("90", "315", "45", "270", "63.43", "306.87", "296.57", "53.13"):
        assert re.search(rf"^\| alpha\([^|]*\) \| {re.escape(degrees)} \|", page, flags=re.MULTILINE)
    for place in ("(0, 0.5)", "(-0.5, 0)", "(0.5, 0)", "(0, -0.5)", "(-1, 0)", "(1, 0)"):
        assert f"| {place} |" in page
    for leader in ("(-0.4, 0.65)", "(1.6, 0.65)", "(2.8, 0.65)"):
        assert f"| leader | {leader} |" in page
    for rate in ("0.500", "1.000", "0.640"):
        assert f"| {rate} |" in page


@pytest.mark.parametrize(("follower", "rate"), [(3, 0.5), (4, 1.0), (5, 0.64), (6, 0.64)])
def test_a_follower_by_itself_decays_at_the_papers_rate(follower: int, rate: float) -> None:
    index = follower - 3
    assert decay_rates(open_experiment(SHAPE).target)[index] == pytest.approx(rate)
    found = run_trial(Trial(SHAPE, "single_integrator", follower))
    assert found["late_rates_per_s"]["measured"][index] == pytest.approx(rate, rel=1e-3)


def test_the_simulated_robot_is_the_papers_to_its_printed_digits() -> None:
    for _, stated, simulated in MACHINE:
        digits = len(stated.partition(".")[2])
        assert round(simulated, digits) == float(stated)
