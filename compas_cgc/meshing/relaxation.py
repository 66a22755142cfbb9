"""Relaxation of plane triangulations to a size field, with edge flips and fixed points."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from .edge_flips import Diagonals
from .edge_flips import edges_with_counts
from .edge_flips import flipped
from .edge_flips import flipped_to_valence

__all__ = ["plane_angles", "relaxed"]

STEPS = 5
ROUNDS = 3
SPRING = 1.15  # natural length of an edge relative to the mean of the size field
RATE = 0.2
MIN_ANGLE = np.radians(24.0)  # least angle after a valence flip
TURNS = np.arange(8) * np.pi / 4
# Steps (24, 2) of the search for a better place of a point, relative to the nearest point.
SEARCH = np.concatenate([0.3 * share * np.column_stack([np.cos(TURNS), np.sin(TURNS)]) for share in (1.0, 0.5, 0.25)])

Sizes = Callable[[FloatArray], FloatArray]


def relaxed(plan: FloatArray, faces: IntArray, held: Mask, kept: IntArray, sizes: Sizes) -> tuple[FloatArray, IntArray]:
    """Return relaxed points (n, 2) and triangles (m, 3).

    Edges act as compressed springs (Persson and Strang 2004) and are flipped to a Delaunay triangulation; finally they are
    flipped towards valence 6 where the angles allow it.

    Parameters
    ----------
    plan
        ``(n, 2)`` [L].
    faces
        ``(m, 3)`` triangles, counterclockwise.
    held
        ``(n,)`` mask of fixed points.
    kept
        ``(k, 2)`` fixed edges; boundary edges are always fixed.
    sizes
        Function from points (k, 2) to edge lengths (k,) [L].

    References
    ----------
    Persson and Strang, doi:10.1137/S0036144503429121.
    """
    constraint = np.sort(kept, axis=1) @ np.array([len(plan), 1]) if len(kept) else np.empty(0, np.int64)
    for _ in range(STEPS):
        plan, _ = _pushed(plan, faces, held, sizes)
        faces = _delaunay(plan, faces, constraint)
    for _ in range(ROUNDS):
        faces = _evened(plan, faces, constraint)
        for _ in range(STEPS):
            plan, _ = _pushed(plan, faces, held, sizes)
    plan = _rounded(plan, faces, held)
    return plan, faces


def plane_angles(plan: FloatArray, faces: IntArray) -> FloatArray:
    """Return the angles (m, 3) of triangles [rad]."""
    return _angles(plan[faces])


def _angles(corners: FloatArray) -> FloatArray:
    """Return the angles (..., 3) of triangles by their corners (..., 3, 2) [rad]."""
    a, b = corners[..., (1, 2, 0), :] - corners, corners[..., (2, 0, 1), :] - corners
    return np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def _pushed(plan: FloatArray, faces: IntArray, held: Mask, sizes: Sizes) -> tuple[FloatArray, float]:
    """Return the points after a step, and the longest step relative to the edge length."""
    u, v = edges_with_counts(faces)[0].T
    bar = plan[v] - plan[u]
    length = np.linalg.norm(bar, axis=1)
    wanted = sizes(0.5 * (plan[u] + plan[v]))
    wanted = wanted * SPRING * np.sqrt((length**2).sum() / (wanted**2).sum())
    force = (np.maximum(wanted - length, 0.0) / np.maximum(length, 1e-300))[:, None] * bar
    push = np.zeros_like(plan)
    np.add.at(push, v, force)
    np.add.at(push, u, -force)
    push[held] = 0.0
    new = _not_turned(plan, plan + RATE * push, faces)
    return new, float((np.linalg.norm(new - plan, axis=1) / sizes(plan)).max(initial=0.0))


def _not_turned(plan: FloatArray, new: FloatArray, faces: IntArray) -> FloatArray:
    """Return new points; points that would invert a triangle keep their old positions."""
    new = new.copy()
    for _ in range(10):
        turned = faces[(plane_angles(new, faces) <= np.radians(2.0)).any(axis=1)]
        if not len(turned):
            return new
        new[turned.ravel()] = plan[turned.ravel()]
    return plan


def _rounded(plan: FloatArray, faces: IntArray, held: Mask) -> FloatArray:
    """Return points with those at poor triangles moved to maximise the smallest angle around them."""
    plan = plan.copy()
    around: dict[int, list[int]] = {}
    for f, face in enumerate(faces.tolist()):
        for i in face:
            around.setdefault(i, []).append(f)
    for _ in range(8):
        worst = plane_angles(plan, faces).min(axis=1)
        poor = np.unique(faces[worst < np.radians(34.0)])
        moved = False
        for i in poor[~held[poor]].tolist():
            own = faces[around[i]]
            corners, is_own = plan[own], own == i
            best, at = _angles(corners).min(), plan[i]
            steps = SEARCH * np.linalg.norm(corners[~is_own] - at, axis=1).min()
            while len(steps):
                # The first place that is better is the centre of the rest of the search.
                places = at + steps
                tried = np.where(is_own[..., None], places[:, None, None], corners)
                smallest = _angles(tried).min(axis=(1, 2))
                first = int(np.argmax(smallest > best + 1e-6))
                if not smallest[first] > best + 1e-6:
                    break
                best, at, moved, steps = smallest[first], places[first], True, steps[first + 1 :]
            plan[i] = at
        if not moved:
            break
    return plan


def _delaunay(plan: FloatArray, faces: IntArray, constraint: IntArray) -> IntArray:
    """Return triangles after flips of edges whose opposite angles add up to more than π."""
    return flipped(plan, faces, constraint, lambda e: _angle(plan, e.c, e.a, e.b) + _angle(plan, e.d, e.a, e.b) - np.pi - 1e-9)


def _angle(plan: FloatArray, at: IntArray, one: IntArray, other: IntArray) -> FloatArray:
    x, y = plan[one] - plan[at], plan[other] - plan[at]
    return np.arctan2(np.abs(x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]), (x * y).sum(axis=1))


def _evened(plan: FloatArray, faces: IntArray, constraint: IntArray) -> IntArray:
    """Return triangles after flips towards valence 6 that leave no small angles."""

    def allowed(_: IntArray, e: Diagonals) -> Mask:
        return np.asarray(np.minimum(*(plane_angles(plan, pair).min(axis=1) for pair in e.turned())) > MIN_ANGLE)

    return flipped_to_valence(len(plan), faces, constraint, allowed)
