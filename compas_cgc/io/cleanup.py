"""What a file holds to a clean mesh."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import FileError
from ..errors import MeshError
from ..meshing.cleanup import tidy
from .meshfile import MeshFile

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["tidied"]


def tidied(found: MeshFile, source: Path) -> tuple[CGCMesh, list[str]]:
    """Return a clean mesh with the roles that still apply, and notes.

    Raises
    ------
    FileError
        If the vertices and faces of the file do not form a mesh.
    """
    n = len(found.vertices)
    wrong = next((i for i, face in enumerate(found.faces) if any(not 0 <= v < n for v in face)), None)
    if wrong is not None:
        raise FileError(f"{source}: face {wrong} names a vertex that does not exist; export it again")
    if not np.isfinite(found.vertices).all():
        bad = int(np.flatnonzero(~np.isfinite(found.vertices).all(axis=1))[0])
        raise FileError(f"{source}: vertex {bad} has a coordinate that is no finite number; correct it")
    try:
        clean = tidy(found.vertices, found.faces, 0.0)
    except MeshError as error:
        raise FileError(f"{source}: {error}") from None
    index = _places(found.vertices, clean.vertices, clean.index)
    targets = None
    if found.targets is not None:
        targets = [None] * len(clean.vertices)
        for old, K in enumerate(found.targets):
            if index[old] >= 0 and K is not None:
                targets[index[old]] = K
    creases = [[int(index[v]) for v in path] for path in found.creases]
    on = _follow(creases, clean.faces)
    notes = [*found.notes, *clean.notes]
    if not all(on):
        notes.append(f"{len(on) - sum(on)} lines that do not follow edges of the mesh were left out")
    supports = sorted({int(index[v]) for v in found.supports if index[v] >= 0})
    kept = MeshFile(clean.vertices, clean.faces.tolist(), supports, [path for path, good in zip(creases, on) if good], targets)
    return kept.to_cgcmesh(source.stem), notes


def _follow(paths: list[list[int]], faces: np.ndarray) -> list[bool]:
    """Tell which vertex paths run along edges of faces (m, 3)."""
    n = int(faces.max()) + 1
    edges = np.concatenate([faces * n + np.roll(faces, shift, axis=1) for shift in (1, -1)]) if paths else faces
    pairs = [(k, u, v) for k, path in enumerate(paths) for u, v in zip(path[:-1], path[1:])]
    path, u, v = np.array(pairs, dtype=np.int64).reshape(-1, 3).T
    good = np.isin(u * n + v, edges) & (u >= 0) & (v >= 0)
    wrong = np.bincount(path[~good], minlength=len(paths))
    return [len(own) > 1 and bad == 0 for own, bad in zip(paths, wrong.tolist())]


def _places(old: np.ndarray, new: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Return the new index of every old vertex; one of no face, as points and lines of other programs have, goes by its place."""
    lost = np.flatnonzero(index < 0)
    if not len(lost):
        return index
    at = {place: i for i, place in enumerate(map(tuple, new.tolist()))}
    index = index.copy()
    index[lost] = [at.get(tuple(place), -1) for place in old[lost].tolist()]
    return index
