"""Cache of what was last computed from a mesh.

Studies and servers solve many problems on one small mesh, one after the other. Results for a larger mesh are kept during
one solve only, which needs them repeatedly.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from collections.abc import Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any
from typing import Optional
from typing import TypeVar
from typing import cast

import numpy as np
from scipy import sparse

__all__ = ["remembered", "remembering"]

# arguments above which a result is kept during a solve only [bytes]; a mesh of 20,000 vertices with roles and creases
MAX_BYTES = 2_000_000
TOTAL = 2  # bytes of the arguments of all results kept for a function over MAX_BYTES; a large mesh and its predecessor
MAX_RESULTS = 8  # results kept for each function; the meshes of a search and its coarser one
MAX_SOLVE_BYTES = 20_000_000  # arguments above which nothing is kept during a solve either [bytes]; saves memory

Function = TypeVar("Function", bound=Callable[..., Any])


class _OfSolve(threading.local):
    """Results kept by this thread during a solve, by function and numbers of arguments."""

    kept: Optional[dict[tuple, Any]] = None
    seen: list[tuple[str, tuple[int, ...], np.ndarray]] = []  # the numbered arrays: type, shape and bytes


_of_solve = _OfSolve()


@contextmanager
def remembering() -> Iterator[None]:
    """Keep results for larger meshes until the end of a block."""
    if _of_solve.kept is not None:
        yield
        return
    _of_solve.kept, _of_solve.seen = {}, []
    try:
        yield
    finally:
        _of_solve.kept, _of_solve.seen = None, []


def remembered(function: Function, recent: int = MAX_RESULTS, largest: int = MAX_BYTES) -> Function:
    """Return a function that caches its last results; they may depend on its arguments only, arrays and numbers.

    Arrays in results are copied, so that the caller may change them. Of arguments with more bytes than the `largest` they are kept during
    a solve only.
    """
    kept: OrderedDict[tuple, Any] = OrderedDict()
    sizes: dict[tuple, int] = {}
    lock = threading.Lock()

    @wraps(function)
    def called(*args: Any) -> Any:
        size = sum(own.nbytes for own in args if isinstance(own, np.ndarray))
        if size > largest:
            return _large(function, size, args)
        key = tuple((own.dtype.char, own.shape, own.tobytes()) if isinstance(own, np.ndarray) else own for own in args)
        with lock:
            found = kept.get(key)
            if found is not None:
                kept.move_to_end(key)
        if found is None:
            found = (function(*args),)
            with lock:
                kept[key], sizes[key] = found, size
                while len(kept) > recent or sum(sizes.values()) > TOTAL * largest:
                    del sizes[kept.popitem(last=False)[0]]
        return _copied(found[0])

    return cast(Function, called)


def _large(function: Callable[..., Any], size: int, args: tuple) -> Any:
    kept = _of_solve.kept
    if kept is None or size > MAX_SOLVE_BYTES:
        return function(*args)
    key = function, *(_number(own) if isinstance(own, np.ndarray) else own for own in args)
    if key not in kept:
        kept[key] = function(*args)
    return _copied(kept[key])


def _number(array: np.ndarray) -> int:
    """Return the number of an array among those of this solve; comparing two arrays is much faster than a digest."""
    char, shape, own = array.dtype.char, array.shape, np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    for number, (other, extent, bytes_) in enumerate(_of_solve.seen):
        if other == char and extent == shape and np.array_equal(bytes_, own):
            return number
    _of_solve.seen.append((char, shape, own.copy()))
    return len(_of_solve.seen) - 1


def _copied(value: Any) -> Any:
    if isinstance(value, np.ndarray) or sparse.issparse(value):
        return value.copy()
    if isinstance(value, list):
        return [_copied(own) for own in value]
    if isinstance(value, tuple):
        copies = [_copied(own) for own in value]
        return type(value)(*copies) if hasattr(value, "_fields") else tuple(copies)
    return value
