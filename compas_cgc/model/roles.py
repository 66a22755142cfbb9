"""Roles of vertices: internal, fixed, crease, free, dummy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Union

import numpy as np

from ..discrete import boundary_vertices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["CREASE", "DUMMY", "FIXED", "FREE", "INTERNAL", "ROLES", "role_numbers", "roles_by_place"]

ROLES = ("internal", "fixed", "crease", "free", "dummy")
INTERNAL, FIXED, CREASE, FREE, DUMMY = range(len(ROLES))


def role_numbers(roles: Iterable[Union[int, str]], n: int) -> IntArray:
    """Return roles given as names or numbers as indices into :data:`ROLES` (n,).

    Raises
    ------
    ValueError
        If there is not one role for each of `n` vertices, or a role is unknown.
    """
    given = np.asarray(roles if isinstance(roles, np.ndarray) else list(roles))
    if given.shape != (n,):
        raise ValueError(f"roles must be one per vertex ({n}), not an array of shape {given.shape}")
    if given.dtype.kind in "iu":
        numbers = given.astype(np.int64)
    else:
        numbers = np.array([ROLES.index(role) if role in ROLES else -1 for role in given.tolist()], dtype=np.int64)
    wrong = np.flatnonzero((numbers < 0) | (numbers >= len(ROLES)))
    if len(wrong):
        raise ValueError(f"the role of vertex {wrong[0]} must be one of {', '.join(ROLES)}, not {given[wrong[0]]!r}")
    return np.ascontiguousarray(numbers)


def roles_by_place(vertices: FloatArray, faces: IntArray, roles: IntArray, creases: IntArray) -> IntArray:
    """Return the roles with those of vertices neither fixed nor dummy set by position: crease, free or internal (n,).

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    roles
        ``(n,)`` present roles; fixed and dummy vertices keep theirs.
    creases
        ``(c, 2)`` crease edges.
    """
    creased = np.zeros(len(roles), bool)
    creased[creases] = True
    place = np.where(creased, CREASE, np.where(boundary_vertices(vertices, faces), FREE, INTERNAL))
    return np.where((roles == FIXED) | (roles == DUMMY), roles, place)
