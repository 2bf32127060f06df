"""Seeds as a person writes them."""

from itertools import islice

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.errors import InputError
from scenarios.studies.sweep.seeds import LONGEST_NAME, parse_seeds

gaps_and_sizes = st.lists(st.tuples(st.integers(0, 5), st.integers(1, 5)), min_size=1, max_size=5)


@given(gaps_and_sizes, st.randoms(use_true_random=False))
def test_a_list_of_ranges_and_single_seeds_runs_in_its_own_order(parts: list[tuple[int, int]], random) -> None:
    ranges, end = [], 0
    for gap, size in parts:
        ranges.append(range(end + gap, end + gap + size))
        end = ranges[-1].stop
    random.shuffle(ranges)
    seeds = parse_seeds(", ".join(f"{r.start}:{r.stop}" if len(r) > 1 else f" {r.start}" for r in ranges))
    wanted = [seed for r in ranges for seed in r]
    assert list(seeds) == wanted
    assert (seeds.count, seeds.first) == (len(wanted), wanted[0])
    assert list(parse_seeds(str(seeds))) == wanted
    for done in range(len(wanted) + 1):
        assert list(seeds.after(done)) == wanted[done:]


@pytest.mark.parametrize("text", ["3:3", "4:3", "-1:3", "a:b", "1:2:3", "", "1,", ",1", "1.5", "1;2", "9" * 19, "0x3"])
def test_what_is_no_seed_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"--seeds .*: expected A:B"):
        parse_seeds(text)


@pytest.mark.parametrize(("text", "twice"), [("1,1", 1), ("0:5,3", 3), ("3,0:5", 3), ("0:9,4:6", 4), ("4:6,0:9", 4)])
def test_a_seed_that_comes_twice_is_refused_by_its_number(text: str, twice: int) -> None:
    with pytest.raises(InputError, match=f"the seed {twice} is listed twice"):
        parse_seeds(text)


def test_a_million_million_million_seeds_cost_nothing() -> None:
    seeds = parse_seeds("0:999999999999999999,999999999999999999")
    assert seeds.count == 10**18
    assert list(islice(seeds.after(10**18 - 2), 3)) == [10**18 - 2, 10**18 - 1]


def test_a_name_stays_short() -> None:
    assert parse_seeds("0:3").in_a_name == "0-2"
    assert parse_seeds("1,5,7:9").in_a_name == "1+5+7-8"
    assert len(parse_seeds(",".join(map(str, range(0, 200, 2)))).in_a_name) <= LONGEST_NAME + 3
