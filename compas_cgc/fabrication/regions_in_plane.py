"""Regions in the plane: unrolled where K is 0, else flattened, each cut open where it has to be."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ..discrete import angle_defects
from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..model.problem import CGCProblem
from ..model.roles import INTERNAL
from .flattening import flatten
from .layout import among
from .layout import cut_open
from .patchwork import CREASE
from .patchwork import EDGE
from .patchwork import FREE
from .patchwork import SEAM
from .patchwork import Patchwork
from .patchwork import mates
from .patterns import Unrolling
from .plane_layout import unfold
from .seams import opens_to_disks
from .seams import seam_edges

__all__ = ["developed"]

CLOSED = 1e-6  # gap, against the size of a region, up to which its faces close up
CONE = 1e-9  # angle defect [rad] of a vertex where none is asked, from which on a seam has to pass through it


def developed(problem: CGCProblem, regions: list[int], given: Optional[Edges]) -> tuple[Patchwork, Edges, list[Unrolling]]:
    """Return the chosen regions in the plane, each a piece by itself, the edges cut for it, and how they came there."""
    label, targets = problem.regions(), problem.region_targets()
    planes, sides, faces, unrollings = [], [], [], []
    cuts = [problem.creases]
    for region in regions:
        own = np.flatnonzero(label == region)
        plane, seams, unrolling = _region(problem, region, own, targets[region], given)
        side = np.where(_sides_among(problem.faces[own], seams, len(problem.vertices)), SEAM, EDGE)
        planes.append(plane)
        sides.append(side)
        faces.append(own)
        cuts.append(seams)
        unrollings.append(unrolling)
    parent = np.concatenate(faces)
    F = problem.faces[parent]
    side = np.concatenate(sides)
    mate = mates(F)
    side = np.where(_sides_among(F, problem.creases, len(problem.vertices)), CREASE, side)
    side = np.where(mate < 0, FREE, side)
    used, corners = np.unique(F, return_inverse=True)
    flat = Patchwork(
        space=problem.vertices[used],
        names=problem.names.vertices[used],
        faces=corners.reshape(-1, 3).astype(np.int64),
        plane=np.concatenate(planes),
        side=side,
        piece=label[parent],
        region=label[parent],
        parent=parent,
    )
    return flat, np.vstack(cuts), unrollings


def _sides_among(faces: IntArray, edges: Edges, n: int) -> np.ndarray:
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    return among(ends, edges, n).reshape(-1, 3)


def _region(
    problem: CGCProblem, region: int, own: IntArray, target: Optional[float], given: Optional[Edges]
) -> tuple[FloatArray, Edges, Unrolling]:
    """Return a region's corners in the plane (m, 3, 2), the edges that were cut for it, and how it went."""
    edges = edge_faces(problem.faces[own])
    faces, origin = cut_open(problem.faces[own], edges[edges[:, 3] >= 0])
    V = problem.vertices[origin]
    inner = ~boundary_vertices(V, faces)
    defect = np.where(inner, np.abs(angle_defects(V, faces)), 0.0)
    asked = problem.roles[origin] == INTERNAL
    cones = (defect > CONE) & ~asked
    flat = target == 0.0 or (target is None and not (defect[asked] > CLOSED).any())
    if given is None:
        cuts = seam_edges(V, faces, cones if flat else _ends_of_a_slit(V, inner))
    else:
        every = edge_faces(faces)[:, :2]
        cuts = every[among(origin[every], given, len(problem.vertices))]
    layout = unfold(V, faces, cuts)
    size = float(np.linalg.norm(np.ptp(V, axis=0)))
    if given is not None and not opens_to_disks(layout.faces) and layout.gap > CLOSED * size:
        raise CGCError(_no_seam(region))
    if flat and layout.gap > CLOSED * size:
        worst = problem.names.vertices[origin[np.argmax(np.where(asked, defect, 0.0))]]
        raise CGCError(
            f"region {region} does not unroll: its faces leave gaps of up to {layout.gap:.3g} "
            f"({100 * layout.gap / size:.2g} % of its size), most of all at vertex {worst}; "
            "solve it to K = 0 first, on irregular meshes with the measure exact"
        )
    if not flat:
        if not opens_to_disks(layout.faces):
            raise CGCError(_no_seam(region))
        plane = flatten(V[layout.origin], layout.faces).plane[layout.faces]
        gap, error = 0.0, float("nan")
    else:
        plane, gap, error = layout.plane[layout.faces], layout.gap, layout.edge_error
        cuts = cuts[~_close_again(faces, plane, cuts, CLOSED * size)]
    return plane, origin[cuts], Unrolling(region, target, flat, gap, error, len(cuts))


def _ends_of_a_slit(vertices: Vertices, inner: Mask) -> Mask:
    """Mark two vertices far apart on a surface without an open edge, between which it is slit; none on others (n,)."""
    ends = np.zeros(len(vertices), bool)
    if inner.all():
        first = int(np.argmax(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1)))
        ends[[first, int(np.argmax(np.linalg.norm(vertices - vertices[first], axis=1)))]] = True
    return ends


def _no_seam(region: int) -> str:
    return f"region {region} goes round a hole that no seam opens; lead a seam from one open edge to the other, or name none"


def _close_again(faces: IntArray, plane: FloatArray, cuts: Edges, tolerance: float) -> np.ndarray:
    """Tell of which cut edges (s, 2) both sides lie at the same place."""
    edges = edge_faces(faces)
    edges = edges[among(edges[:, :2], cuts, int(faces.max()) + 1)]
    u, v, left, right = edges.T
    apart = np.zeros(len(edges))
    for w in (u, v):
        here, there = (plane[side, np.argmax(faces[side] == w[:, None], axis=1)] for side in (left, right))
        apart = np.maximum(apart, np.linalg.norm(here - there, axis=1))
    together = edges[apart <= tolerance, :2]
    return among(cuts, together, int(faces.max()) + 1)
