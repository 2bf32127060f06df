"""Chipmunk, stepped from compiled code: its bodies are read and written without a Python object for each call.

pymunk's ``batch`` module calls C functions that fill and read arrays. They are called here by their addresses, with
arrays that are made once. The names that this takes are private to pymunk and stand in this file alone; what comes of
them is, bit for bit, what the public way gives. Nothing here knows what the bodies are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.compiled import compiled, intrinsic
from robots.compiled.memory import ARRAY, AT
from robots.worlds.protocol import NOTHING, UnsupportedVersionError

if TYPE_CHECKING:
    import pymunk

Real = NDArray[np.float64]
Index = NDArray[np.int64]

FUNCTIONS = (
    "cpSpaceStep",
    "cpSpaceEachBody",
    "cpSpaceEachCachedArbiter",
    "pmSpaceBodyGetIteratorFuncBatched",
    "pmSpaceBodySetIteratorFuncBatched",
    "pmSpaceArbiterIteratorFuncBatched",
)
"""What is called, in the order of the first fields of :class:`Bodies`."""

ADDRESSES = len(FUNCTIONS) + 4
"""How many fields of :class:`Bodies` are addresses."""

ROOM = ("pmFloatArrayNew", "pmFloatArrayFree", "pmIntArrayNew", "pmIntArrayFree")

BODY_X, BODY_Y, BODY_ANGLE, BODY_VX, BODY_VY, BODY_SPIN = range(6)
"""Columns of what is read of a body; its speeds are the last three."""


class Bodies(NamedTuple):
    """A space whose first n bodies are watched, by addresses and by the arrays that its C functions fill and read.

    Attributes:
        step, each_body, each_touch, read, write, touch: addresses of :data:`FUNCTIONS`.
        space, reading, writing, touching: addresses of what they are given.
        written_count: (1,) how much of ``command`` is given.
        read_count, read_place, touch_count, touch_place: (1,) how many numbers C found about bodies and contacts, and
            where they are: it keeps the room for them itself, and moves it when it grows.
        state: (B, 6) of all B bodies: x, y, angle, their speeds.
        command: (B, 3) speeds that bodies are given.
        numbers, rows: (n,) ids of the watched bodies, ascending, and which of them each is.
        touched: (n,) whom each touches: the least row; n for what is not watched; :data:`NOTHING`.
    """

    step: int
    each_body: int
    each_touch: int
    read: int
    write: int
    touch: int
    space: int
    reading: int
    writing: int
    touching: int
    written_count: NDArray[np.int32]
    read_count: NDArray[np.int32]
    read_place: Index
    touch_count: NDArray[np.int32]
    touch_place: Index
    state: Real
    command: Real
    numbers: Index
    rows: Index
    touched: Index


def no_bodies() -> Bodies:
    """In the place of bodies where there is no space; its address is 0."""
    count, place = np.zeros(1, np.int32), np.zeros(0, np.int64)
    room = count, count, place, count, place, np.zeros((0, 6)), np.zeros((0, 3)), place, place, place
    return Bodies._make([*[0] * ADDRESSES, *room])


def bodies_of(space: pymunk.Space, watched: Sequence[pymunk.Body]) -> tuple[Bodies, list[Any]]:
    """The bodies of a space, those watched first, as they are, and what must live as long as they are used.

    Raises:
        UnsupportedVersionError: this version of pymunk lacks what is needed; the message says what.
    """
    from pymunk import batch

    ffi, lib = _library()

    def address(name: str) -> int:
        return int(ffi.cast("intptr_t", ffi.addressof(lib, name)))

    count = len(space.bodies) + 1  # the static body of walls and obstacles is visited too, last
    state, command = np.zeros((count, 6)), np.zeros((count, 3))
    fields, seen = batch.BodyFields, batch.Buffer()
    batch.get_space_bodies(space, fields.POSITION | fields.ANGLE | fields.VELOCITY | fields.ANGULAR_VELOCITY, seen)
    known = np.frombuffer(seen.float_buf())  # without the static body, where nothing is on it
    state.ravel()[: len(known)] = known
    written = ffi.new("pmFloatArray *", {"num": 0, "max": command.size})
    written.arr = ffi.cast("cpFloat *", command.ctypes.data)
    found = ffi.gc(lib.pmFloatArrayNew(state.size), lib.pmFloatArrayFree)
    touching = ffi.gc(lib.pmIntArrayNew(0), lib.pmIntArrayFree)
    speeds = lib.VELOCITY | lib.ANGULAR_VELOCITY
    asked = (
        (found, lib.POSITION | lib.ANGLE | speeds),
        (written, speeds),
        (found, lib.BODY_A_ID | lib.BODY_B_ID),
    )
    given = [
        ffi.new("pmBatchedData *", {"intArray": touching, "floatArray": reals, "fields": chosen})
        for reals, chosen in asked
    ]

    def field(array: Any, name: str, kind: type[np.integer[Any]]) -> NDArray[Any]:
        return np.frombuffer(ffi.buffer(ffi.addressof(array[0], name)), kind)

    numbers = np.array([body.id for body in watched], dtype=np.int64)
    order = np.argsort(numbers)
    parts = [
        *(address(name) for name in FUNCTIONS),
        *(int(ffi.cast("intptr_t", thing)) for thing in (space._space, *given)),
        field(written, "num", np.int32),
        *(field(array, *part) for array in (found, touching) for part in (("num", np.int32), ("arr", np.int64))),
        state,
        command,
        numbers[order],
        order.astype(np.int64),
        np.full(len(numbers), NOTHING, dtype=np.int64),
    ]
    return Bodies._make(parts), [space, written, found, touching, *given]


def _library() -> tuple[Any, Any]:
    """pymunk's ``ffi`` and ``lib``, with all that is taken from them."""
    import pymunk

    try:
        from pymunk._chipmunk_cffi import ffi, lib
    except ImportError as error:
        raise UnsupportedVersionError(f"pymunk {pymunk.version} has no _chipmunk_cffi: expected 7.1 to 7.3") from error
    for name in (*FUNCTIONS, *ROOM):
        if not hasattr(lib, name):
            raise UnsupportedVersionError(f"pymunk {pymunk.version} has no function {name}: expected 7.1 to 7.3")
    return ffi, lib


