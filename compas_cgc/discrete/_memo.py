"""Memory of what was last worked out from small meshes: studies and servers solve many problems on one mesh, one after the other."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from typing import Any
from typing import TypeVar
from typing import cast

import numpy as np
from scipy import sparse

__all__ = ["remembered"]

SMALL = 2_000_000  # bytes of arguments above which nothing is kept: those of a mesh of 20,000 vertices with roles and creases
ALL = 4_000_000  # bytes of the arguments of all that is kept
RECENT = 8  # results of each function

Function = TypeVar("Function", bound=Callable[..., Any])


def remembered(function: Function, recent: int = RECENT) -> Function:
    """Return a function that keeps its last results for small arguments: arrays and numbers that alone decide what it returns.

    What it returns belongs to the caller: arrays are copied.
    """
    kept: OrderedDict[tuple, Any] = OrderedDict()
    sizes: dict[tuple, int] = {}
    lock = threading.Lock()

    @wraps(function)
    def called(*args: Any) -> Any:
        size, key = _key(args)
        if size > SMALL:
            return function(*args)
        with lock:
            found = kept.get(key)
            if found is not None:
                kept.move_to_end(key)
        if found is None:
            found = (function(*args),)
            with lock:
                kept[key], sizes[key] = found, size
                while len(kept) > recent or sum(sizes.values()) > ALL:
                    del sizes[kept.popitem(last=False)[0]]
        return _copied(found[0])

    return cast(Function, called)


def _key(args: tuple) -> tuple[int, tuple]:
    """Return the bytes of the arguments, and what tells them from others where these are few."""
    size = sum(own.nbytes for own in args if isinstance(own, np.ndarray))
    if size > SMALL:
        return size, ()
    return size, tuple((own.dtype.char, own.shape, own.tobytes()) if isinstance(own, np.ndarray) else own for own in args)


def _copied(value: Any) -> Any:
    if isinstance(value, np.ndarray) or sparse.issparse(value):
        return value.copy()
    if isinstance(value, list):
        return [_copied(own) for own in value]
    if type(value) is tuple:
        return tuple(_copied(own) for own in value)
    return value
