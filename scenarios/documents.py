"""Documents for other programs to show: Markdown, LaTeX and CSV tables and JUnit XML, of whatever they are given."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

Value = str | float | int | None
"""What stands in a cell; None for what did not happen."""


class Sheet(NamedTuple):
    """A table before it is written in any form.

    Attributes:
        columns: their names, units in them.
        rows: a value for each column.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Value]]

    @property
    def numbers(self) -> list[bool]:
        """Which columns hold no text."""
        return [not any(isinstance(row[k], str) for row in self.rows) for k in range(len(self.columns))]

    def with_columns(self, names: Sequence[str]) -> Sheet:
        """The same with these columns alone, in this order.

        Raises:
            KeyError: there is none of a name.
        """
        at = {name: k for k, name in enumerate(self.columns)}
        kept = [at[name] for name in names]
        return Sheet(list(names), [[row[k] for k in kept] for row in self.rows])

    def without_empty(self) -> Sheet:
        """The same without columns in which nothing happened."""
        full = [k for k in range(len(self.columns)) if not all(_missing(row[k]) for row in self.rows)]
        return self.with_columns([self.columns[k] for k in full])


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


def markdown(sheet: Sheet) -> str:
    """A sheet for people to read: numbers with four digits."""
    texts = [[_short(value) for value in row] for row in sheet.rows]
    texts_first = sheet.numbers.index(True) if True in sheet.numbers else len(sheet.columns)
    return "\n".join(markdown_table(sheet.columns, texts, len(sheet.columns) - texts_first)) + "\n"


def csv(sheet: Sheet) -> str:
    """A sheet for programs: numbers with all their digits, empty cells for what did not happen."""
    import csv as package  # the other documents do without
    from io import StringIO

    text = StringIO()
    rows = [["" if _missing(value) else value for value in row] for row in sheet.rows]
    package.writer(text, lineterminator="\n").writerows([sheet.columns, *rows])
    return text.getvalue()


def latex(sheet: Sheet) -> str:
    """A sheet as a LaTeX tabular in the style of the package booktabs: numbers with four digits, powers of ten set."""
    align = "".join("r" if number else "l" for number in sheet.numbers)
    lines = [_latex_line([_escaped(name) for name in sheet.columns])]
    body = [_latex_line([_in_latex(value) for value in row]) for row in sheet.rows]
    frame = [
        rf"\begin{{tabular}}{{{align}}}",
        r"\toprule",
        *lines,
        r"\midrule",
        *body,
        r"\bottomrule",
        r"\end{tabular}",
    ]
    return "\n".join([r"% needs \usepackage{booktabs}", *frame]) + "\n"


def _missing(value: Value) -> bool:
    return value is None or (isinstance(value, float) and not math.isfinite(value))


def _short(value: Value) -> str:
    if _missing(value):
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _in_latex(value: Value) -> str:
    if isinstance(value, str):
        return _escaped(value)
    mantissa, _, power = _short(value).partition("e")
    if mantissa == "-":
        return "--"
    return f"${mantissa}$" if not power else rf"${mantissa} \times 10^{{{int(power)}}}$"


LATEX = str.maketrans(
    {c: "\\" + c for c in "&%$#_{}"}
    | {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
)
"""Characters that mean something to LaTeX."""


def _escaped(text: str) -> str:
    return text.translate(LATEX)


def _latex_line(cells: Sequence[str]) -> str:
    return " & ".join(cells) + r" \\"


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
