"""Quantiles of a stream, beside numpy's of all numbers at once."""

from contextlib import closing

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenarios.studies.sweep import quantiles
from scenarios.studies.sweep.quantiles import Column

LEVELS = (0.0, 0.05, 0.5, 0.95, 1.0)

numbers = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False, width=64, min_value=-1e300, max_value=1e300),
    st.sampled_from([0.0, -0.0, 0.155, 0.155 * (1.0 + 2e-16), 5e-324, -5e-324]),
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(values=st.lists(numbers, min_size=1, max_size=40), levels=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4))
def test_they_are_numpys_to_the_last_bit_whatever_fits_into_memory(
    monkeypatch: pytest.MonkeyPatch, values: list[float], levels: list[float]
) -> None:
    monkeypatch.setattr(quantiles, "BUFFER", 8)
    with closing(Column()) as column:
        for value in values:
            column.add(value)
        assert column.quantiles(levels) == tuple(np.quantile(np.array(values), levels).tolist())
        assert len(column) == len(values)


def test_numbers_that_share_all_but_their_last_digits_are_told_apart() -> None:
    values = 0.155 + np.random.default_rng(0).integers(0, 1 << 20, 3 * quantiles.BUFFER // 2) * 2.0**-55
    with closing(Column()) as column:
        for value in values:
            column.add(value)
        assert column.quantiles(LEVELS) == tuple(np.quantile(values, LEVELS).tolist())


def test_of_no_numbers_there_are_none() -> None:
    assert Column().quantiles(LEVELS) is None
