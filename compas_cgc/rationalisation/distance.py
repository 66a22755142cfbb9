"""Distances of a surface from its design, and folds along its seams."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_normals
from ..discrete import vertex_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from .panelling import Panelling
from .spline_surface import SplineSurface

__all__ = ["Distance", "Folds", "distance_from", "folds_at_seams"]


class Distance(NamedTuple):
    """Distances of the vertices of a surface from its design."""

    signed: FloatArray  # (n,) positive on the side of the normals; those on the rim are distances from the rim of the design [L]
    rms: float  # root of the mean square, by areas [L]

    @property
    def largest(self) -> float:
        """Largest distance [L]."""
        return float(np.abs(self.signed).max(initial=0.0))


class Folds(NamedTuple):
    """Angles between the faces on both sides of every seam edge."""

    edges: Edges  # (s, 2)
    angles: FloatArray  # (s,) [deg]
    design: FloatArray  # (s,) the same on the design with the same mesh [deg]

    def beyond(self) -> dict[str, float]:
        """Return by how much the largest and the median fold exceed those of the design [deg]."""
        if not len(self.edges):
            return {"largest": 0.0, "median": 0.0}
        return {
            "largest": float(self.angles.max() - self.design.max()),
            "median": float(np.median(self.angles) - np.median(self.design)),
        }

    def change(self) -> FloatArray:
        """Return by how much the fold of every seam edge differs from that of the design (s,) [deg]."""
        return self.angles - self.design


def distance_from(surface: SplineSurface, panelling: Panelling, vertices: FloatArray) -> Distance:
    """Return the distances of vertices (n, 3) from a design.

    Vertices on the rim are measured from the rim, so that one that slides inwards along the design is away from it. As both surfaces
    have the same rim and no folds in between, this bounds the distance of the design from the surface too.
    """
    uv = surface.foot(vertices, panelling.parameters, panelling.held)
    away = vertices - surface.at(uv)
    lengths = np.linalg.norm(away, axis=1)
    sides = np.where(np.einsum("ij,ij->i", away, surface.normals(uv)) < 0.0, -1.0, 1.0)
    areas = vertex_areas(vertices, panelling.faces)
    return Distance(sides * lengths, float(np.sqrt(np.average(lengths**2, weights=areas))))


def folds_at_seams(panelling: Panelling, vertices: FloatArray) -> Folds:
    """Return the folds along the seams of a surface with vertices (n, 3), beside those of the design."""
    edges = edge_faces(panelling.faces)
    inner = edges[edges[:, 3] >= 0]
    seams = inner[panelling.panels[inner[:, 2]] != panelling.panels[inner[:, 3]]]

    def angles(shape: FloatArray) -> FloatArray:
        left, right = (face_normals(shape, panelling.faces)[seams[:, side]] for side in (2, 3))
        sines = np.linalg.norm(np.cross(left, right), axis=1)
        return np.degrees(np.arctan2(sines, np.einsum("ij,ij->i", left, right)))

    return Folds(seams[:, :2], angles(vertices), angles(panelling.vertices))
