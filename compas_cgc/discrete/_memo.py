"""Memory of what was last worked out from small meshes: studies and servers solve many problems on one mesh, one after the other."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from typing import Any
from typing import Optional
from typing import TypeVar
from typing import cast

import numpy as np
from scipy import sparse

__all__ = ["remembered"]

SMALL = 400_000  # bytes of arguments above which nothing is kept
RECENT = 8  # results of each function

Function = TypeVar("Function", bound=Callable[..., Any])


def remembered(function: Function) -> Function:
    """Return a function that keeps its last results for small arguments: arrays and numbers that alone decide what it returns.

    What it returns belongs to the caller: arrays are copied.
    """
    kept: OrderedDict[tuple, Any] = OrderedDict()
    lock = threading.Lock()

    @wraps(function)
    def called(*args: Any) -> Any:
        key = _key(args)
        if key is None:
            return function(*args)
        with lock:
            found = kept.get(key)
            if found is not None:
                kept.move_to_end(key)
        if found is None:
            found = (function(*args),)
            with lock:
                kept[key] = found
                if len(kept) > RECENT:
                    kept.popitem(last=False)
        return _copied(found[0])

    return cast(Function, called)


def _key(args: tuple) -> Optional[tuple]:
    """Return what tells arguments from others, None where they are too large."""
    size, key = 0, []
    for own in args:
        if isinstance(own, np.ndarray):
            size += own.nbytes
            if size > SMALL:
                return None
            key.append((own.dtype.char, own.shape, own.tobytes()))
        else:
            key.append(own)
    return tuple(key)


def _copied(value: Any) -> Any:
    if isinstance(value, np.ndarray) or sparse.issparse(value):
        return value.copy()
    if isinstance(value, list):
        return [_copied(own) for own in value]
    if type(value) is tuple:
        return tuple(_copied(own) for own in value)
    return value
