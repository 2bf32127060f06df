"""What the documents name exists."""

import ast
import re
import runpy
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def names_in(path: Path) -> set[str]:
    return {
        node.name
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
    }


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_code_reference_resolves(document: Path) -> None:
    missing = []
    for file, name in re.findall(r"`([\w/-]+\.py)::(\w+)`", document.read_text(encoding="utf-8")):
        if not (ROOT / file).is_file() or name not in names_in(ROOT / file):
            missing.append(f"{file}::{name}")
    assert missing == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_relative_link_and_picture_exists(document: Path) -> None:
    targets = re.findall(r"\]\(([^)#\s]+)", document.read_text(encoding="utf-8"))
    local = [target for target in targets if "://" not in target]
    assert [target for target in local if not (document.parent / target).exists()] == []


def test_every_library_scenario_named_in_the_readme_exists_and_the_other_way_round() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^\| `([\w-]+)` \|", readme, flags=re.MULTILINE))
    assert {path.stem for path in (ROOT / "scenarios" / "library").glob("*.toml")} <= named


def test_the_python_of_the_documents_runs_as_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "python.md").read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(block, names)
    assert names["verdict"].accepted
    assert np.linalg.norm(names["world"].points - names["places"], axis=1).max() < 0.01
    assert np.abs(names["errors"]).sum(axis=1).max() < 0.01
    assert names["result"]["outcome"] == "converged"


def test_the_page_of_closed_forms_has_the_rows_that_its_command_computes() -> None:
    """Those that take no long simulation; tests/evidence/test_theory.py compares the whole page."""
    command = runpy.run_path(str(ROOT / "docs" / "theory.py"))
    page = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    rows = [command["line"](row) for part in ("growth", "dwell") for row in command[part]()]
    assert len(rows) == 8
    assert [row for row in rows if row not in page.splitlines()] == []
    assert page.startswith(command["HEAD"])
    assert page.endswith(command["TAIL"])
