"""Panels between curves on a surface, within any rim and around holes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete import boundary_vertices
from ..discrete.arrays import FloatArray
from ..errors import MeshError
from ..meshing import face_regions
from ..meshing import path_edges
from ..meshing.outline import mesh_from_outline
from ..meshing.weld import clean_faces
from ..meshing.weld import weld
from .panelling import Panelling
from .rims import mean_steps
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["Lengths", "curve_panels", "parameter_rim"]

SAMPLES = 64  # divisions of the domain along which lengths are measured
POINT = 1e-4  # of an edge, within which points are one
JOINED = 1e-2  # of an edge, within which points on both sides of a closed surface are one


class Lengths(NamedTuple):
    """A plane in which distances are about those on a surface: mean lengths along its parameters."""

    parameters: tuple[FloatArray, FloatArray]
    lengths: tuple[FloatArray, FloatArray]  # [L]

    @classmethod
    def of(cls, surface: SplineSurface, rims: Sequence[FloatArray] = ()) -> Lengths:
        """Measure a surface along lines of constant parameter, within its rims."""
        values = [np.linspace(low, high, SAMPLES + 1) for low, high in surface.domain.tolist()]
        uv = np.stack(np.meshgrid(*values, indexing="ij"), axis=-1)
        points, inside = surface.at(uv.reshape(-1, 2)).reshape(SAMPLES + 1, SAMPLES + 1, 3), within_rims(uv, rims)
        steps = [mean_steps(points, inside, axis) for axis in range(2)]
        first, second = (np.concatenate([[0.0], np.cumsum(step)]) for step in steps)
        return cls((values[0], values[1]), (first, second))

    def to_plane(self, uv: FloatArray) -> FloatArray:
        """Return points of the plane (k, 2) at parameters (k, 2) [L]."""
        return np.column_stack([_extrapolated(uv[:, k], self.parameters[k], self.lengths[k]) for k in range(2)])

    def to_parameters(self, plane: FloatArray) -> FloatArray:
        """Return the parameters (k, 2) of points of the plane (k, 2) [L]."""
        return np.column_stack([_extrapolated(plane[:, k], self.lengths[k], self.parameters[k]) for k in range(2)])


def parameter_rim(surface: SplineSurface) -> FloatArray:
    """Return the rim of the domain of a surface (4, 2)."""
    (u0, u1), (v0, v1) = surface.domain
    return np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])


def curve_panels(surface: SplineSurface, rims: Sequence[FloatArray], seams: Sequence[FloatArray], edge_length: float) -> Panelling:
    """Return a mesh within rims whose edges follow seams; the parts between seams are the panels.

    Vertices lie on the surface, those of a seam on the seam.

    Parameters
    ----------
    surface
        The surface.
    rims
        ``(k, 2)`` parameters around the surface, then around its holes.
    seams
        ``(k, 2)`` parameters along seams, which may leave the rim and cross.
    edge_length
        Length of edges aimed at [L].

    Raises
    ------
    MeshError
        If curves bound no area, graze each other or the rim, or the mesher is not installed.
    """
    plane = Lengths.of(surface, rims)

    def flat(line: FloatArray) -> FloatArray:
        points = plane.to_plane(line)
        return np.column_stack([points, np.zeros(len(points))])

    order = sorted(range(len(rims)), key=lambda k: -abs(_area(plane.to_plane(rims[k]))))
    outline, *holes = (flat(rims[k]) for k in order)
    lines = [flat(line) for seam in seams for line in _periods(surface, seam)]
    made = mesh_from_outline(outline, holes, lines, edge_length, POINT * edge_length)
    uv = np.clip(plane.to_parameters(made.vertices[:, :2]), surface.domain[:, 0], surface.domain[:, 1])
    if not len(made.faces):
        raise MeshError("the boundary curves of the design enclose no area; check the outline of the design")
    joined = weld(surface.at(uv), made.faces, JOINED * edge_length if any(surface.closed) else 0.0)
    clean = clean_faces(joined.faces)
    first = np.full(len(joined.vertices), len(uv))
    np.minimum.at(first, joined.index, np.arange(len(uv)))
    creases = joined.index[np.array(path_edges(made.creases), dtype=np.int64).reshape(-1, 2)]
    panels = face_regions(clean.faces, creases[creases[:, 0] != creases[:, 1]])
    rim = boundary_vertices(joined.vertices, clean.faces)
    on_side = (uv[first] == surface.domain[:, 0]) | (uv[first] == surface.domain[:, 1])
    if not len(holes) and (on_side & rim[:, None] & ~on_side[:, ::-1])[:, list(surface.closed)].any():
        raise MeshError("seams cross the line where the parameters of the design close at different places; use a grid of seams")
    return Panelling(joined.vertices, clean.faces, panels, uv[first], np.column_stack([rim, rim]))


def _periods(surface: SplineSurface, seam: FloatArray) -> list[FloatArray]:
    """Return a seam (k, 2) and its copies one period away that reach into the domain, where parameters close."""
    spans = np.ptp(surface.domain, axis=1)
    shifts = [(-1.0, 0.0, 1.0) if closes else (0.0,) for closes in surface.closed]
    copies = [seam + [i * spans[0], j * spans[1]] for i in shifts[0] for j in shifts[1]]
    return [line for line in copies if ((line >= surface.domain[:, 0]) & (line <= surface.domain[:, 1])).all(axis=1).any()]


def _extrapolated(x: FloatArray, known: FloatArray, values: FloatArray) -> FloatArray:
    """Return values between known places, and beyond them at the mean rate."""
    rate = (values[-1] - values[0]) / (known[-1] - known[0])
    return np.interp(x, known, values) + rate * (x - np.clip(x, known[0], known[-1]))


def _area(ring: FloatArray) -> float:
    x, y = ring.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
