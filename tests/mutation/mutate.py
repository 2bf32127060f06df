"""Small changes of a Python source, each of which a good test suite notices.

A mutant replaces one stretch of the text, so comments, lines and everything else stay as they are. Left alone: what no
test should look at (docstrings, annotations, decorators, texts of messages) and what an import does.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

BINARY = {
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Pow: "*", ast.FloorDiv: "*", ast.Mod: "*",
    ast.BitAnd: "|", ast.BitOr: "&", ast.BitXor: "&",
}  # fmt: skip
COMPARED = {
    ast.Lt: ("<=", ">="), ast.LtE: ("<", ">"), ast.Gt: (">=", "<="), ast.GtE: (">", "<"), ast.Eq: ("!=",),
    ast.NotEq: ("==",), ast.Is: ("is not",), ast.IsNot: ("is",), ast.In: ("not in",), ast.NotIn: ("in",),
}  # fmt: skip
AUGMENTED = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "@=": "=", "^=": "="}
RENAMED = {
    "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "sin": "cos", "cos": "sin", "any": "all",
    "all": "any", "argmin": "argmax", "argmax": "argmin", "zeros": "ones", "ones": "zeros", "floor": "ceil",
    "ceil": "floor", "rint": "floor", "zeros_like": "ones_like", "nanmin": "nanmax", "nanmax": "nanmin",
}  # fmt: skip
TRANSPARENT = frozenset(("abs", "sqrt", "exp", "max", "min", "maximum", "minimum", "round", "sorted", "conj"))
"""Functions that a mutant leaves out, keeping their first argument."""


SAID = (ast.JoinedStr, ast.Raise, ast.Import, ast.ImportFrom)
"""What is only said, and what every mutant needs."""


@dataclass(frozen=True, order=True)
class Mutant:
    """One change: the text from ``start`` to ``end`` of the source of ``path`` becomes ``text``.

    ``line`` is the first line that it touches, from 1; ``before`` and ``after`` are that line, to read.
    """

    path: str
    start: int
    end: int
    text: str
    line: int
    before: str
    after: str

    def applied(self, source: str) -> str:
        """The changed source."""
        return source[: self.start] + self.text + source[self.end :]


def mutants(path: str, source: str) -> list[Mutant]:
    """All mutants of a source, in its order; those that are no Python are left out."""
    lines = source.splitlines(keepends=True)
    begin = [0]
    for line in lines:
        begin.append(begin[-1] + len(line))

    def at(line: int, column: int) -> int:
        return begin[line - 1] + len(lines[line - 1].encode()[:column].decode())

    found = set()
    for node in _inspected(ast.parse(source)):
        spans = {
            id(part): (at(part.lineno, part.col_offset), at(part.end_lineno or 0, part.end_col_offset or 0))
            for part in (node, *ast.iter_child_nodes(node))
            if isinstance(part, ast.expr | ast.stmt)
        }
        for start, end, text in _changes(node, source, spans):
            changed = source[:start] + text + source[end:]
            try:
                ast.parse(changed)
            except SyntaxError:
                continue
            row = source.count("\n", 0, start)
            before, after = source.splitlines()[row].strip(), changed.splitlines()[row].strip()
            found.add(Mutant(path, start, end, text, row + 1, before, after))
    return sorted(found)


def _inspected(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes below one that run and compute."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(
                child, ast.JoinedStr | ast.Raise | ast.Import | ast.ImportFrom
            ):
                continue
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
                continue
            yield child
            yield from _inspected(child)


def _changes(node: ast.AST, source: str, spans: dict[int, tuple[int, int]]) -> Iterator[tuple[int, int, str]]:
    """Start, end and new text of each change of one node."""

    def between(one: ast.AST, other: ast.AST) -> tuple[int, int]:
        """The operator between two operands, without brackets and blanks around it."""
        start, end = spans[id(one)][1], spans[id(other)][0]
        while source[start] in ") \n\\":
            start += 1
        while source[end - 1] in "( \n\\":
            end -= 1
        return start, end

    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            start, end = spans[id(node)]
            for other in (
                (value + 1, value - 1) if isinstance(value, int) else (value * 2.0 or 1.0, value / 2.0 or -1.0)
            ):
                yield start, end, f"({other!r})" if other < 0 else repr(other)
        case ast.BinOp() if type(node.op) in BINARY:
            yield *between(node.left, node.right), BINARY[type(node.op)]
        case ast.Compare():
            for (one, other), operator in zip(pairwise([node.left, *node.comparators]), node.ops, strict=True):
                for text in COMPARED[type(operator)]:
                    yield *between(one, other), text
        case ast.BoolOp():
            for one, other in pairwise(node.values):
                yield *between(one, other), "or" if isinstance(node.op, ast.And) else "and"
        case ast.UnaryOp():
            yield *spans[id(node)], source[slice(*spans[id(node.operand)])].join("()")
        case ast.AugAssign():
            start, end = between(node.target, node.value)
            yield start, end, "="
            if source[start:end] in AUGMENTED:
                yield start, end, AUGMENTED[source[start:end]]
        case ast.IfExp():
            body, other = (source[slice(*spans[id(part)])] for part in (node.body, node.orelse))
            yield *spans[id(node.body)], other
            yield *spans[id(node.orelse)], body
        case ast.If() | ast.While():
            test = source[slice(*spans[id(node.test)])]
            yield *spans[id(node.test)], f"not ({test})"
        case ast.Call():
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in RENAMED:
                end = spans[id(node.func)][1]
                yield end - len(name), end, RENAMED[name]
            if name in TRANSPARENT and node.args and not isinstance(node.args[0], ast.Starred):
                yield *spans[id(node)], source[slice(*spans[id(node.args[0])])].join("()")
        case ast.Expr(value=ast.Call()) | ast.Assign(targets=[ast.Subscript() | ast.Attribute()]):
            yield *spans[id(node)], "pass"
        case ast.Continue():
            yield *spans[id(node)], "break"
        case ast.Break():
            yield *spans[id(node)], "continue"
