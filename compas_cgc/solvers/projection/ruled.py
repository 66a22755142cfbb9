"""The surface of straight lines between two held curves: what a vault of K = 0 sets out from."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.laplacian import cotangent_laplacian
from ...discrete.normals import unit_vectors
from ...linalg import factorise
from ...meshing import boundary_loops
from ...model.tolerances import NEGLIGIBLE
from .system import System

__all__ = ["ruled"]


def ruled(system: System, vertices: FloatArray) -> Optional[FloatArray]:
    """Return the shape (n, 3) that straight lines between two held curves span.

    Each curve is walked along its chord, and lines join what lies equally far along both: arches of one form span a cylinder.

    Parameters
    ----------
    system
        The problem.
    vertices
        ``(n, 3)`` the drawing.

    Returns
    -------
    (n, 3) float64 or None
        None unless exactly two open stretches of one rim are held, which both go on along their chords.
    """
    sides = _sides(system)
    if sides is None:
        return None
    first, left, second, right = sides
    second = second[::-1]
    along = [share for share in (_along_chord(vertices[curve]) for curve in (first, second)) if share is not None]
    if len(along) < 2:
        return None
    a, b, c = (vertices[system.faces[:, k]] for k in range(3))
    facing = unit_vectors(np.cross(b - a, c - a).sum(axis=0, keepdims=True))
    # In plan, where linear functions are harmonic.
    laplacian = cotangent_laplacian(vertices - (vertices @ facing.T) * facing, system.faces)
    between, across = np.full(len(vertices), np.nan), np.full(len(vertices), np.nan)
    between[first], between[second] = 0.0, 1.0
    across[left], across[right] = 1.0, 0.0
    for curve, share in zip((first, second), along):
        across[curve] = share
    used = np.unique(system.faces)
    s, t = (_harmonic(laplacian, vertices, values, used) for values in (across, between))
    ends = [np.column_stack([np.interp(s, share, vertices[curve, k]) for k in range(3)]) for curve, share in zip((first, second), along)]
    shape = vertices.copy()
    shape[system.columns] = ((1.0 - t)[:, None] * ends[0] + t[:, None] * ends[1])[system.columns]
    return shape


def _sides(system: System) -> Optional[tuple[IntArray, IntArray, IntArray, IntArray]]:
    """Return the sides of a mesh in turn, held, free, held and free; None where it has not these alone."""
    loops = boundary_loops(system.faces)
    held = np.ones(int(system.faces.max()) + 1, bool)
    held[system.columns] = False
    if len(loops) != 1 or held[np.setdiff1d(system.faces, loops[0])].any():
        return None
    loop = np.asarray(loops[0])
    starts = np.flatnonzero(held[loop] != held[np.roll(loop, 1)])
    if len(starts) != 4:
        return None
    loop = np.roll(loop, -int(starts[0] if held[loop[starts[0]]] else starts[1]))
    changes = np.flatnonzero(held[loop] != held[np.roll(loop, 1)])
    first, left, second, right = np.split(loop, changes[1:])
    return (first, left, second, right) if min(len(first), len(second)) > 1 else None


def _along_chord(curve: FloatArray) -> Optional[FloatArray]:
    """Return how far along its chord a curve (k, 3) is, from 0 to 1, None where it goes back."""
    chord = curve[-1] - curve[0]
    length = float(chord @ chord)
    if length == 0.0:
        return None
    share = (curve - curve[0]) @ chord / length
    return share if (np.diff(share) > NEGLIGIBLE).all() else None


def _harmonic(laplacian: sparse.csr_matrix, vertices: FloatArray, known: FloatArray, used: IntArray) -> FloatArray:
    """Return the harmonic function (n,) with some values (n,), NaN where there is none."""
    free = used[np.isnan(known[used])]
    given = used[~np.isnan(known[used])]
    result = np.where(np.isnan(known), 0.0, known)
    rows = laplacian[free]
    solver = factorise(rows[:, free].tocsr(), symmetric=True, points=vertices[free], refine=False)
    result[free] = -solver.solve(rows[:, given] @ known[given])
    return result
