"""Exact quantiles of a stream of numbers, in memory that does not grow with it.

Numbers that do not fit into a buffer go to a file without a name, eight bytes each, which ends with the process. The
k-th smallest of them is found digit by digit: in one pass over the file for each 16 of its 64 bits, the numbers that
share all higher digits are counted by the next one. Read as unsigned integers, with the sign turned, floating-point
numbers are in the order of their values.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Sequence
from tempfile import TemporaryFile
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

BUFFER = 1 << 16
"""Numbers in memory."""

DIGIT = 16
"""Bits that one pass tells."""

_SIGN = np.uint64(1 << 63)
_ALL = np.uint64((1 << 64) - 1)


class Column:
    """Numbers, none of them NaN, that come one by one."""

    def __init__(self) -> None:
        self._buffer = array("d")
        self._file: BinaryIO | None = None
        self._written = 0

    def close(self) -> None:
        """Forget the numbers."""
        if self._file is not None:
            self._file.close()

    def __len__(self) -> int:
        return self._written + len(self._buffer)

    def add(self, value: float) -> None:
        """Take the next number."""
        self._buffer.append(value)
        if len(self._buffer) == BUFFER:
            if self._file is None:
                self._file = TemporaryFile()  # noqa: SIM115  closed with the column
            self._file.write(self._buffer.tobytes())
            self._written += BUFFER
            self._buffer = array("d")

    def quantiles(self, levels: Sequence[float]) -> tuple[float, ...] | None:
        """The same as ``np.quantile(numbers, levels)``, bit for bit; None of no numbers."""
        if not len(self):
            return None
        places = [(len(self) - 1) * level for level in levels]
        below = [int(np.floor(place)) for place in places]
        ranks = sorted({*below, *(min(rank + 1, len(self) - 1) for rank in below)})
        found = dict(zip(ranks, self._ranked(ranks), strict=True))
        return tuple(
            float(np.quantile([found[rank], found[min(rank + 1, len(self) - 1)]], place - rank))
            for rank, place in zip(below, places, strict=True)
        )

    def _ranked(self, ranks: Sequence[int]) -> list[float]:
        """The numbers of these ranks, 0 for the smallest."""
        known = [(0, rank) for rank in ranks]  # the digits so far, and the rank among those that share them
        for shift in range(64 - DIGIT, -1, -DIGIT):
            counts = {digits: np.zeros(1 << DIGIT, dtype=np.int64) for digits, _ in known}
            for codes in self._codes():
                higher = codes >> np.uint64(shift) >> np.uint64(DIGIT)
                digit = (codes >> np.uint64(shift)) & np.uint64((1 << DIGIT) - 1)
                for digits, count in counts.items():
                    count += np.bincount(digit[higher == np.uint64(digits)].astype(np.int64), minlength=1 << DIGIT)
            known = [_further(digits, rank, counts[digits]) for digits, rank in known]
        codes = np.array([digits for digits, _ in known], dtype=np.uint64)
        bits = np.where(codes & _SIGN, codes ^ _SIGN, codes ^ _ALL)
        return [float(value) for value in bits.view(np.float64)]

    def _codes(self) -> Iterator[NDArray[np.uint64]]:
        """All numbers, as integers in the same order."""
        if self._file is not None:
            self._file.seek(0)
            for _ in range(self._written // BUFFER):
                yield _codes(np.frombuffer(self._file.read(8 * BUFFER)))
        yield _codes(np.frombuffer(self._buffer))


def _codes(values: NDArray[np.float64]) -> NDArray[np.uint64]:
    bits = (values + 0.0).view(np.uint64)  # -0.0 becomes 0.0
    return np.where(bits & _SIGN, bits ^ _ALL, bits ^ _SIGN)


def _further(digits: int, rank: int, counts: NDArray[np.int64]) -> tuple[int, int]:
    """With the next digit, and the rank among those that share that too."""
    upto = np.cumsum(counts)
    digit = int(np.searchsorted(upto, rank, side="right"))
    return digits << DIGIT | digit, rank - int(upto[digit] - counts[digit])
