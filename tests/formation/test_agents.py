"""Agent numbers and array rows."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formation import agents


@given(st.lists(st.integers(1, 10**6)))
def test_rows_and_numbers_are_inverse_to_each_other(given_numbers: list[int]) -> None:
    assert agents.numbers(agents.rows(given_numbers)).tolist() == given_numbers


def test_the_leader_is_agent_1_and_the_first_follower_agent_2() -> None:
    assert [agents.number(row) for row in (agents.LEADER, agents.FIRST_FOLLOWER, agents.FIRST_ORDINARY)] == [1, 2, 3]


def test_a_name_carries_the_number_and_not_the_row() -> None:
    assert agents.name(2) == "agent 3"
    assert agents.name(np.intp(0)) == "agent 1"
