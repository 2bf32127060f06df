"""The reference of the scenario file."""

from pathlib import Path

from scenarios.definition.keys import keys, markdown
from scenarios.definition.schema import Scenario


def test_every_key_says_what_it_means() -> None:
    assert [key.name for key in keys() if not key.meaning] == []


def test_every_key_of_the_schema_is_listed_with_its_default() -> None:
    found = {key.name: key for key in keys()}
    assert {name.split(".")[0].removesuffix("[]") for name in found} == set(Scenario.model_fields)
    assert found["robot.projection_distance_m"].default == "0.025"
    assert found["agents[].id"].default == "required"
    assert found["arena.walls"].default == "false"
    assert '"pymunk"' in found["plant.name"].kind


def test_the_reference_in_the_documents_is_current() -> None:
    page = Path(__file__).parents[3] / "docs" / "scenario-file.md"
    assert page.read_text(encoding="utf-8") == markdown(), "run `formation keys --markdown docs/scenario-file.md`"
