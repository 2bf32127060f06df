"""From a name, a path and changes to a validated scenario."""

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.definition.files.library import describe_library
from scenarios.definition.load import LIBRARY, find, library, load
from scenarios.errors import InputError, did_you_mean

SHAPE = (LIBRARY / "shape.toml").read_text(encoding="utf-8")


def test_the_library_is_the_folder() -> None:
    assert library() == sorted(path.stem for path in LIBRARY.iterdir() if path.suffix == ".toml")
    assert "shape" in library()


@pytest.mark.parametrize("name", library())
def test_every_scenario_of_the_library_says_what_it_is(name: str) -> None:
    file = load(name)
    assert file.name == name
    assert file.scenario.title
    assert file.description


def test_a_name_is_looked_up_in_the_library_and_a_path_is_itself(tmp_path: Path) -> None:
    assert find("shape") == LIBRARY / "shape.toml"
    path = tmp_path / "mine.toml"
    path.write_text(SHAPE, encoding="utf-8")
    assert load(str(path)).scenario == load("shape").scenario
    assert load(str(path)).name == "mine"


def test_the_digest_follows_the_meaning_and_not_the_spelling(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("# another comment\n" + SHAPE.replace("60.0", "60"), encoding="utf-8")
    assert load(str(path)).sha256 == load("shape").sha256
    assert load("shape", ["duration_s=61"]).sha256 != load("shape").sha256


@pytest.mark.parametrize(
    ("change", "look"),
    [
        ("plant.name=saturated", lambda s: s.plant.name == "saturated"),
        ('plant.name="saturated"', lambda s: s.plant.name == "saturated"),
        ("duration_s = 12.5", lambda s: s.duration_s == 12.5),
        ("agents.3.start=[0.1, 0.2]", lambda s: s.agents[2].start == (0.1, 0.2)),
        ("agents.6.heading_deg=-90", lambda s: s.agents[5].heading_deg == -90.0),
        ("arena.walls=true", lambda s: s.arena.walls),
        ("target.angles_deg={}", lambda s: s.target.angles_deg == {}),
        ("title=a = b", lambda s: s.title == "a = b"),
    ],
)
def test_a_change_reaches_its_key(change: str, look: object) -> None:
    assert look(load("shape", [change]).scenario)  # type: ignore[operator]


def test_the_last_of_two_changes_of_one_key_counts() -> None:
    assert load("shape", ["duration_s=1", "duration_s=2"]).scenario.duration_s == 2.0


@given(st.text(max_size=30))
def test_any_text_as_a_change_is_taken_or_refused_as_bad_input(change: str) -> None:
    with contextlib.suppress(InputError):
        load("shape", [change])


@given(st.text(max_size=12), st.text(max_size=12))
def test_any_value_for_any_key_is_taken_or_refused_as_bad_input(key: str, value: str) -> None:
    for place in (f"plant.{key}", f"agents.3.{key}", "agents.3.start", "target.angles_deg"):
        with contextlib.suppress(InputError):
            load("shape", [f"{place}={value}"])


@pytest.mark.parametrize(
    ("name", "expected"),
    [("shpae", "did you mean 'shape'?"), ("zzz", "known: alpha, shape"), ("", "known: alpha, shape")],
)
def test_a_misspelt_name_gets_the_nearest_or_all(name: str, expected: str) -> None:
    assert did_you_mean(name, ["alpha", "shape"]) == expected


def test_a_younger_key_changes_the_digest_only_where_it_is_given() -> None:
    assert load("shape").sha256 == load("shape", ("goal.accepted=false",)).sha256
    assert load("shape").sha256 != load("shape", ("goal.accepted=true",)).sha256


LONG = "0x" + "f" * 6000
"""An integer that Python refuses to print."""


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (f"agents.3.start={LONG}", "agents[id 3].start"),
        (f"agents.3.start=[0, {LONG}]", "agents[id 3].start[2]"),
        (f"agents.3.id={LONG}", "agents[id 3].id"),
        (f"target.angles_deg={{a={LONG}}}", "target.angles_deg.a"),
        (f"goal={{unknown=[[{LONG}]]}}", "goal.unknown[1][1]"),
        ("random_formation={agents=5, seed=9223372036854775808}", "random_formation.seed"),
    ],
)
def test_an_integer_of_more_than_64_bits_is_refused_by_its_place_wherever_it_stands(change: str, field: str) -> None:
    with pytest.raises(InputError) as refusal:
        load("shape", (change,))
    assert str(refusal.value).startswith(f"shape: {field}: expected an integer of at most 64 bits, got one of ")
    assert len(str(refusal.value)) < 150


def test_what_is_read_of_a_scenario_without_the_schema_is_what_it_says() -> None:
    for told in describe_library():
        scenario = load(told["scenario"]).scenario
        formation = scenario.random_formation
        assert told == {
            "scenario": told["scenario"],
            "agents": len(scenario.agents) if formation is None else formation.agents,
            "duration_s": scenario.duration_s or sum(phase.duration_s for phase in scenario.phases),
            "plant": scenario.plant.name,
            "title": scenario.title,
        }
