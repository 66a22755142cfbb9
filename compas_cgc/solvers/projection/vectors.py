"""Products of vectors that are too short for threads."""

from __future__ import annotations

import math

import numpy as np

from ...discrete.arrays import FloatArray

__all__ = ["dot", "norm"]


def dot(one: FloatArray, other: FloatArray) -> float:
    """Return the product of two vectors (n,).

    BLAS starts its threads for vectors of a mesh's length, which costs more than the
    product, and a hundredfold more where the cores are busy.
    """
    return float(np.einsum("i,i", one, other))


def norm(vector: FloatArray) -> float:
    """Return the length of a vector (n,)."""
    return math.sqrt(dot(vector, vector))
