"""Validation of the numbers and polylines of goals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any
from typing import Union

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.plan import flattened
from ..given import checked_number

__all__ = ["ALL", "FREE_EDGES", "Vertices", "check_finite", "check_positive", "in_plan"]

ALL = "all"
FREE_EDGES = "free"
Vertices = Union[str, Sequence[int]]


def in_plan(points: Any, name: str, fewest: int) -> FloatArray:
    """Return points (p, 3) with z = 0, without the last one if it repeats the first.

    Raises
    ------
    ValueError
        If they are not finite points of two or three numbers, or too few.
    """
    try:
        given = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        given = np.empty((0, 0))
    if given.ndim != 2 or given.shape[-1] not in (2, 3) or not np.isfinite(given).all():
        raise ValueError(f"{name} must be finite points of two or three numbers, not of shape {given.shape}")
    flat = flattened(given)
    if len(flat) > fewest and np.array_equal(flat[0], flat[-1]):
        flat = flat[:-1]
    if len(flat) < fewest or not np.ptp(flat, axis=0).any():
        raise ValueError(f"{name} must be {fewest} or more different points")
    return flat


def check_finite(value: float, name: str) -> None:
    if not math.isfinite(checked_number(value, name)):
        raise ValueError(f"{name} must be a number, not {value!r}")


def check_positive(value: float, name: str) -> None:
    if not 0.0 < checked_number(value, name) < math.inf:
        raise ValueError(f"{name} must be a positive number, not {value!r}")
