"""Panels that are the faces of a quad mesh."""

from __future__ import annotations

import numpy as np

from ..discrete import boundary_vertices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..meshing.weld import clean_faces
from ..meshing.weld import weld
from .panelling import Panelling
from .spline_surface import SplineSurface

__all__ = ["quad_panels"]

ONE = 1e-6  # of an edge, within which points of two faces are one


def quad_panels(surface: SplineSurface, corners: FloatArray, quads: IntArray, edges: int) -> Panelling:
    """Return a mesh on a surface whose panels are the faces of a quad mesh, each divided into so many edges a side.

    Parameters
    ----------
    surface
        The surface.
    corners
        ``(k, 2)`` parameters of the corners of the quads.
    quads
        ``(q, 4)`` corners of every quad.
    edges
        Edges along the side of a panel.

    Raises
    ------
    MeshError
        If a panel has no room for a vertex of its own.
    """
    if edges < 2:
        raise MeshError(f"edges must be at least 2 mesh edges per panel side, not {edges}; otherwise a panel has no inner vertex")
    t = np.linspace(0.0, 1.0, edges + 1)
    s, t = (each.ravel() for each in np.meshgrid(t, t, indexing="ij"))
    shares = np.column_stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    uv = np.einsum("pc,qcx->qpx", shares, corners[quads]).reshape(-1, 2)
    i, j = (each.ravel() for each in np.meshgrid(np.arange(edges), np.arange(edges), indexing="ij"))
    a = i * (edges + 1) + j
    own = np.concatenate([np.column_stack([a, a + edges + 1, a + edges + 2]), np.column_stack([a, a + edges + 2, a + 1])])
    faces = (own[None] + np.arange(len(quads))[:, None, None] * (edges + 1) ** 2).reshape(-1, 3)
    panels = np.repeat(np.arange(len(quads)), len(own))
    points = surface.at(uv)
    joined = weld(points, faces, ONE * float(np.median(np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1))))
    clean = clean_faces(joined.faces)
    first = np.full(len(joined.vertices), len(uv))
    np.minimum.at(first, joined.index, np.arange(len(uv)))
    rim = boundary_vertices(joined.vertices, clean.faces)
    return Panelling(joined.vertices, clean.faces, panels[clean.kept], uv[first], np.column_stack([rim, rim]))
