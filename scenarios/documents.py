"""Documents for other programs to show: Markdown tables and JUnit XML, of whatever they are given."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


def cell(value: float | None, form: str, unit: str = "") -> str:
    """A number in a table; a dash for what did not happen.

    >>> cell(0.25, ".1e", " rad"), cell(None, ".1e")
    ('2.5e-01 rad', '-')
    """
    return "-" if value is None else f"{value:{form}}{unit}"


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]], numbers: int = 0) -> list[str]:
    r"""The lines of a Markdown table; the last ``numbers`` columns are aligned right.

    >>> markdown_table(("a", "b"), [("x|y", "1")], numbers=1)
    ['| a | b |', '|---|---:|', '| x\\|y | 1 |']
    """
    rule = "---|" * (len(columns) - numbers) + "---:|" * numbers
    return [_line(columns), f"|{rule}", *(_line([text.replace("|", "\\|") for text in row]) for row in rows)]


class Case(NamedTuple):
    """One test case.

    Attributes:
        name: in its suite.
        seconds: that it took.
        message, details: of a failure, in one line and at length; empty where it passed.
    """

    name: str
    seconds: float
    message: str = ""
    details: str = ""


def junit(name: str, suites: Sequence[tuple[str, Sequence[Case]]]) -> str:
    """A JUnit XML report, as continuous integration reads it: named suites of cases."""
    from xml.etree import ElementTree  # the other documents do without

    root = ElementTree.Element("testsuites", _counts([case for _, cases in suites for case in cases]), name=name)
    for suite_name, cases in suites:
        suite = ElementTree.SubElement(root, "testsuite", _counts(cases), name=suite_name)
        for case in cases:
            attributes = {"classname": suite_name, "name": case.name, "time": f"{case.seconds:.3f}"}
            element = ElementTree.SubElement(suite, "testcase", attributes)
            if case.message:
                ElementTree.SubElement(element, "failure", message=case.message).text = case.details
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _counts(cases: Sequence[Case]) -> dict[str, str]:
    return {
        "tests": str(len(cases)),
        "failures": str(sum(bool(case.message) for case in cases)),
        "errors": "0",
        "time": f"{sum(case.seconds for case in cases):.3f}",
    }


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
