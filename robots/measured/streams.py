"""Random numbers of the measured robots: streams of their own, so that nominal runs draw what they always drew."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]

_BLOCK = 64  # periods drawn at once: a call per period and run would cost more than the robots


class Streams:
    """One stream per run, spawned from the run's generator, which draws nothing by that.

    Args:
        generators: of the runs.
        batch: () for one run, (runs,) for several.
        robots: n.
        normals: per robot and period.
        uniforms: likewise.
    """

    def __init__(
        self,
        generators: Sequence[np.random.Generator],
        batch: tuple[int, ...],
        robots: int,
        normals: int,
        uniforms: int,
    ) -> None:
        self._streams = [generator.spawn(1)[0] for generator in generators]
        self._batch, self._robots, self._widths = batch, robots, (normals, uniforms)
        self._next = _BLOCK
        self._normals, self._uniforms = np.empty(0), np.empty(0)

    def once(self, width: int) -> Real:
        """(..., n, width) standard normal draws."""
        return self._stacked([stream.standard_normal((1, self._robots, width)) for stream in self._streams])[0]

    def period(self) -> tuple[Real, Real]:
        """The next period's standard normal (..., n, normals) and uniform (..., n, uniforms) draws."""
        if self._next == _BLOCK:
            normals, uniforms = ((_BLOCK, self._robots, width) for width in self._widths)
            self._normals = self._stacked([stream.standard_normal(normals) for stream in self._streams])
            self._uniforms = self._stacked([stream.random(uniforms) for stream in self._streams])
            self._next = 0
        row, self._next = self._next, self._next + 1
        return self._normals[row], self._uniforms[row]

    def _stacked(self, blocks: list[Real]) -> Real:
        """Blocks (periods, n, width), one a run, as (periods, ..., n, width)."""
        return np.stack(blocks, axis=1).reshape(len(blocks[0]), *self._batch, *blocks[0].shape[1:])