@compiled
def observe(bodies: Bodies) -> None:
    """Read the state of all bodies, and whom those that are watched touch."""
    bodies.read_count[0] = bodies.touch_count[0] = 0
    _visit(bodies.each_body, bodies.space, bodies.read, bodies.reading)
    _visit(bodies.each_touch, bodies.space, bodies.touch, bodies.touching)
    columns, read = bodies.state.shape[1], bodies.read_count[0]
    numbers = ARRAY(AT(bodies.read_place[0]), read, np.float64)
    for place in range(read):
        bodies.state[place // columns, place % columns] = numbers[place]
    touched, n = bodies.touched, len(bodies.touched)
    touched[:] = NOTHING
    found = bodies.touch_count[0]
    ids = ARRAY(AT(bodies.touch_place[0]), found, np.int64)
    for place in range(0, found, 2):
        one, other = _row(bodies, ids[place]), _row(bodies, ids[place + 1])
        if one < n and (touched[one] == NOTHING or other < touched[one]):
            touched[one] = other
        if other < n and (touched[other] == NOTHING or one < touched[other]):
            touched[other] = one


@compiled
def drive(bodies: Bodies, steps: int, dt: float) -> None:
    """Give all bodies their commands, let so many steps of dt seconds pass, and observe."""
    bodies.written_count[0] = 0
    _visit(bodies.each_body, bodies.space, bodies.write, bodies.writing)
    for _ in range(steps):
        _step(bodies.step, bodies.space, dt)
    observe(bodies)


@compiled
def _row(bodies: Bodies, number: int) -> int:
    """Which of the watched bodies has a number; their count for one that is not watched."""
    low, high = 0, len(bodies.numbers)
    while low < high:
        middle = (low + high) // 2
        if bodies.numbers[middle] < number:
            low = middle + 1
        else:
            high = middle
    known = low < len(bodies.numbers) and bodies.numbers[low] == number
    return bodies.rows[low] if known else len(bodies.numbers)


def _call(context: Any, builder: Any, signature: Any, values: Sequence[Any]) -> Any:
    """Call the C function at the address ``values[0]`` with the rest of the values."""
    from numba import types

    kind = types.ExternalFunctionPointer(types.void(*signature.args[1:]), int)
    function = builder.inttoptr(values[0], context.get_value_type(kind))
    context.call_function_pointer(builder, function, values[1:])
    return context.get_dummy_value()


def _to_visit(typing: Any, each: Any, space: Any, function: Any, data: Any) -> Any:
    from numba import types

    return types.void(types.intp, types.intp, types.intp, types.intp), _call


def _to_step(typing: Any, step: Any, space: Any, dt: Any) -> Any:
    from numba import types

    return types.void(types.intp, types.intp, types.float64), _call


_visit = intrinsic(_to_visit)  # each(space, function, data), all of them addresses
_step = intrinsic(_to_step)  # step(space, dt)
