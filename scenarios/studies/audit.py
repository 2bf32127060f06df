"""The audit of a scenario's law: what the theory's checks find, and what its robots and random starts add to them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.markup import escape

from formation.audit import Finding, Subject, audit
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.own_law import OwnLaw
from scenarios.definition.schema import Scenario
from scenarios.documents import markdown_table
from scenarios.studies.shares import COMPASS_BIAS_DEG, DURATION, RANDOM_START, Progress, part_of, share_reaching
from scenarios.terminal import new_table, print_table

COLUMNS = ("check", "verdict", "measured", "remark")

VERDICTS = {True: "holds", False: "fails", None: "note"}
"""A note tells what a law is like; it is not demanded."""

ROUNDING = 1e-9
"""Smaller numbers are printed as smaller than this: they are other ones on every machine."""


def audit_scenario(
    source: str, changes: tuple[str, ...], starts: int, on_progress: Progress
) -> tuple[Experiment, list[Finding]]:
    """The experiment of a scenario, and all findings about its law.

    Args:
        source: the scenario's library name or path.
        changes: ``key=value`` texts, as with ``--set``.
        starts: random starts for the share that reaches the goal; 0 for none.
        on_progress: called with the number of control periods done and of all.

    Raises:
        InputError: the scenario, or the law, cannot be used.
    """
    experiment = open_experiment(source, changes)
    law = experiment.law.raw if isinstance(experiment.law, OwnLaw) else experiment.law  # itself, with all its faults
    subject = Subject(law, experiment.formation, experiment.phases[0].delta)
    findings = audit(subject, experiment.scenario.plant.control_period_s)
    findings.append(_start_speed(experiment))
    biases = [0.0, COMPASS_BIAS_DEG] if experiment.law.needs_compass else [0.0]
    for done, bias in enumerate(biases if starts else []):
        advance = part_of(on_progress, done, len(biases))
        findings.append(_convergence(source, changes, experiment.scenario, bias, starts, advance))
    return experiment, findings


def passed(findings: Sequence[Finding]) -> bool:
    """Whether everything that is demanded of a law holds."""
    return all(finding.holds is not False for finding in findings)


def _start_speed(experiment: Experiment) -> Finding:
    """The greatest velocity, v_r included, that the law asks for at the start, beside what the wheels can do."""
    phase, limit = experiment.phases[0], experiment.robot.drive.speed_limit
    subject = Subject(experiment.law, experiment.formation, phase.delta)
    speed = np.linalg.norm(subject(experiment.initial_points(0)) + phase.velocity, axis=1)
    fastest = int(speed.argmax())
    remark = f"{experiment.name(fastest)}; the wheels do {limit:g} m/s{': cut' if speed[fastest] > limit else ''}"
    return Finding("speed at the start", None, float(speed[fastest]), "m/s", remark)


def _convergence(
    source: str, changes: tuple[str, ...], scenario: Scenario, bias: float, starts: int, advance: Progress
) -> Finding:
    """The share of random starts from which ideal single integrators reach the scenario's goal."""
    ideal = ["plant.name=single_integrator", "sensor.delay_periods=0", f"sensor.compass_bias_deg={bias}"]
    places = RANDOM_START if scenario.random_start is None else ()
    duration = None if scenario.duration_s is None else max(DURATION, scenario.duration_s)
    experiment = open_experiment(source, (*changes, *ideal, *places), duration)
    share = share_reaching(experiment, starts, advance)
    compasses = f" with {bias:g} deg compass error" if bias else ""
    return Finding("convergence", None, 100.0 * share, "%", f"of {starts} random starts reach the goal{compasses}")


def print_audit(console: Console, experiment: Experiment, findings: Sequence[Finding]) -> None:
    """The findings as a table."""
    console.print(f"[bold]{escape(experiment.file.name)}[/bold]: {escape(experiment.scenario.title)}")
    table = new_table(*COLUMNS)
    for finding, row in zip(findings, rows(findings), strict=True):
        table.add_row(*(escape(cell) for cell in row), style="bold red" if finding.holds is False else "")
    print_table(console, table)
    console.print(f"the law {'[green]passes' if passed(findings) else '[red]fails'}")


def markdown(
    experiment: Experiment, findings: Sequence[Finding], source: str, changes: tuple[str, ...], starts: int
) -> str:
    """The audit as a Markdown page, with the command that makes it."""
    settings = [text for change in changes for text in ("--set", change)]
    command = shlex.join(["formation", "audit", source, *settings, "--starts", str(starts)])
    lines = [f"# The law of `{experiment.file.name}`, audited", "", f"By `{command}`.", ""]
    lines += markdown_table(COLUMNS, rows(findings))
    lines += ["", f"The law {'passes' if passed(findings) else 'fails'}. A note is told, not demanded."]
    return "\n".join(lines) + "\n"


def rows(findings: Sequence[Finding]) -> list[tuple[str, str, str, str]]:
    """The cells of each finding."""
    return [(f.check, VERDICTS[f.holds], _measured(f), f.remark) for f in findings]


def _measured(finding: Finding) -> str:
    value = finding.measured
    if value is None:
        return "-"
    rounded = abs(value) < ROUNDING and finding.unit != "%"
    number = f"< {ROUNDING:g}" if rounded else f"{value:.3g}"
    return f"{number} {finding.unit}".strip()
