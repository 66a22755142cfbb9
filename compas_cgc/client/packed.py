"""Packed arrays in JSON, ten times as fast as lists of numbers."""

from __future__ import annotations

import base64
import gc
import math
import sys
from array import array
from collections.abc import Iterator
from collections.abc import Sequence
from contextlib import contextmanager
from itertools import chain
from typing import Any
from typing import Protocol
from typing import Union
from typing import runtime_checkable

__all__ = ["Array", "Rows", "pack", "unpack"]

KINDS = {"f8": "d", "i4": "i"}


@runtime_checkable
class Array(Protocol):
    """Interface of NumPy arrays used by the client, which does not require NumPy."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of rows and columns."""
        ...

    @property
    def dtype(self) -> Any:
        """Type of the numbers."""
        ...

    def __len__(self) -> int:
        """Return the number of rows."""
        ...

    def astype(self, dtype: str, /) -> Any:
        """Return the array with numbers of another type."""
        ...

    def tolist(self) -> Any:
        """Return lists of Python numbers."""
        ...


Rows = Union[Array, Sequence[Sequence[float]]]
"""Rows of numbers: an array or lists."""


def pack(rows: Rows, kind: str, width: int) -> dict:
    """Return rows of `width` numbers as ``{"base64": ..., "type": "f8" or "i4", "shape": [n, width]}``.

    Raises
    ------
    TypeError, ValueError, OverflowError
        If the rows do not have `width` numbers each.
    """
    count = len(rows)
    if isinstance(rows, Array):
        if rows.shape != (count, width) or (kind == "i4" and rows.dtype.kind not in "iu"):
            raise ValueError(f"not {width} numbers each")
        content = rows.astype("<" + kind).tobytes()
    else:
        tuples = [tuple(row) for row in rows]
        if any(len(row) != width for row in tuples):
            raise ValueError(f"not {width} numbers each")
        values = array(KINDS[kind], chain.from_iterable(tuples))
        if sys.byteorder == "big":
            values.byteswap()
        content = values.tobytes()
    return {"base64": base64.b64encode(content).decode("ascii"), "type": kind, "shape": [count, width]}


def unpack(value: object) -> object:
    """Return a packed array as lists, with None for NaN and infinity; other values unchanged."""
    if not isinstance(value, dict) or set(value) != {"base64", "type", "shape"}:
        return value
    values = array(KINDS[value["type"]])
    values.frombytes(base64.b64decode(value["base64"]))
    if sys.byteorder == "big":
        values.byteswap()
    if len(value["shape"]) == 1:
        return values.tolist() if all(map(math.isfinite, values)) else [x if math.isfinite(x) else None for x in values]
    with _no_collection():
        return list(map(list, zip(*[iter(values)] * value["shape"][1])))


@contextmanager
def _no_collection() -> Iterator[None]:
    """Disable the garbage collector within a block that creates thousands of lists."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()
