"""The fast part of the fuzzer; ``make fuzz`` runs the whole."""

from pathlib import Path

import pytest

from tests.fuzz.cases import try_case
from tests.fuzz.drive import quick

FAST = {"scenario": 30, "run": 20, "option": 15}


@pytest.mark.parametrize(("kind", "number"), [(kind, number) for kind, n in FAST.items() for number in range(n)])
def test_whatever_the_input_a_command_ends_in_order_and_refuses_in_one_line(
    kind: str, number: int, tmp_path: Path
) -> None:
    with quick():
        arguments, wrong = try_case(kind, number, tmp_path)
    assert wrong is None, f"formation {arguments}\n{wrong}"
