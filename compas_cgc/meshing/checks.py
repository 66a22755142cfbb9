"""Mesh diagnostics: manifoldness, orientation, degenerate faces and existence, each in one sentence with its remedy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import cast

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import face_areas
from ..discrete._memo import remembered
from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import Remedy
from ..errors import Sentence
from ..errors import names_what_was_meant
from .splitting import corner_fans

__all__ = ["Diagnostic", "listed", "mesh_problems"]


_SPLIT = "separate the parts (read the file with manifold=True, or --manifold)"


class Diagnostic(Sentence):
    """A sentence about a mesh.

    Attributes
    ----------
    fatal
        Whether a solve is refused because of it.
    remedies
        Changes of the problem that the sentence proposes.
    text
        The sentence.

    Examples
    --------
    >>> Diagnostic("the mesh is closed", fatal=False).fatal
    False
    """

    fatal: bool

    def __new__(cls, text: str, fatal: bool = True, remedies: Iterable[Remedy] = ()) -> Diagnostic:
        diagnostic = cast(Diagnostic, super().__new__(cls, text, remedies))
        diagnostic.fatal = fatal
        return diagnostic


def listed(items: object, most: int = 5) -> str:
    """Return the first few items as text, with the number of further ones."""
    items = [tuple(i) if isinstance(i, list) else i for i in np.asarray(items).tolist()]
    shown = ", ".join("-".join(map(str, i)) if isinstance(i, tuple) else str(i) for i in items[:most])
    return shown + (f" and {len(items) - most} more" if len(items) > most else "")


@names_what_was_meant()
def mesh_problems(vertices: FloatArray, faces: IntArray, vertex_names: IntArray, face_names: IntArray) -> list[Diagnostic]:
    """Return the faults of a mesh itself, independent of targets.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` coordinates and ``(m, 3)`` indices.
    vertex_names, face_names
        ``(n,)`` and ``(m,)`` keys in the user's mesh.

    Returns
    -------
    list of Diagnostic
        Sentences, empty if the mesh is sound.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> mesh_problems(square, np.array([[0, 1, 2], [0, 2, 3]]), np.arange(4), np.arange(2))
    []
    """
    if not len(faces):
        return [Diagnostic("the mesh has no faces; give a mesh with faces")]
    problems: list[Diagnostic] = []
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    if not used.all():
        problems.append(
            Diagnostic(f"vertices {listed(vertex_names[~used])} belong to no face; remove them (mesh.remove_unused_vertices())")
        )
    problems += _face_problems(vertices, faces, face_names)
    return problems + _manifold_problems(faces, vertex_names, face_names)


@remembered
def _face_problems(V: FloatArray, F: IntArray, names: IntArray) -> list[Diagnostic]:
    problems = []
    key = np.sort(F, axis=1)
    order = np.lexsort(key.T)
    twin = np.zeros(len(F), bool)
    twin[order[1:]] = (key[order[1:]] == key[order[:-1]]).all(axis=1)
    if twin.any():
        problems.append(Diagnostic(f"faces {listed(names[twin])} are duplicates of others; remove them"))
    corners = V[F]
    sides = corners - np.roll(corners, 1, axis=1)
    flat = face_areas(V, F) <= 1e-12 * np.einsum("ijk,ijk->ij", sides, sides).max(axis=1)
    if flat.any():
        problems.append(
            Diagnostic(f"faces {listed(names[flat])} are degenerate (zero area); weld or remove their vertices, or remesh there")
        )
    return problems


@remembered
def _manifold_problems(F: IntArray, vertex_names: IntArray, face_names: IntArray) -> list[Diagnostic]:
    n, m = int(F.max()) + 1, len(F)
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    owner = np.repeat(np.arange(m), 3)
    code = np.minimum(u, v) * n + np.maximum(u, v)
    order = np.argsort(code, kind="stable")
    code = code[order]
    start = np.flatnonzero(np.append(True, code[1:] != code[:-1]))
    edge, count = code[start], np.diff(np.append(start, len(code)))
    many = edge[count > 2]
    if len(many):
        ends = np.column_stack([vertex_names[many // n], vertex_names[many % n]])
        text = f"edges {listed(ends)} belong to more than two faces, so the mesh is not manifold; remove the extra faces, or {_SPLIT}"
        return [Diagnostic(text)]

    first, second = order[start[count == 2]], order[start[count == 2] + 1]
    a, b, same = owner[first], owner[second], u[first] == u[second]
    problems = []
    # Two copies of each face, one per orientation: a mesh is orientable if they are not connected.
    ones = np.ones(2 * len(a))
    i = np.concatenate([a, a + m])
    j = np.concatenate([np.where(same, b + m, b), np.where(same, b, b + m)])
    _, side = connected_components(sparse.coo_matrix((ones, (i, j)), shape=(2 * m, 2 * m)), directed=False)
    pieces, piece = connected_components(sparse.coo_matrix((ones[: len(a)], (a, b)), shape=(m, m)), directed=False)
    if (side[:m] == side[m:]).any():
        problems.append(Diagnostic("the mesh is not orientable (like a Moebius strip); cut it open"))
    elif same.any():
        problems.append(
            Diagnostic(f"{_against(side[:m], piece, face_names)} are oriented against their neighbours; unify them (mesh.unify())")
        )
    problems += _fan_problems(F, n, vertex_names)
    if pieces > 1:
        problems.append(Diagnostic(f"the mesh has {pieces} separate pieces, which are solved independently", fatal=False))
    return problems


def _against(side: CSRIndices, piece: CSRIndices, names: IntArray) -> str:
    """Return the faces oriented against most of their piece, as text."""
    wrong = np.zeros(len(side), bool)
    for p in np.unique(piece):
        members = np.flatnonzero(piece == p)
        kinds, counts = np.unique(side[members], return_counts=True)
        wrong[members] = side[members] != kinds[np.argmax(counts)]
    return f"faces {listed(names[wrong])}"


def _fan_problems(F: IntArray, n: int, names: IntArray) -> list[Diagnostic]:
    """Return the fault of vertices at which several fans of faces touch."""
    fan = corner_fans(F)
    at_vertex = np.empty(fan.max() + 1, np.int64)
    at_vertex[fan] = F.ravel()
    fans = np.bincount(at_vertex, minlength=n)
    if (fans > 1).any():
        touching = names[np.flatnonzero(fans > 1)]
        return [Diagnostic(f"at vertices {listed(touching)} parts of the mesh touch in a point, so it is not manifold; {_SPLIT}")]
    return []
