"""Roofs that a quarter turn about a vertical axis takes to themselves, and patterns of pieces that it takes to themselves."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..meshing import boundary_loops
from ..meshing.closest_points import feet_on_polyline
from ..model.problem import CGCProblem
from .patchwork import Patchwork

__all__ = ["centre_of", "is_fourfold", "middles_of", "turned_pieces", "turns_onto_itself"]

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
TOLERANCE = 0.01  # distance of a turned surface from itself, relative to its size, as pieces of meshes without symmetry differ
MATCH = 0.25  # distance of the middle of a turned piece from that of another, relative to the size of the piece


def turns_onto_itself(problem: CGCProblem) -> bool:
    """Return whether a quarter turn takes a surface, its edges, creases and targets to themselves, whatever its triangles are."""
    V, F = problem.vertices, problem.faces
    used = np.unique(F)
    centre = centre_of(problem)
    points = V[used] - centre
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    turned = points @ TURN.T
    distance, near = cKDTree(points).query(turned)
    edge = float(np.median(np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1)))
    normals, targets = vertex_normals(V, F)[used], np.where(problem.asked, problem.targets, np.nan)[used]
    off = np.abs(np.einsum("ij,ij->i", turned - points[near], normals[near]))
    other = ~(np.isnan(targets) | np.isnan(targets[near]) | np.isclose(targets, targets[near]))
    if distance.max() > edge or off.max() > TOLERANCE * size or other.any():
        return False
    paths = [np.append(loop, loop[0]) for loop in boundary_loops(F)], problem.crease_paths()
    return all(_on_lines([V[path] - centre for path in own], TOLERANCE * size) for own in paths)


def is_fourfold(middles: FloatArray, sizes: FloatArray, centre: FloatArray) -> bool:
    """Return whether a quarter turn about a centre (2,) takes pieces with middles (k, 2) and sizes (k,) to one another [L]."""
    arms = middles - centre
    distance, near = cKDTree(arms).query(arms @ TURN[:2, :2].T)
    return bool((distance <= MATCH * sizes).all() and len(np.unique(near)) == len(near))


def middles_of(own: Patchwork) -> tuple[FloatArray, FloatArray]:
    """Return the middles in plan (k, 2) and the sizes (k,) of the pieces of a patchwork [L]."""
    corners, count = own.space[own.faces], int(own.piece.max()) + 1
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    whole, middles = np.bincount(own.piece, areas, count), corners.mean(axis=1)
    return np.stack([np.bincount(own.piece, areas * middles[:, k], count) / whole for k in range(2)], axis=1), np.sqrt(whole)


def turned_pieces(own: Patchwork, problem: CGCProblem) -> dict[int, tuple[int, FloatArray]]:
    """Return the pieces of a roof onto which a quarter turn, or several, take an earlier piece.

    Returns
    -------
    dict
        For such a piece the earlier one, and the rotation ``(2, 2)`` that takes its place in the plane to that of the later one.
    """
    if not turns_onto_itself(problem):
        return {}
    centre = centre_of(problem)
    faces, plane = own.space[own.faces].mean(axis=1) - centre, own.plane.mean(axis=1)
    middles, sizes = middles_of(own)
    arms = middles - centre[:2]
    found: dict[int, tuple[int, FloatArray]] = {}
    for piece in range(len(arms)):
        turn = np.eye(3)
        for _ in range(3):
            turn = TURN @ turn
            off = np.linalg.norm(arms[:piece] @ turn[:2, :2].T - arms[piece], axis=1)
            before = [k for k in np.flatnonzero(off <= MATCH * sizes[piece]).tolist() if k not in found]
            if before and piece not in found:
                first, second = own.piece == before[0], own.piece == piece
                near = cKDTree(faces[second]).query(faces[first] @ turn.T)[1]
                found[piece] = before[0], _rotation(plane[first], plane[second][near])
    return found


def _rotation(points: FloatArray, images: FloatArray) -> FloatArray:
    """Return the rotation (2, 2) of the rigid motion that takes points (k, 2) nearest to their images (k, 2)."""
    a, b = points - points.mean(axis=0), images - images.mean(axis=0)
    cosine, sine = float((a * b).sum()), float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    return np.array([[cosine, -sine], [sine, cosine]]) / np.hypot(cosine, sine)


def centre_of(problem: CGCProblem) -> FloatArray:
    """Return the middle in plan of the box around a surface, at height 0 (3,)."""
    points = problem.vertices[np.unique(problem.faces)]
    return np.array([1.0, 1.0, 0.0]) * 0.5 * (points.min(axis=0) + points.max(axis=0))


def _on_lines(lines: list[FloatArray], reach: float) -> bool:
    """Return whether a quarter turn about the origin takes polylines (k, 3) onto one another."""
    if not lines:
        return True
    turned = np.concatenate(lines) @ TURN.T
    away = np.min([np.linalg.norm(feet_on_polyline(turned, line)[0] - turned, axis=1) for line in lines], axis=0)
    return bool(away.max() <= reach)
