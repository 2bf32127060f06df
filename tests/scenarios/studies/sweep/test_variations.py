"""The values of ``--vary``, taken apart without loss."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.errors import InputError
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import open_study
from scenarios.studies.sweep.variations import Variation, combinations, parse_variations

VALUES = st.one_of(
    st.integers().map(str),
    st.floats(allow_nan=False).map(repr),
    st.lists(st.lists(st.integers().map(str)).map(", ".join).map("[{}]".format)).map(", ".join).map("[{}]".format),
    st.text("a,]}[{' ").map('"{}"'.format),
    st.sampled_from(["pymunk", "true", "'a, b'", '{name = "a,b", duration_s = [1, 2]}']),
)


@given(st.lists(VALUES, min_size=1, unique=True))
def test_a_list_of_toml_values_comes_apart_into_these_values(values: list[str]) -> None:
    assert parse_variations([f"some.key={', '.join(values)}"]) == (Variation("some.key", tuple(values)),)


@given(st.lists(st.integers(1, 4), max_size=4))
def test_combinations_are_all_different_and_as_many_as_the_product(sizes: list[int]) -> None:
    variations = [Variation(f"k{i}", tuple(map(str, range(size)))) for i, size in enumerate(sizes)]
    found = combinations(variations)
    product = 1
    for size in sizes:
        product *= size
    assert len(set(found)) == len(found) == product
    assert found == sorted(found)


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["a"], "expected KEY=V1,V2"),
        (["=1"], "expected KEY=V1,V2"),
        (["a="], "expected KEY=V1,V2"),
        (["a=1,,2"], "expected KEY=V1,V2"),
        (["a=1,"], "expected KEY=V1,V2"),
        (["a=1,2, 1"], "the value 1 is listed twice"),
        (["a=1", "a=2"], "--vary a: is varied twice"),
        (["b.c=1"], "--vary b.c: is set to one value too"),
    ],
)
def test_what_is_no_variation_is_refused(texts: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        parse_variations(texts, ["b.c=3"])


def test_a_change_that_cannot_be_made_is_told_by_the_option_that_asked_for_it() -> None:
    [varied] = parse_variations(["agents.9.start=[0, 1],[0, 2]"])
    with pytest.raises(InputError, match=r"^--vary agents\.9\.start=\[0, 1\]: no entry 9"):
        open_study("shape", (), [varied], parse_seeds("0:1"))
    [plant] = parse_variations(["plant.name=saturated,unicycle"])
    with pytest.raises(InputError, match=r"^--set agents\.9\.start=\[0, 1\]: no entry 9"):
        open_study("shape", ("agents.9.start=[0, 1]",), [plant], parse_seeds("0:1"))
