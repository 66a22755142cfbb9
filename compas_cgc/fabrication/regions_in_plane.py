"""Regions in the plane: unrolled if K = 0, else flattened, with cuts where necessary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import angle_defects
from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..model.problem import CGCProblem
from ..model.roles import INTERNAL
from .figures import unit_symbol
from .flattening import flatten
from .layout import among
from .layout import cut_open
from .panel_regions import panel_regions
from .panelling import Panel
from .patchwork import CREASE
from .patchwork import CUT
from .patchwork import EDGE
from .patchwork import FREE
from .patchwork import SEAM
from .patchwork import Patchwork
from .patchwork import mates
from .patterns import Unrolling
from .plane_layout import unfold
from .seams import opens_to_disks
from .seams import seam_edges
from .straight_seams import straightened

__all__ = ["developed", "developed_panels"]

GAP_TOLERANCE = 1e-6  # gap relative to the size of a region up to which its faces close
CONE_DEFECT = 1e-9  # angle defect [rad] of a vertex without target above which a seam must pass through it


class _Laid(NamedTuple):
    """A region in the plane."""

    plane: FloatArray  # (m, 3, 2) positions of the corners of its faces [L]
    faces: Faces  # (m, 3) vertices
    parent: IntArray  # (m,) mesh face that contains each face
    fresh: Vertices  # (k, 3) new vertices on its seams [L]
    seams: Edges  # (s, 2)
    unrolling: Unrolling


def developed_panels(problem: CGCProblem, panels: Sequence[Panel], regions: list[int]) -> tuple[Patchwork, Edges, list[Unrolling]]:
    """Return the panels of the chosen regions in the plane, one piece each, the cut edges, and the results of unrolling."""
    own, targets = panel_regions(problem, panels), problem.region_targets()
    within = np.array([panel.region for panel in panels], dtype=np.int64)[own.panel]
    chosen = np.flatnonzero(np.isin(within, regions))
    chosen = chosen[np.argsort(own.panel[chosen], kind="stable")]
    flat, cuts, laid = developed(own.problem, chosen.tolist(), None, [targets[k] for k in within.tolist()])
    creases = _sides_among(flat.faces, np.searchsorted(flat.names, own.problem.names.vertices[own.creases]), len(flat.space))
    side = np.where((flat.side == CREASE) & ~creases, CUT, flat.side)
    unrollings = []
    for region in regions:
        each = [one for one in laid if within[one.region] == region]
        gap, error = max(one.gap for one in each), max(one.edge_error for one in each)
        whole = all(one.unrolled for one in each)
        unrollings.append(Unrolling(region, targets[region], whole, gap, error, sum(one.seam_edges for one in each)))
    return replace(flat, side=side, region=within[flat.region], parent=own.parent[flat.parent]), problem.creases, unrollings


def developed(
    problem: CGCProblem, regions: list[int], given: Optional[Edges], targets: Optional[Sequence[Optional[float]]] = None
) -> tuple[Patchwork, Edges, list[Unrolling]]:
    """Return the chosen regions in the plane, one piece each, the cut edges, and the results of unrolling.

    The targets of all regions are those of the problem by default.
    """
    label, targets = problem.regions(), problem.region_targets() if targets is None else targets
    space, laid = problem.vertices, []
    for region in regions:
        own = np.flatnonzero(label == region)
        laid.append(_region(problem, region, own, targets[region], given, len(space)))
        space = np.vstack([space, laid[-1].fresh])
    parent = np.concatenate([one.parent for one in laid])
    F = np.concatenate([one.faces for one in laid])
    seams = [one.seams for one in laid]
    side = np.concatenate([np.where(_sides_among(one.faces, one.seams, len(space)), SEAM, EDGE) for one in laid])
    side = np.where(_sides_among(F, problem.creases, len(space)), CREASE, side)
    side = np.where(mates(F) < 0, FREE, side)
    used, corners = np.unique(F, return_inverse=True)
    named = problem.names.vertices
    flat = Patchwork(
        space=space[used],
        names=np.r_[named, named.max(initial=-1) + 1 + np.arange(len(space) - len(named))][used],
        faces=corners.reshape(-1, 3).astype(np.int64),
        plane=np.concatenate([one.plane for one in laid]),
        side=side,
        piece=label[parent],
        region=label[parent],
        parent=parent,
    )
    return flat, np.vstack([problem.creases, *seams]), [one.unrolling for one in laid]


def _sides_among(faces: IntArray, edges: Edges, n: int) -> np.ndarray:
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    return among(ends, edges, n).reshape(-1, 3)


def _region(problem: CGCProblem, region: int, own: IntArray, target: Optional[float], given: Optional[Edges], free: int) -> _Laid:
    """Return a region in the plane; its new vertices are numbered from `free`."""
    edges = edge_faces(problem.faces[own])
    faces, origin = cut_open(problem.faces[own], edges[edges[:, 3] >= 0])
    V = problem.vertices[origin]
    inner = ~boundary_vertices(V, faces)
    defect = np.where(inner, np.abs(angle_defects(V, faces)), 0.0)
    asked = problem.roles[origin] == INTERNAL
    cones = (defect > CONE_DEFECT) & ~asked
    flat = target == 0.0 or (target is None and not (defect[asked] > GAP_TOLERANCE).any())
    if given is None:
        cuts = seam_edges(V, faces, cones if flat else _ends_of_a_slit(V, inner))
        if flat and len(cuts):
            cut, cuts = straightened(V, faces, cuts)
            origin = np.r_[origin, free + np.arange(len(cut.vertices) - len(V))]
            V, faces, own = cut.vertices, cut.faces, own[cut.parent]
    else:
        every = edge_faces(faces)[:, :2]
        cuts = every[among(origin[every], given, len(problem.vertices))]
    layout = unfold(V, faces, cuts)
    size = float(np.linalg.norm(np.ptp(V, axis=0)))
    if given is not None and not opens_to_disks(layout.faces) and layout.gap > GAP_TOLERANCE * size:
        raise CGCError(_no_seam(region))
    if flat and layout.gap > GAP_TOLERANCE * size:
        worst = problem.names.vertices[origin[np.argmax(np.where(asked, defect, 0.0))]]
        raise CGCError(
            f"region {region} does not unroll: gaps of up to {layout.gap:.3g} {unit_symbol(problem.drawing.units)} "
            f"({100 * layout.gap / size:.2g} % of its size), the largest at vertex {worst}; "
            "solve it for K = 0 first, on irregular meshes with the measure exact"
        )
    if not flat:
        if not opens_to_disks(layout.faces):
            raise CGCError(_no_seam(region))
        plane = flatten(V[layout.origin], layout.faces).plane[layout.faces]
        gap, error = 0.0, float("nan")
    else:
        plane, gap, error = layout.plane[layout.faces], layout.gap, layout.edge_error
        cuts = cuts[~_close_again(faces, plane, cuts, GAP_TOLERANCE * size)]
    fresh = V[origin >= free]
    return _Laid(plane, origin[faces], own, fresh, origin[cuts], Unrolling(region, target, flat, gap, error, len(cuts)))


def _ends_of_a_slit(vertices: Vertices, inner: Mask) -> Mask:
    """Return the mask of two distant vertices between which a closed surface is slit; empty for others (n,)."""
    ends = np.zeros(len(vertices), bool)
    if inner.all():
        first = int(np.argmax(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1)))
        ends[[first, int(np.argmax(np.linalg.norm(vertices - vertices[first], axis=1)))]] = True
    return ends


def _no_seam(region: int) -> str:
    return (
        f"region {region} has a hole that none of the given seams opens; draw a seam from the hole to the outer boundary, or omit all seams"
    )


def _close_again(faces: IntArray, plane: FloatArray, cuts: Edges, tolerance: float) -> np.ndarray:
    """Return which cut edges (s, 2) have coincident sides in the plane."""
    edges = edge_faces(faces)
    edges = edges[among(edges[:, :2], cuts, int(faces.max()) + 1)]
    u, v, left, right = edges.T
    apart = np.zeros(len(edges))
    for w in (u, v):
        here, there = (plane[side, np.argmax(faces[side] == w[:, None], axis=1)] for side in (left, right))
        apart = np.maximum(apart, np.linalg.norm(here - there, axis=1))
    together = edges[apart <= tolerance, :2]
    return among(cuts, together, int(faces.max()) + 1)
