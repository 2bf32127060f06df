"""The comparison as JUnit XML and as Markdown, for continuous integration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

from scenarios.studies.check.check import Check
from scenarios.studies.check.compare import Comparison, worst_first
from scenarios.studies.check.rows import CASES, LISTED, MISSES, case_rows, miss_row, number, value

Folders = Mapping[Comparison, Path]


def junit(check: Check, folders: Folders) -> str:
    """One test suite per scenario, one test case per run."""
    root = ElementTree.Element("testsuites", _counts(check.comparisons), name="formation check")
    for scenario, group in groupby(check.comparisons, key=lambda c: c.scenario):
        runs = list(group)
        suite = ElementTree.SubElement(root, "testsuite", _counts(runs), name=scenario)
        for comparison in runs:
            run = comparison.run
            case = ElementTree.SubElement(
                suite,
                "testcase",
                classname=scenario,
                name=" ".join([run.plant, f"seed {run.seed}", *run.changes]),
                time=f"{comparison.seconds:.3f}",
            )
            misses = comparison.misses
            if misses:
                worst = misses[0]
                message = f"{worst.name}: {value(worst.found)}, baseline {value(worst.expected)}"
                lines = [
                    f"{m.name}: {value(m.found)}, baseline {value(m.expected)}, difference {number(m.difference)}, "
                    f"tolerance {number(m.tolerance)}"
                    for m in misses
                ]
                lines += [comparison.command]
                if comparison in folders:
                    lines += [f"formation replay {folders[comparison]}"]
                ElementTree.SubElement(case, "failure", message=message).text = "\n".join(lines)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _counts(runs: Sequence[Comparison]) -> dict[str, str]:
    return {
        "tests": str(len(runs)),
        "failures": str(sum(bool(run.misses) for run in runs)),
        "errors": "0",
        "time": f"{sum(run.seconds for run in runs):.3f}",
    }


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


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a Markdown table."""
    cells = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    return [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}", *(f"| {' | '.join(row)} |" for row in cells)]
