"""The file of a user's own law: read once, copied into run folders, executed only to run it. Loads no numpy."""

from __future__ import annotations

import ast
import hashlib
import sys
import traceback
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from scenarios.definition.files.reading import read_regular
from scenarios.errors import InputError

LONGEST_MESSAGE = 200
"""Characters of a user's exception that a message repeats."""


@dataclass(frozen=True)
class LawFile:
    """The source of an own law, as it was when its scenario was loaded.

    Attributes:
        path: of the file, for messages.
        source: its content.
    """

    path: Path
    source: bytes

    @property
    def sha256(self) -> str:
        """Digest of the content."""
        return hashlib.sha256(self.source).hexdigest()

    def execute(self) -> ModuleType:
        """The module that the file defines, executed anew; nothing is searched in or added to ``sys.path``.

        Raises:
            InputError: the file is not Python, or executing it raises; the message names the line.
        """
        module = ModuleType(f"own_law_{self.sha256[:16]}")
        module.__file__ = str(self.path)
        try:
            code = compile(self.source, str(self.path), "exec", dont_inherit=True)
        except SyntaxError as error:
            raise InputError(f"{self.at(error.lineno)}: not valid Python: {_shortened(error.msg)}") from None
        except ValueError as error:  # a null byte
            raise InputError(f"{self.path}: not valid Python: {error}") from None
        sys.modules[module.__name__] = module  # dataclasses look their module up there
        try:
            exec(code, module.__dict__)
        except (Exception, SystemExit) as error:
            del sys.modules[module.__name__]
            raise self.failure("executing the file", error) from error
        return module

    def literal(self, owner: str, name: str) -> str | None:
        """The text that the class or function ``owner`` has as its attribute ``name``, read without executing anything.

        None where the file gives it no literal text: in the class, in one of the file's classes that it stands on, or
        as an assignment to ``owner.name``.
        """
        try:
            body = ast.parse(self.source).body
        except (SyntaxError, ValueError):  # what executing the file will tell
            return None
        classes = {node.name: node for node in body if isinstance(node, ast.ClassDef)}
        waiting, found = [owner], None
        while waiting and found is None:
            node = classes.pop(waiting.pop(0), None)
            if node is not None:
                found = _assigned(node.body, name)
                waiting = [base.id for base in node.bases if isinstance(base, ast.Name)] + waiting
        return _assigned(body, f"{owner}.{name}") or found

    def failure(self, doing: str, error: BaseException) -> InputError:
        """What to raise for an exception of the user's code: its line, what was asked of it, and what it raised."""
        frames = traceback.extract_tb(error.__traceback__)
        line = next((frame.lineno for frame in reversed(frames) if frame.filename == str(self.path)), None)
        raised = traceback.format_exception_only(error)[-1].strip()
        return InputError(f"{self.at(line)}: {doing} raised {_shortened(raised)}")

    def at(self, line: int | None) -> str:
        """The place in the file as messages name it."""
        return str(self.path) if line is None else f"{self.path}:{line}"


def read(scenario: str, folder: Path, name: str, key: str = "law.file") -> LawFile:
    """Read the file ``name``, the value of ``key``, of a scenario that lies in ``folder``.

    Raises:
        InputError: it cannot be read; the message names the scenario.
    """
    path = folder / name
    try:
        return LawFile(path, read_regular(path))
    except FileNotFoundError:
        raise InputError(f"{scenario}: {key}: no such file: {path}") from None
    except (OSError, ValueError) as error:  # a path with a null byte
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{scenario}: {key}: {path} cannot be read: {reason}") from None


def defined(module: ModuleType) -> list[str]:
    """Names of the functions and classes that a file itself defines for others."""
    return [
        name
        for name, value in vars(module).items()
        if callable(value) and getattr(value, "__module__", None) == module.__name__ and not name.startswith("_")
    ]


def _assigned(body: list[ast.stmt], name: str) -> str | None:
    """The literal text that the last assignment to ``name`` among statements gives it."""
    found = None
    for node in body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        value = node.value if isinstance(node, ast.Assign | ast.AnnAssign) else None
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            found = value.value if name in map(ast.unparse, targets) else found
    return found


def _shortened(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= LONGEST_MESSAGE else f"{line[:LONGEST_MESSAGE]}..."
