"""Arrays as bytes in JSON, which takes a tenth of the time of lists of numbers."""

from __future__ import annotations

import base64
import math
import sys
from array import array
from collections.abc import Sequence
from itertools import chain

__all__ = ["pack", "unpack"]

KINDS = {"f8": "d", "i4": "i"}


def pack(rows: Sequence[Sequence[float]], kind: str, width: int) -> dict:
    """Return rows of `width` numbers as ``{"base64": ..., "type": "f8" or "i4", "shape": [n, width]}``.

    Raises
    ------
    TypeError, ValueError, OverflowError
        If they are no such rows.
    """
    count = len(rows)
    if hasattr(rows, "astype"):
        if rows.shape != (count, width) or (kind == "i4" and rows.dtype.kind not in "iu"):
            raise ValueError(f"not {width} numbers each")
        content = rows.astype("<" + kind).tobytes()
    else:
        rows = [tuple(row) for row in rows]
        if any(len(row) != width for row in rows):
            raise ValueError(f"not {width} numbers each")
        values = array(KINDS[kind], chain.from_iterable(rows))
        if sys.byteorder == "big":
            values.byteswap()
        content = values.tobytes()
    return {"base64": base64.b64encode(content).decode("ascii"), "type": kind, "shape": [count, width]}


def unpack(value: object) -> object:
    """Return a packed array as lists, with None for what is no number, and anything else as it is."""
    if not isinstance(value, dict) or set(value) != {"base64", "type", "shape"}:
        return value
    values = array(KINDS[value["type"]])
    values.frombytes(base64.b64decode(value["base64"]))
    if sys.byteorder == "big":
        values.byteswap()
    if len(value["shape"]) == 1:
        return [x if math.isfinite(x) else None for x in values]
    return list(map(list, zip(*[iter(values)] * value["shape"][1])))
