"""What is shipped, and what stands around it: one version, one licence, one set of checks."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
YAML = [
    ROOT / "CITATION.cff",
    ROOT / ".pre-commit-config.yaml",
    *sorted((ROOT / ".github").rglob("*.yml")),
]


@pytest.mark.parametrize("path", YAML, ids=lambda path: path.name)
def test_every_file_for_a_forge_can_be_read(path: Path) -> None:
    assert yaml.safe_load(path.read_text(encoding="utf-8"))


def test_the_licence_is_the_same_in_all_places() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    licence = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert PROJECT["license"] == citation["license"] == licence.split()[0]
    [author], [named] = PROJECT["authors"], citation["authors"]
    assert author["name"] == named["name"]
    assert author["name"] in licence


def test_the_version_stands_in_one_place() -> None:
    assert "version" not in yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    sources = [path for room in ("formation", "robots", "scenarios") for path in (ROOT / room).rglob("*.py")]
    assert [path for path in sources if f'"{PROJECT["version"]}"' in path.read_text(encoding="utf-8")] == []


def test_the_hooks_before_a_commit_are_those_of_make_lint() -> None:
    [local] = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    hooks = {hook["entry"].split()[0].removeprefix(".venv/bin/") for hook in local["hooks"]}
    recipe = re.search(r"^lint:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert recipe is not None
    assert hooks == set(re.findall(r"\$\(BIN\)/([\w-]+)", recipe[1]))


def test_no_document_or_message_installs_this_project_by_its_name_from_a_registry() -> None:
    texts = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "scenarios").rglob("*.py")]
    by_name = re.compile(r"pip install[^\n#]*(?<![./\w-])" + re.escape(PROJECT["name"]))
    assert [path for path in texts if by_name.search(path.read_text(encoding="utf-8"))] == []
