"""Decoding of JSON from clients. Limits are checked before the JSON is parsed.

An array is a list, or packed: ``{"base64": ..., "type": "f8" or "i4", "shape": [...]}``, little-endian.
"""

from __future__ import annotations

import base64
import binascii
import json
import math
from collections.abc import Iterable
from contextlib import suppress
from typing import Any
from typing import Optional
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ..errors import BadRequest
from ..errors import TooLarge
from ..errors import Unprocessable
from ..limits import Limits

__all__ = [
    "LARGEST",
    "are_numbers",
    "check_length",
    "check_size",
    "corner_counts",
    "is_light",
    "number",
    "packed",
    "polygons",
    "read_json",
    "vertex_array",
    "whole",
    "whole_text",
]

Polygons = Union[IntArray, list[list[int]]]

LARGEST = 1e12  # upper limit of coordinates and curvatures; its cube does not overflow
DIGITS = 300
_NESTING = frozenset((list, dict))
_DIGITS_ALIKE = bytes.maketrans(b"123456789", 9 * b"0")
LIGHT = 20_000  # number of JSON values that are parsed within milliseconds
PACK = "use a coarser mesh, or send vertices and faces packed"
PACKED = {"f8": "<f8", "i4": "<i4"}


def read_json(body: bytes, limits: Limits) -> Any:
    """Parse JSON.

    Raises
    ------
    BadRequest
        If it is not JSON in UTF-8, names NaN or Infinity, or is nested too deeply.
    TooLarge
        If it exceeds a limit of the server.
    """
    try:
        _check_counts(body, limits)
        value = json.loads(body.decode("utf-8-sig"), parse_constant=_refuse, parse_int=whole_text if _has_long_number(body) else None)
        if b"\\u" in body:
            json.dumps(value, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        raise BadRequest("the JSON holds half of a surrogate pair (such as \\ud800 alone), which is not valid text; correct it") from None
    except UnicodeDecodeError:
        raise BadRequest("the request is not UTF-8 text; send JSON") from None
    except RecursionError:
        raise BadRequest(f"the JSON is nested more than {limits.depth} levels deep") from None
    except ValueError as error:
        raise BadRequest(f"the request is not valid JSON: {str(error)[:120]}") from None
    level = [value]
    for _ in range(limits.depth):
        level = [item for node in level for item in _inner(node)]
        if not level:
            return value
    raise BadRequest(f"the JSON is nested more than {limits.depth} levels deep")


def is_light(body: bytes, limits: Limits) -> bool:
    """Check whether JSON is fast to parse: short, or a few long strings such as packed arrays."""
    return len(body) <= limits.light and body.count(b",") + body.count(b":") <= LIGHT


def _has_long_number(body: bytes) -> bool:
    """Check whether there are more consecutive digits than a finite number has, without parsing the numbers."""
    return DIGITS * b"0" in body.translate(_DIGITS_ALIKE)


def check_length(length: Optional[int], limits: Limits) -> None:
    """Check the declared length of JSON against the limit, before the JSON is read.

    Raises
    ------
    TooLarge
    """
    if length is not None and length > limits.json:
        raise TooLarge(f"the JSON has {length / 2**20:.0f} MB; the server accepts at most {limits.json / 2**20:.0f} MB; {PACK}")


def _check_counts(body: bytes, limits: Limits) -> None:
    """Check the number of values and containers in JSON before it is parsed, to limit memory."""
    check_length(len(body), limits)
    if body.count(b"[") + body.count(b"{") > limits.containers:
        raise TooLarge(f"the JSON holds more than {limits.containers} lists and objects; use a coarser mesh")
    names = body.count(b":")
    if names + body.count(b",") > limits.values or 2 * names > limits.values:
        raise TooLarge(f"the JSON holds more than {limits.values} values or {limits.values // 2} keys; {PACK}")


def _inner(node: object) -> Iterable:
    """Return the lists and objects in a list or object."""
    items = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    # Fast path: most lists hold numbers only.
    return () if _NESTING.isdisjoint(map(type, items)) else [item for item in items if type(item) in _NESTING]


def vertex_array(value: object, limits: Limits) -> FloatArray:
    """Return the vertices (n, 3) [L] in a list of triples of numbers or in a packed array."""
    if isinstance(value, dict):
        value = _unpacked(value, "'vertices'")
    elif not isinstance(value, list):
        value = []
    if not len(value):
        raise Unprocessable("'vertices' must be a list of at least three [x, y, z]")
    if len(value) > limits.vertices:
        raise TooLarge(f"the mesh has {len(value)} vertices; the server accepts at most {limits.vertices}; use a coarser mesh")
    array: np.ndarray = np.empty(0)
    with suppress(ValueError):
        array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iuf":
        raise Unprocessable("'vertices' must be a list of [x, y, z], three numbers each")
    array = array.astype(np.float64)
    bad = ~(np.abs(array) <= LARGEST).all(axis=1)
    if bad.any():
        raise Unprocessable(f"vertex {int(np.argmax(bad))} has a coordinate that is not finite or exceeds {LARGEST:g}; correct it")
    return array


def polygons(value: object, count: int, limits: Limits) -> Polygons:
    """Return the faces in a list of lists or a packed array, as indices of `count` vertices."""
    if isinstance(value, dict):
        value = _unpacked(value, "'faces'")
    elif not isinstance(value, list):
        value = []
    if not len(value):
        raise Unprocessable("'faces' must be a list of at least one face, each a list of vertex indices")
    if len(value) > limits.faces:
        raise TooLarge(f"the mesh has {len(value)} faces; the server accepts at most {limits.faces}; use a coarser mesh")
    if isinstance(value, np.ndarray):
        if value.ndim != 2 or value.shape[1] != 3:
            raise Unprocessable("'faces' as a packed array must have the shape [m, 3]; send polygons as lists")
        flat = value.ravel()
    else:
        wrong = next((i for i, face in enumerate(value) if not isinstance(face, list) or not 3 <= len(face) <= 1000), None)
        if wrong is not None:
            raise Unprocessable(f"face {wrong} must be a list of three or more vertex indices")
        try:
            flat = np.array([v for face in value for v in face])
        except ValueError:
            flat = np.empty(0)
    if flat.ndim != 1 or flat.dtype.kind not in "iu":
        raise Unprocessable("'faces' must hold integers only, the indices of vertices counted from 0")
    if flat.min() < 0 or flat.max() >= count:
        from_one = "; these faces count from 1, so subtract 1 from all indices" if flat.min() == 1 and flat.max() == count else ""
        wrong = int(flat.max() if flat.max() >= count else flat.min())
        raise Unprocessable(f"a face refers to vertex {wrong}, but there are {count} vertices, counted from 0{from_one}")
    return value


def corner_counts(faces: Polygons) -> tuple[IntArray, IntArray, IntArray]:
    """Return the corners of all faces (k,), the number of corners of each face (m,), and the number of distinct ones (m,)."""
    packed_triangles = isinstance(faces, np.ndarray)
    sizes = np.full(len(faces), 3) if packed_triangles else np.array([len(face) for face in faces])
    flat = np.asarray(faces if packed_triangles else [v for face in faces for v in face], dtype=np.int64).ravel()
    if (sizes == 3).all():
        triangles = flat.reshape(-1, 3)
        return flat, sizes, np.where((triangles != np.roll(triangles, 1, axis=1)).all(axis=1), 3, 2)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    order = np.lexsort((flat, owner))
    new = np.ones(len(flat), bool)
    new[1:] = (np.diff(flat[order]) != 0) | (np.diff(owner) != 0)
    return flat, sizes, np.bincount(owner[new], minlength=len(sizes))


def packed(values: np.ndarray) -> dict:
    """Return an array of numbers in packed form."""
    kind = "i4" if values.dtype.kind in "iu" else "f8"
    content = np.ascontiguousarray(values, dtype=PACKED[kind]).tobytes()
    return {"base64": base64.b64encode(content).decode("ascii"), "type": kind, "shape": list(values.shape)}


def _unpacked(value: dict, what: str) -> np.ndarray:
    text, kind, shape = value.get("base64"), value.get("type"), value.get("shape", ())
    good = isinstance(shape, list) and 0 < len(shape) < 3 and all(isinstance(k, int) and 0 <= k < 2**31 for k in shape)
    if not isinstance(text, str) or kind not in PACKED or not good:
        raise Unprocessable(f'{what} as a packed array must be {{"base64": ..., "type": "f8" or "i4", "shape": [...]}}')
    try:
        content = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        raise Unprocessable(f"{what} is not valid base64") from None
    array_kind = np.dtype(PACKED[kind])
    if len(content) != array_kind.itemsize * math.prod(shape):
        raise Unprocessable(f"{what} has {len(content)} bytes, which do not match its shape {shape}")
    return np.frombuffer(content, dtype=array_kind).reshape(shape)


def check_size(vertices: int, faces: int, limits: Limits) -> None:
    """Check the number of vertices and faces against the limits.

    Raises
    ------
    TooLarge
    """
    if vertices > limits.vertices or faces > limits.faces:
        most = f"{limits.vertices} vertices and {limits.faces} faces"
        raise TooLarge(f"the mesh has {vertices} vertices and {faces} faces; the server accepts at most {most}; use a coarser mesh")


def number(value: object, what: str) -> float:
    """Return a number after checking that it is finite and at most :data:`LARGEST`."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise Unprocessable(f"{what} must be a number")
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise Unprocessable(f"{what} must be a finite number of at most {LARGEST:g}")
    return float(value)


def are_numbers(values: list) -> bool:
    """Check whether all values are None or numbers that :func:`number` accepts; ten times as fast as one by one."""
    if not set(map(type, values)) <= {float, int, type(None)}:
        return False
    known = [value for value in values if value is not None]
    # NaN can pass the comparison of minimum and maximum, but makes the sum NaN, which differs from itself.
    return not known or (-LARGEST <= min(known) and max(known) <= LARGEST and sum(known) == sum(known))


def whole(value: object, what: str) -> int:
    """Return an integer; integral floats such as 3.0 are accepted."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != value or abs(value) > LARGEST or int(value) != value:
        raise Unprocessable(f"{what} must be an integer")
    return int(value)


def _refuse(name: str) -> None:
    raise ValueError(f"{name} is not a number in JSON")


def whole_text(text: str) -> int:
    """Return the integer that a string of digits stands for, if a float can hold it."""
    if len(text) > DIGITS:
        raise ValueError("a number has too many digits")
    return int(text)
