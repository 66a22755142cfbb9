"""Panels between lines of constant parameter of an untrimmed surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete import boundary_vertices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..meshing.weld import clean_faces
from ..meshing.weld import weld
from .panelling import Panelling
from .rims import mean_steps
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["grid_lines", "grid_panels"]

SAMPLES = 256  # divisions of a parameter by which lengths along it are measured
LINES = 9  # lines of constant parameter whose lengths are averaged
ONE = 1e-7  # of an edge, within which points of two sides are one


def grid_lines(surface: SplineSurface, axis: int, panel: float, sharp: Sequence[float] = (), rims: Sequence[FloatArray] = ()) -> FloatArray:
    """Return the values (k,) of a parameter between which the surface is one panel wide, on the average of lines across.

    Parameters
    ----------
    surface
        The surface.
    axis
        The parameter that changes, 0 or 1.
    panel
        Width of a panel aimed at [L].
    sharp
        Values at which the surface bends sharply; they are lines too.
    rims
        ``(k, 2)`` parameters around the surface and its holes, within which it is measured.
    """
    low, high = surface.domain[axis]
    stops = np.unique(np.concatenate([[low], [value for value in sharp if low < value < high], [high]]))
    t = np.linspace(0.0, 1.0, SAMPLES + 1)
    first, last = surface.domain[1 - axis].tolist()
    others = np.linspace(first, last, LINES)
    found = [stops[:1]]
    for first, last in zip(stops[:-1], stops[1:]):
        values = first + (last - first) * t
        uv = np.empty((LINES, SAMPLES + 1, 2))
        uv[..., axis], uv[..., 1 - axis] = values, others[:, None]
        points = surface.at(uv.reshape(-1, 2)).reshape(LINES, SAMPLES + 1, 3)
        steps = mean_steps(points, within_rims(uv, rims), 1)
        length = np.concatenate([[0.0], np.cumsum(steps)])
        count = max(1, round(float(length[-1]) / panel))
        found.append(np.interp(np.linspace(0.0, length[-1], count + 1)[1:], length, values))
    return np.concatenate(found)


def grid_panels(surface: SplineSurface, lines: tuple[FloatArray, FloatArray], edges: int) -> Panelling:
    """Return a mesh whose panels lie between lines of constant parameter, each divided into so many edges a side.

    Sides of the surface that are one curve are joined, and a side that is a point becomes one vertex.

    Raises
    ------
    MeshError
        If a panel has no room for a vertex of its own.
    """
    if edges < 2:
        raise MeshError(f"edges must be at least 2 mesh edges per panel side, not {edges}; otherwise a panel has no inner vertex")
    fine = [_divided(values, edges) for values in lines]
    nu, nv = len(fine[0]), len(fine[1])
    uv = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1).reshape(-1, 2)
    i, j = (each.ravel() for each in np.meshgrid(np.arange(nu - 1), np.arange(nv - 1), indexing="ij"))
    a = i * nv + j
    faces = np.concatenate([np.column_stack([a, a + nv, a + nv + 1]), np.column_stack([a, a + nv + 1, a + 1])])
    panels = np.tile((i // edges) * (len(lines[1]) - 1) + j // edges, 2)
    return _joined(surface, uv, faces, panels)


def _divided(values: FloatArray, edges: int) -> FloatArray:
    """Return values with so many even steps between each two."""
    places = np.arange((len(values) - 1) * edges + 1) / edges
    return np.interp(places, np.arange(len(values)), values)


def _joined(surface: SplineSurface, uv: FloatArray, faces: IntArray, panels: IntArray) -> Panelling:
    """Return the mesh with vertices that are one point of space joined."""
    points = surface.at(uv)
    across = np.linalg.norm(points[faces[:, 1]] - points[faces[:, 2]], axis=1)
    joined = weld(points, faces, ONE * float(np.median(across)))
    clean = clean_faces(joined.faces)
    first = np.full(len(joined.vertices), len(uv))
    np.minimum.at(first, joined.index, np.arange(len(uv)))
    uv = uv[first]
    on_rim = boundary_vertices(joined.vertices, clean.faces)
    held = ((uv == surface.domain[:, 0]) | (uv == surface.domain[:, 1])) & on_rim[:, None]
    return Panelling(joined.vertices, clean.faces, panels[clean.kept], uv, held)
