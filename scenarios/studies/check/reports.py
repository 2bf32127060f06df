"""The comparison as JUnit XML, Markdown and JSON, for continuous integration and other programs."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from itertools import groupby
from pathlib import Path
from typing import Any

from scenarios import documents
from scenarios.documents import Case, markdown_table
from scenarios.studies.check.compare import Comparison, Difference, worst_first
from scenarios.studies.check.repeat import Check
from scenarios.studies.check.rows import CASES, LISTED, MISSES, case_rows, miss_row, number, value

SCHEMA_VERSION = 1
"""Of the comparison as JSON."""

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


def as_json(check: Check, folders: Folders) -> str:
    """The summary and every run with what it missed; numbers that are not finite are null."""
    runs = [
        {
            "scenario": comparison.scenario,
            "plant": comparison.run.plant,
            "seed": comparison.run.seed,
            "changes": list(comparison.run.changes),
            "seconds": comparison.seconds,
            "misses": [_miss(miss) for miss in comparison.misses],
            "folder": str(folders[comparison]) if comparison in folders else None,
        }
        for comparison in check.comparisons
    ]
    content = {"schema_version": SCHEMA_VERSION, "summary": check.summary, "notes": list(check.notes), "runs": runs}
    return json.dumps(content, indent=2)


def _miss(miss: Difference) -> dict[str, Any]:
    numbers = {
        "baseline": miss.expected,
        "now": miss.found,
        "difference": miss.difference,
        "tolerance": miss.tolerance,
    }
    finite = {
        name: None if isinstance(amount, float) and not math.isfinite(amount) else amount
        for name, amount in numbers.items()
    }
    return {"quantity": miss.name, **finite}


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
