"""Programs: compiled functions whose machine code Python calls, with numba or without."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.compiled import compiled, kept
from robots.compiled.program import Program, program

Real = np.ndarray


class Inner(NamedTuple):
    flag: bool
    keys: np.ndarray


class Outer(NamedTuple):
    inner: Inner
    factor: float
    count: int
    signs: np.ndarray


@compiled
def _scaled(x: float, factor: float) -> float:
    return factor * x / 3.0


@program
def spread(table: Real, outer: Outer, shift: float, out: Real) -> None:
    """Uses every kind of argument, and another compiled function."""
    for row in range(table.shape[0]):
        for column in range(table.shape[1]):
            value = _scaled(table[row, column], outer.factor) + shift
            if outer.inner.flag:
                value -= np.float64(outer.inner.keys[row] >> np.uint64(63))
            out[row, column] = value * outer.signs[column] + outer.count
    out[0, 0] = out[0, 0] / 0.0 if outer.count == 7 else out[0, 0]


def by_hand(table: Real, outer: Outer, shift: float) -> Real:
    value = outer.factor * table / 3.0 + shift
    if outer.inner.flag:
        value = value - (outer.inner.keys >> np.uint64(63)).astype(float)[:, None]
    found: Real = value * outer.signs + outer.count
    return found


def outer(flag: bool = True, factor: float = 2.0, count: int = 1, rows: int = 3, columns: int = 2) -> Outer:
    keys = np.array([2**63 + 5, 5, 2**64 - 1], dtype=np.uint64)[:rows]
    return Outer(Inner(flag, keys), factor, count, np.array([1, -1], dtype=np.int32)[:columns])


@given(
    st.lists(st.floats(-1e300, 1e300), min_size=6, max_size=6),
    st.booleans(),
    st.floats(-1e3, 1e3),
    st.integers(-(2**31), 2**31),
    st.floats(-1e3, 1e3),
)
def test_a_program_computes_what_the_function_says_bit_for_bit(
    numbers: list[float], flag: bool, factor: float, count: int, shift: float
) -> None:
    table = np.array(numbers).reshape(3, 2)
    told, out = outer(flag, factor, count if count != 7 else 8), np.empty((3, 2))
    spread(table, told, shift, out)
    np.testing.assert_array_equal(out, by_hand(table, told, shift))


def test_named_tuples_that_change_their_arrays_are_read_anew_at_every_call() -> None:
    told, out = outer(), np.empty((3, 2))
    for _ in range(3):
        told.signs[:] *= -1
        spread(np.ones((3, 2)), told, 0.0, out)
        np.testing.assert_array_equal(out, by_hand(np.ones((3, 2)), told, 0.0))
    other = outer(factor=5.0)
    spread(np.ones((3, 2)), other, 0.0, out)
    np.testing.assert_array_equal(out, by_hand(np.ones((3, 2)), other, 0.0))


def test_shapes_may_change_from_call_to_call_and_a_division_by_zero_raises_nothing() -> None:
    for rows, columns in ((3, 2), (1, 1), (2, 2)):
        told, out = outer(count=7, rows=rows, columns=columns), np.empty((rows, columns))
        spread(np.ones((rows, columns)), told, 0.0, out)
        assert out[0, 0] == np.inf


def test_an_array_that_does_not_lie_in_one_piece_is_refused() -> None:
    with pytest.raises(ValueError, match=r"shape \(3, 2\) does not lie in one piece"):
        spread(np.ones((2, 3)).T, outer(), 0.0, np.empty((3, 2)))


@pytest.mark.parametrize("damage", ["flipped", "cut", "foreign"])
def test_machine_code_that_is_not_whole_or_not_of_here_is_made_anew(damage: str, tmp_path: Path) -> None:
    def copy_of(table: Real, out: Real) -> None:
        out[0] = table[0]

    first = Program(copy_of)
    first._places = [tmp_path]
    table, out = np.array([3.0]), np.zeros(1)
    first(table, out)
    (file,) = tmp_path.iterdir()
    whole = file.read_bytes()
    if damage == "foreign":
        code = kept.emitted(
            "declare i32 @elsewhere()\ndefine i32 @there() { %a = call i32 @elsewhere() ret i32 %a }", "there", "entry"
        )
        file.write_bytes(hashlib.sha256(code).digest() + code)
    else:
        file.write_bytes(whole[:-9] if damage == "cut" else whole[:-9] + bytes([whole[-9] ^ 1]) + whole[-8:])
    second = Program(copy_of)
    second._places = [tmp_path]
    out[0] = 0.0
    second(table, out)
    assert out[0] == 3.0
    assert kept.read([tmp_path], file.name) is not None
    third = Program(copy_of)
    third._places, third._compile = [tmp_path], None  # type: ignore[assignment, method-assign]
    third(table, out)  # by what the second one has kept


def test_a_full_disk_costs_the_machine_code_and_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("robots.compiled.kept.os.replace", full)
    kept.write([tmp_path / "full"], "code.o", b"code")
    assert list((tmp_path / "full").iterdir()) == []
    monkeypatch.undo()
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    kept.write([tmp_path / "file", tmp_path / "next"], "code.o", b"code")
    assert kept.read([tmp_path / "file", tmp_path / "next"], "code.o") == b"code"
    assert [path.name for path in (tmp_path / "next").iterdir()] == ["code.o"]


WITHOUT_NUMBA = """
import sys
from scenarios.definition.experiment import open_experiment
from scenarios.simulation.loop import simulate
simulate(open_experiment("shape", (), 0.2))
print("numba" in sys.modules, "llvmlite" in sys.modules)
"""


def test_a_run_whose_machine_code_is_kept_loads_no_numba() -> None:
    for _ in range(2):  # the first may have to compile
        done = subprocess.run([sys.executable, "-c", WITHOUT_NUMBA], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("False True\n", "")
