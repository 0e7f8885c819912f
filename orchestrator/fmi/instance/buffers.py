"""Values between the master's float buffers and the typed arrays of an FMU.

One block for each FMI type: references, a typed staging array, and the places of its elements
in the buffer. A lone block of scalar doubles in order needs no staging: the FMU then reads and
writes the buffer itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from ...errors import InstanceFailure
from ..description import EXACT, Variable
from .base import Values

DTYPES: dict[str, Any] = {
    "Real": np.float64,
    "Integer": np.int32,
    "Float64": np.float64,
    "Float32": np.float32,
    "Int8": np.int8,
    "UInt8": np.uint8,
    "Int16": np.int16,
    "UInt16": np.uint16,
    "Int32": np.int32,
    "UInt32": np.uint32,
    "Int64": np.int64,
    "UInt64": np.uint64,
}
WIDE = ("Int64", "UInt64", "Enumeration")

Binder = Callable[[str, list[int], Any], Callable[[], int]]
"""Makes a call without arguments from an FMI type, value references and a typed array."""


class Block:
    """Variables of one FMI type that are passed together; arrays are passed whole.

    `begin` is where each reference starts in the staging array; `buffer` and `places` pair
    the elements in use with their places in the master's buffer.
    """

    def __init__(self, kind: str, entries: list[tuple[int, Variable]], dtype: Any) -> None:
        self.kind = kind
        self.begin: dict[int, int] = {}
        size = 0
        for _, v in entries:
            if v.reference not in self.begin:
                self.begin[v.reference] = size
                size += v.extent
        self.staging = np.zeros(size, dtype=dtype)
        self.buffer = np.array([index for index, _ in entries], dtype=np.intp)
        self.places = np.array([self.begin[v.reference] + v.element for _, v in entries])

    def preset(self, variables: Iterable[Variable], start: Mapping[str, float | str]) -> None:
        """Fill all elements of arrays with start values, also those that no wire reaches."""
        for v in variables:
            if v.reference in self.begin and v.extent > 1:
                value = start.get(v.name, v.start)
                self.staging[self.begin[v.reference] + v.element] = float(value or 0.0)

    def take(self, numbers: Values) -> None:
        """Stage numbers; for whole types the nearest whole one."""
        whole = self.staging.dtype.kind != "f"
        self.staging[self.places] = np.rint(numbers) if whole else numbers

    def plain(self, dtype: Any, count: int) -> bool:
        """Whether the FMU may work on the buffer itself."""
        whole = len(self.buffer) == count == len(self.staging)
        return whole and dtype == np.float64 and bool((self.places == np.arange(count)).all())


def is_too_wide(block: Block) -> bool:
    """Whether a block that has been read holds a whole number that no double holds."""
    if block.kind not in WIDE:
        return False
    found = block.staging[block.places]
    return max(int(found.max()), -int(found.min())) > EXACT


def too_wide(kind: str) -> str:
    """What is wrong with a whole number of some type that no double holds."""
    return f"an output of type {kind} is beyond 2^53: no double holds it"


def blocks(variables: list[Variable], dtypes: Mapping[str, Any]) -> list[Block]:
    """Variables of a buffer sorted into blocks by type."""
    kinds: dict[str, list[tuple[int, Variable]]] = {}
    for index, variable in enumerate(variables):
        kinds.setdefault(variable.kind, []).append((index, variable))
    return [Block(kind, entries, dtypes[kind]) for kind, entries in kinds.items()]


def writer(made: list[Block], values: Values, bind: Binder) -> Callable[[], int]:
    """Call that passes the buffer to the FMU."""
    if not made:
        return _nothing
    if len(made) == 1 and made[0].plain(made[0].staging.dtype, len(values)):
        return bind(made[0].kind, list(made[0].begin), values)
    calls = [(b, bind(b.kind, list(b.begin), b.staging)) for b in made]

    def write() -> int:
        worst = 0
        for block, call in calls:
            block.take(values[block.buffer])
            worst = max(worst, call())
        return worst

    return write


def reader(name: str, made: list[Block], values: Values, bind: Binder) -> Callable[[], int]:
    """Call that fills the buffer from the FMU.

    Raises `InstanceFailure`, with the name of the instance, on a whole number that no double holds.
    """
    if not made:
        return _nothing
    if len(made) == 1 and made[0].plain(made[0].staging.dtype, len(values)):
        return bind(made[0].kind, list(made[0].begin), values)
    calls = [(b, bind(b.kind, list(b.begin), b.staging)) for b in made]

    def read() -> int:
        worst = 0
        for block, call in calls:
            worst = max(worst, call())
            found = block.staging[block.places]
            if is_too_wide(block):
                raise InstanceFailure(f"{name}: {too_wide(block.kind)}")
            values[block.buffer] = found
        return worst

    return read


def _nothing() -> int:
    return 0
