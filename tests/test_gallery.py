"""The gallery says what the library and its baselines say."""

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

from scenarios.definition.load import library, load
from scenarios.studies.check import baseline

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture(scope="module")
def gallery() -> dict[str, Any]:
    return runpy.run_path(str(DOCS / "gallery.py"))


def test_the_page_is_what_the_library_and_the_baselines_make_of_it(gallery: dict[str, Any]) -> None:
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == gallery["page"](), "`make gallery` writes it"


def test_every_scenario_has_a_picture_and_every_picture_a_scenario() -> None:
    assert sorted(path.stem for path in (DOCS / "images" / "gallery").iterdir()) == library()


def test_a_number_that_changes_changes_the_page(
    gallery: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = baseline.path_of("shape", baseline.FOLDER)
    content = json.loads(path.read_text(encoding="utf-8"))
    for run in content["runs"]:
        run["numbers"]["settling_time_s"] = [12.345, 0.1]
    (tmp_path / path.name).write_text(json.dumps(content), encoding="utf-8")
    monkeypatch.setattr(baseline, "FOLDER", tmp_path)
    assert gallery["entry"]("shape").count("| 12.3 |") == sum(run["seed"] == 0 for run in content["runs"])


@pytest.mark.parametrize("name", library())
def test_the_words_begin_as_the_file_does_and_name_the_law(gallery: dict[str, Any], name: str) -> None:
    head = load(name).description
    words = gallery["words"](head)
    assert words.startswith(head.split(".")[0].split("\n")[0])
    assert ("*Law*:" in words) == ("\nLaw " in head)
