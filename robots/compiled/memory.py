"""Arrays at addresses, for compiled functions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from robots.compiled.functions import Deferred, intrinsic


def _to_pointer(typing: Any, address: Any) -> Any:
    from numba import types

    def make(context: Any, builder: Any, signature: Any, values: Sequence[Any]) -> Any:
        return builder.inttoptr(values[0], context.get_value_type(types.voidptr))

    return types.voidptr(types.intp), make


def _array() -> Any:
    import numba

    return numba.carray  # type: ignore[attr-defined]


AT = intrinsic(_to_pointer)
"""``AT(address)``: a pointer."""

ARRAY = Deferred(_array)
"""``ARRAY(pointer, shape, dtype)``: what stands there."""
