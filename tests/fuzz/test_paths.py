"""The fast part of ``python -m tests.fuzz.paths``."""

import pytest

from tests.fuzz.paths import difference


@pytest.mark.parametrize("number", range(16))
def test_the_compiled_period_and_the_loop_in_python_make_one_run_of_a_random_scenario(number: int) -> None:
    assert difference(number) is None
