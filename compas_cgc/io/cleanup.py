"""Mesh cleanup: conversion of the polygons in a file to a problem with a clean triangle mesh."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.topology import boundary_vertices
from ..errors import FileError
from ..errors import MeshError
from ..meshing import Diagnostic
from ..meshing.cleanup import Omission
from ..meshing.cleanup import Tidy
from ..meshing.cleanup import mean_edge
from ..meshing.cleanup import tidy
from ..model.problem import CGCProblem
from ..model.problem import Drawing
from .reading import ReadProblem
from .rhino.snapping import snap_distance

__all__ = ["check_mesh", "clean_problem"]

MAX_COORDINATE = 1e12  # [L]; its cube does not overflow
COARSE_ROUNDING = 1e-4  # of the edge length, above which rounding of coordinates shows in the curvature
NEARLY_ONE = 1e-3  # of the edge length, below which two vertices on the boundary are probably one
MAX_CORNERS = 1000  # corners of a face; the time of ear clipping grows with their square


def clean_problem(
    source: Path,
    vertices: FloatArray,
    faces: list[list[int]],
    *,
    supports: Sequence[int] = (),
    creases: Sequence[Sequence[int]] = (),
    targets: Optional[FloatArray] = None,
    notes: Sequence[str] = (),
    tolerance: float = 0.0,
    single: bool = False,
) -> ReadProblem:
    """Return the problem with the polygons of a file, welded, triangulated and oriented if necessary.

    Parameters
    ----------
    source
        The file.
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        Vertex indices of every polygon.
    supports
        Fixed vertices.
    creases
        Vertex paths; paths that do not follow edges are omitted.
    targets
        ``(n,)`` target Gaussian curvature [1/L^2], NaN where K is not prescribed.
    notes
        Notes so far.
    tolerance
        Distance within which vertices are welded [L].
    single
        Whether the coordinates are in single precision.

    Raises
    ------
    FileError
        If vertices and faces do not form a mesh.
    """
    if creases and not len(faces):
        raise FileError(f"{source} holds lines but no faces; mesh its outline with CGCMesh.from_outline(points, edge_length)")
    check_mesh(source, vertices, faces)
    try:
        clean = tidy(vertices, faces, tolerance)
    except MeshError as error:
        raise FileError(f"{source}: {error}") from None
    reach = snap_distance(clean.vertices, clean.faces, tolerance)
    index = _places(vertices, clean.vertices, clean.index, reach)
    K = np.full(len(clean.vertices), np.nan)
    if targets is not None:
        known = (index >= 0) & ~np.isnan(targets)
        K[index[known]] = targets[known]
    paths = [[int(index[v]) for v in path] for path in creases]
    on = _follow(paths, clean.faces)
    said = [*notes, *clean.notes, *_precision_notes(clean, single), *_gap_notes(clean)]
    if not all(on):
        said.append(Omission(f"{len(on) - sum(on)} lines that do not follow edges of the mesh were ignored"))
    problem = CGCProblem(
        clean.vertices,
        clean.faces,
        targets=K,
        creases=[path for path, good in zip(paths, on) if good],  # type: ignore[arg-type]
        drawing=Drawing(source.stem),
    )
    fixed = {int(index[v]) for v in supports if index[v] >= 0}
    return ReadProblem(problem.with_supports(sorted(fixed)), tuple(said), _far_supports(vertices[list(supports)], clean.vertices, reach))


def _far_supports(places: FloatArray, vertices: FloatArray, reach: float) -> tuple[Diagnostic, ...]:
    """Return the fault of supports (k, 3) farther from all vertices (n, 3) than a distance [L]."""
    if not len(places):
        return ()
    distance = cKDTree(vertices).query(places)[0]
    far = int(np.count_nonzero(distance > reach))
    if not far:
        return ()
    worst = int(np.argmax(distance))
    where = ", ".join(f"{x:.6g}" for x in places[worst].tolist())
    which = f"{far} supports are not at vertices" if far > 1 else "1 support is not at a vertex"
    return (
        Diagnostic(f"{which} of the mesh; the farthest, at ({where}), is {distance[worst]:.3g} away: move it to a vertex, or remove it"),
    )


def _precision_notes(clean: Tidy, single: bool) -> list[str]:
    """Return a note on coordinates in single precision, with their rounding against the edge length."""
    if not single:
        return []
    step = float(np.spacing(np.abs(clean.vertices).max().astype(np.float32)))
    share = step / mean_edge(clean.vertices, clean.faces)
    if share < COARSE_ROUNDING:
        return ["the file stores seven digits of each coordinate; .3dm, .obj and text .ply store all"]
    return [
        f"the file stores coordinates in steps of {step:.3g} so far from the origin, {100 * share:.2g} % of the edge length; "
        "move the model to the origin and export it again"
    ]


def _gap_notes(clean: Tidy) -> list[str]:
    """Return a note that proposes a welding distance where vertices on the boundary nearly coincide."""
    loops = np.flatnonzero(boundary_vertices(clean.vertices, clean.faces))
    length = mean_edge(clean.vertices, clean.faces)
    if len(loops) < 2 or not length > 0:
        return []
    gaps = cKDTree(clean.vertices[loops]).query(clean.vertices[loops], k=2)[0][:, 1]
    near = gaps[gaps <= NEARLY_ONE * length]
    if not len(near):
        return []
    return [f"{len(near)} vertices on the boundary lie within {near.max():.2g} of another; weld them with --weld {2 * near.max():.1g}"]


def check_mesh(source: Path, vertices: FloatArray, faces: Sequence[Sequence[int]]) -> None:
    """Check the vertices (n, 3) and polygons of a file.

    Raises
    ------
    FileError
        If there are none, a face refers to a vertex that does not exist or has too many corners, or a coordinate is not finite.
    """
    n = len(vertices)
    if not n or not len(faces):
        raise FileError(f"{source} holds no mesh; give one with vertices and faces")
    wrong = next((i for i, face in enumerate(faces) if any(not 0 <= v < n for v in face)), None)
    if wrong is not None:
        raise FileError(f"{source}: face {wrong} refers to a vertex that does not exist; export the file again")
    large = next((i for i, face in enumerate(faces) if len(face) > MAX_CORNERS), None)
    if large is not None:
        raise FileError(
            f"{source}: face {large} has {len(faces[large])} corners, but at most {MAX_CORNERS} are supported; divide it and export again"
        )
    bad = ~(np.abs(vertices) <= MAX_COORDINATE).all(axis=1)
    if bad.any():
        what = f"has a coordinate that is not finite or exceeds {MAX_COORDINATE:g}"
        raise FileError(f"{source}: vertex {int(np.argmax(bad))} {what}; correct it")


def _follow(paths: list[list[int]], faces: IntArray) -> list[bool]:
    """Check which vertex paths follow edges of faces (m, 3)."""
    n = int(faces.max()) + 1
    edges = np.concatenate([faces * n + np.roll(faces, shift, axis=1) for shift in (1, -1)]) if paths else faces
    pairs = [(k, u, v) for k, path in enumerate(paths) for u, v in zip(path[:-1], path[1:])]
    path, u, v = np.array(pairs, dtype=np.int64).reshape(-1, 3).T
    good = np.isin(u * n + v, edges) & (u >= 0) & (v >= 0)
    wrong = np.bincount(path[~good], minlength=len(paths))
    return [len(own) > 1 and bad == 0 for own, bad in zip(paths, wrong.tolist())]


def _places(old: FloatArray, new: FloatArray, index: IntArray, reach: float) -> IntArray:
    """Return the new index of every old vertex. Vertices without faces, as of points and lines, take the nearest within `reach` [L]."""
    alone = np.flatnonzero(index < 0)
    if not len(alone):
        return index
    distance, nearest = cKDTree(new).query(old[alone])
    index = index.copy()
    index[alone] = np.where(distance <= reach, nearest, -1)
    return index
