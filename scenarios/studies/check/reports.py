"""The comparison as JUnit XML and as Markdown, for continuous integration."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from pathlib import Path

from scenarios import documents
from scenarios.documents import Case, markdown_table
from scenarios.studies.check.compare import Comparison, worst_first
from scenarios.studies.check.repeat import Check
from scenarios.studies.check.rows import CASES, LISTED, MISSES, case_rows, miss_row, number, value

Folders = Mapping[Comparison, Path]


def junit(check: Check, folders: Folders) -> str:
    """One test suite per scenario, one test case per run."""
    suites = groupby(check.comparisons, key=lambda c: c.scenario)
    return documents.junit(
        "formation check", [(scenario, [_case(run, folders) for run in runs]) for scenario, runs in suites]
    )


def _case(comparison: Comparison, folders: Folders) -> Case:
    run, misses = comparison.run, comparison.misses
    name = " ".join([run.plant, f"seed {run.seed}", *run.changes])
    if not misses:
        return Case(name, comparison.seconds)
    details = [
        f"{m.name}: {value(m.found)}, baseline {value(m.expected)}, difference {number(m.difference)}, "
        f"tolerance {number(m.tolerance)}"
        for m in misses
    ]
    details += [comparison.command]
    if comparison in folders:
        details += [f"formation replay {folders[comparison]}"]
    message = f"{misses[0].name}: {value(misses[0].found)}, baseline {value(misses[0].expected)}"
    return Case(name, comparison.seconds, message, "\n".join(details))


def markdown(check: Check, folders: Folders) -> str:
    """The summary, what was missed, and every case."""
    lines = ["## Runs beside their baselines", "", check.summary, ""]
    misses = worst_first(check.comparisons)
    if misses:
        lines += ["### Missed, the worst angle first", ""]
        lines += markdown_table(MISSES, [miss_row(*pair) for pair in misses[:LISTED]])
        if len(misses) > LISTED:
            lines += ["", f"{len(misses) - LISTED} more in the runs below."]
        lines += [""]
        lines += [
            f"- `{comparison.command}`" + (f", in `{folders[comparison]}`" if comparison in folders else "")
            for comparison in check.missed
        ]
        lines += [""]
    lines += ["### Every case, with its largest differences", ""]
    lines += markdown_table(CASES, case_rows(check.comparisons))
    lines += ["", *(f"- {note}" for note in check.notes)]
    return "\n".join(lines) + "\n"
