"""Mesh cleanup: welding, triangulation and orientation, with notes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Union

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from .orient import orient
from .triangulate import triangulate
from .weld import clean_faces
from .weld import split_quads
from .weld import weld

__all__ = ["Omission", "Tidy", "mean_edge", "quad_array", "tidy"]

VERTICES, FACES = ("vertex", "vertices"), ("face", "faces")


class Omission(str):
    """A note on contents of a file that were left out."""


@dataclass(frozen=True)
class Tidy:
    """A clean triangle mesh."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    index: IntArray  # (n_old,) new index of every old vertex, -1 if removed
    owner: IntArray  # (m,) old face that contains each face
    notes: list[str]


def tidy(vertices: FloatArray, faces: Union[IntArray, Sequence[Sequence[int]]], tolerance: float, unit: str = "") -> Tidy:
    """Weld vertices, triangulate polygons, drop degenerate faces and unify orientations.

    A clean mesh is returned unchanged.

    Parameters
    ----------
    vertices
        ``(n, 3)`` finite coordinates [L].
    faces
        ``(m, 3)`` or ``(m, 4)`` vertex indices, where a triangle among quads repeats a
        corner; or a list of polygons.
    tolerance
        Distance within which vertices are merged [L], limited to 1 % of the mean edge
        length.
    unit
        Text after lengths in the notes.

    Raises
    ------
    MeshError
        If no face remains.
    """
    quads, whose, polygons = quad_array(vertices, faces)
    notes = []
    used = np.zeros(len(vertices), bool)
    used[quads] = True
    edge = mean_edge(vertices, quads)
    reach = min(tolerance, 0.01 * edge)
    if tolerance > edge > 0.0:
        far = f"the welding distance of {tolerance:.3g}{unit} is longer than the mean edge of the mesh, {edge:.3g}{unit}"
        notes.append(f"{far}; {reach:.3g}{unit} was used instead; check the unit of the distance")
    welded = weld(vertices, quads, reach)
    merged = int(np.count_nonzero(used)) - len(welded.vertices)
    if merged:
        near = f"within {reach:.3g}{unit}" if reach > 0 else "at the same position"
        notes.append(_note(merged, VERTICES, f"welded to others {near}; {len(welded.vertices)} remain"))
    if not used.all():
        notes.append(_note(np.count_nonzero(~used), VERTICES, "removed", "without a face"))
    triangles, quad = split_quads(welded.vertices, welded.faces)
    if len(triangles) > len(quads) or polygons:
        notes.append(_note(len(triangles) - len(quads) + polygons, ("quad or polygon", "quads and polygons"), "split into triangles"))
    cleaned = clean_faces(triangles)
    if cleaned.degenerate:
        notes.append(_note(cleaned.degenerate, FACES, "removed", "with fewer than three different corners"))
    if cleaned.duplicate:
        notes.append(Omission(_note(cleaned.duplicate, ("duplicate face", "duplicate faces"), "removed")))
    if not len(cleaned.faces):
        raise MeshError("the mesh has no face with three different corners; check the unit and the tolerance of the file")
    kept = np.zeros(len(welded.vertices), bool)
    kept[cleaned.faces] = True
    new = np.where(kept, np.cumsum(kept) - 1, -1)
    oriented = orient(new[cleaned.faces])
    if oriented.turned.any():
        notes.append(_note(np.count_nonzero(oriented.turned), FACES, "turned over to match their neighbours"))
    index = np.where(welded.index >= 0, new[welded.index], -1)
    return Tidy(welded.vertices[kept], oriented.faces, index, whose[quad[cleaned.kept]], notes)


def _note(count: Union[int, np.integer], kind: tuple[str, str], done: str, which: str = "") -> str:
    """Return a note on what was done to `count` items of a kind."""
    return " ".join(filter(None, (f"{count} {kind[int(count != 1)]}", which, "was" if count == 1 else "were", done)))


def quad_array(vertices: FloatArray, faces: Union[IntArray, Sequence[Sequence[int]]]) -> tuple[IntArray, IntArray, int]:
    """Return polygons as quads, and triangles with a repeated corner (k, 4), the polygon of each (k,), and the number of larger ones."""
    if isinstance(faces, np.ndarray):
        return faces if faces.shape[1] == 4 else np.column_stack([faces, faces[:, 2]]), np.arange(len(faces)), 0
    size = np.array([len(face) for face in faces], dtype=np.int64)
    if (size == 3).all() and len(size):
        corners = np.array(faces, dtype=np.int64)
        return np.column_stack([corners, corners[:, 2]]), np.arange(len(faces)), 0
    rows: list[list[int]] = []
    owner: list[int] = []
    for i, face in enumerate(faces):
        parts = [list(face)] if len(face) in (3, 4) else triangulate(vertices, face)
        rows += [part if len(part) == 4 else [*part, part[2]] for part in parts]
        owner += [i] * len(parts)
    return np.array(rows, dtype=np.int64).reshape(-1, 4), np.array(owner, dtype=np.int64), int(np.count_nonzero(size > 4))


def mean_edge(vertices: FloatArray, faces: IntArray) -> float:
    """Return the mean length of the non-degenerate sides of faces (m, c) [L], 0 if there are none."""
    length = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2)
    return float(length[length > 0].mean()) if (length > 0).any() else 0.0
