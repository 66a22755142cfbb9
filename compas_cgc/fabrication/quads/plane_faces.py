"""Plane faces and beams of a roof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.arrays import Vectors
from ...model.problem import CGCProblem
from ..figures import SHORT
from ..figures import two_digits
from ..materials import metres_per_unit

__all__ = ["PlaneQuads", "axis_lines", "dead_ends"]

STRAIGHT = np.deg2rad(150.0)  # angle at a vertex with three sides from which one of them is a line that ends there


@dataclass(frozen=True, eq=False)
class PlaneQuads:
    """Plane faces and beams of all regions.

    Parameters
    ----------
    problem
        The surface.
    spacing
        Distance between lines [L].
    depth
        Depth of the beams [L].
    vertices
        (k, 3) corners of the faces [L].
    faces
        Corners of every face, counterclockwise seen from outside; four inside, three or more at the rim.
    region
        (f,) region of every face.
    rim
        (k,) whether a corner lies on the rim of its region.
    planarity
        (f,) largest distance between the diagonals of four consecutive corners [L].
    off
        (k,) distances of the corners from the mesh [L].
    edges
        (e, 2) beams, as pairs of corners.
    axes
        (k, 3) axes of the nodes: a node moved by its axis has the distance 1 from all faces around it, by least squares.
    twist
        (e,) distance between the diagonals of a beam of this depth between the axes of its ends [L].
    offset_error
        (f,) a face has its corners moved along the axes by the depth: largest difference between the depth and their distance from it [L].
    notes
        Sentences on regions without quads.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import plane_quads
    >>> quads = plane_quads(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), 0.8)
    >>> quads.dead_ends, bool(quads.planarity.max() < 1e-3)
    (0, True)
    """

    problem: CGCProblem
    spacing: float  # [L]
    depth: float  # [L]
    vertices: Vectors  # (k, 3) [L]
    faces: list[list[int]]  # corners of every face
    region: IntArray  # (f,) region of every face
    rim: Mask  # (k,) on the rim of its region
    planarity: FloatArray  # (f,) largest distance between diagonals [L]
    off: FloatArray  # (k,) distances from the mesh [L]
    edges: IntArray  # (e, 2) beams
    axes: Vectors  # (k, 3) axes of the nodes
    twist: FloatArray  # (e,) distance between the diagonals of a beam [L]
    offset_error: FloatArray  # (f,) deviation of the offset from the depth [L]
    notes: tuple[str, ...] = ()

    @property
    def irregular(self) -> IntArray:
        """Inner corners with other than four sides: the singularities of the layout (s,)."""
        degree = np.bincount(self.edges.ravel(), minlength=len(self.vertices))
        return np.flatnonzero(~self.rim & (degree != 4))

    @property
    def aspects(self) -> FloatArray:
        """Ratio of the widths of a face along both directions, at least 1 (f,); NaN without four corners and for faces at the rim."""
        inner = np.array([len(face) == 4 and not self.rim[face].any() for face in self.faces])
        found = np.full(len(self.faces), np.nan)
        a, b, c, d = self.vertices[[face for face, own in zip(self.faces, inner) if own]].reshape(-1, 4, 3).transpose(1, 0, 2)
        ratio = np.linalg.norm(b + c - a - d, axis=1) / np.linalg.norm(c + d - a - b, axis=1)
        found[inner] = np.maximum(ratio, 1.0 / ratio)
        return found

    @property
    def dead_ends(self) -> int:
        """Number of lines that end inside: at corners with two sides, or with three of which two are in line."""
        return dead_ends(self.vertices, self.edges, self.rim)

    def summary(self) -> str:
        """Return lines of text with counts, planarity, distances from the surface and offsets."""
        mm = 1e3 * metres_per_unit(self.problem.drawing.units)
        sides = mm * np.linalg.norm(self.vertices[self.edges[:, 0]] - self.vertices[self.edges[:, 1]], axis=1)
        corners = np.array([len(face) for face in self.faces])
        others = f", {(corners != 4).sum()} with other numbers of sides at the rim" if (corners != 4).any() else ""
        middle, most = mm * np.median(self.off), mm * self.off.max()
        lines = [
            f"{len(self.faces)} plane faces, {(corners == 4).sum()} quads{others}; {len(self.irregular)} irregular nodes, "
            f"{self.dead_ends} dead ends",
            f"planarity: {two_digits(mm * self.planarity.max())} mm between diagonals at most",
            f"nodes deviate from the mesh by {two_digits(middle)} mm (median), {two_digits(most)} mm at most",
            f"{len(self.edges)} beams of {sides.min():.4g} to {sides.max():.4g} mm; at a depth of {mm * self.depth:.4g} mm they twist by "
            f"{two_digits(mm * np.median(self.twist))} mm (median), {two_digits(mm * self.twist.max())} mm at most",
            f"faces offset by {mm * self.depth:.4g} mm miss their nodes by {two_digits(mm * np.median(self.offset_error))} mm (median), "
            f"{two_digits(mm * self.offset_error.max())} mm at most",
        ]
        square = np.array([number in self.problem.laws for number in self.region.tolist()])
        aspects = self.aspects[square & np.isfinite(self.aspects)]
        if len(aspects):
            middle, most = 100.0 * (np.median(aspects) - 1.0), 100.0 * (aspects.max() - 1.0)
            lines.append(f"squares inside regions of constant H: widths differ by {middle:.2g} % (median), {most:.2g} % at most")
        short = self.short_beams()
        return "\n".join([*lines, *([short] if short else []), *self.notes])

    __str__ = summary

    def short_beams(self) -> str:
        """Return a sentence that names the beams below 100 mm with their lengths, the shortest first, empty without any."""
        ends = self.vertices[self.edges]
        lengths = 1e3 * metres_per_unit(self.problem.drawing.units) * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        short = np.flatnonzero(lengths < 1e3 * SHORT)
        named = ", ".join(f"B{k} ({lengths[k]:.0f} mm)" for k in short[np.argsort(lengths[short], kind="stable")].tolist())
        return f"beams shorter than {1e3 * SHORT:g} mm: {named}; another spacing moves them" if len(short) else ""


def dead_ends(vertices: Vectors, edges: IntArray, rim: Mask) -> int:
    """Return the number of lines that end inside: at corners with two sides, or with three of which two are in line."""
    degree = np.bincount(edges.ravel(), minlength=len(vertices))
    ends = 0
    for vertex in np.flatnonzero(~rim & (degree != 4)).tolist():
        others = edges[(edges == vertex).any(axis=1)].sum(axis=1) - vertex
        along = vertices[others] - vertices[vertex]
        along = along / np.linalg.norm(along, axis=1, keepdims=True)
        straight = np.arccos(np.clip(along @ along.T, -1.0, 1.0)).max(initial=0.0) >= STRAIGHT
        ends += len(others) < 3 or (len(others) == 3 and bool(straight))
    return ends


def axis_lines(quads: PlaneQuads) -> FloatArray:
    """Return the axes of the nodes as lines over the depth of the beams (k, 2, 3) [L]."""
    return np.stack([quads.vertices, quads.vertices + quads.depth * quads.axes], axis=1)
