"""Parts of mesh faces that form a panel, in position and on its mould."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..meshing.level_cuts import uncut
from ..meshing.split_sides import weighted
from ..model.problem import CGCProblem
from . import space_form
from .development import Development
from .layout import cut_open
from .panelling import Panel

__all__ = ["PanelParts", "PartsOnMould", "on_mould", "parts_of"]


class PanelParts(NamedTuple):
    """The faces of a panel as parts of whole mesh faces.

    A joint cuts a flat face along a straight line; with the same barycentric weights it cuts the congruent face on the mould into
    congruent parts. The layout uses whole faces, so that slivers beside joints do not matter.
    """

    whole: Faces  # (m, 3) corners of the mesh faces that it covers at least partly
    own_faces: Indices  # (m,) their numbers in the mesh
    vertices: Vertices  # (p, 3) vertices in position [L]
    faces: Faces  # (f, 3) indices into `vertices`
    within: IntArray  # (f,) index into `whole` for every face
    weights: FloatArray  # (f, 3, 3) barycentric weights of the corners in the whole face
    cut: bool  # whether some faces are parts only
    turned: bool  # whether the orientation of the mesh is reversed


class PartsOnMould(NamedTuple):
    """Positions of the vertices of a panel on its mould."""

    on_form: FloatArray  # (p, 3) points of the space form
    lifted: FloatArray  # (p, 3) lifted points, on joints those of chords and facets of whole faces, see space_form.lifted
    gap: float  # largest distance between the positions of a vertex in different faces [L]
    edge_error: float  # largest relative difference of edges on the mould


def parts_of(problem: CGCProblem, panel: Panel, turned: bool = False) -> PanelParts:
    """Return the faces of a panel as parts of mesh faces, with reversed orientation if `turned`."""
    mesh = uncut(problem.vertices, problem.faces) if panel.cut is None else panel.cut
    own = np.asarray(panel.faces)
    faces, weights, parent = mesh.faces[own], mesh.weights[own], mesh.parent[own]
    # Given faces keep their order.
    numbers, within = (own, np.arange(len(own))) if panel.cut is None else np.unique(parent, return_inverse=True)
    whole = problem.faces[numbers]
    if turned:
        faces, whole, weights = faces[:, ::-1], whole[:, ::-1], weights[:, ::-1, ::-1]
    edges = edge_faces(faces)
    opened, origin = cut_open(faces, edges[edges[:, 3] >= 0])
    return PanelParts(whole, numbers, mesh.vertices[origin], opened, within.reshape(-1), weights, panel.cut is not None, turned)


def on_mould(parts: PanelParts, laid: Development, arc: bool) -> PartsOnMould:
    """Return the positions of the vertices of a panel on the mould of its laid-out whole faces.

    Barycentric weights are kept: along the chords of edges, or along their arcs if edges are arc lengths.
    """
    K = laid.K
    if not parts.cut:
        return PartsOnMould(laid.points, space_form.lifted(laid.points), laid.gap, laid.edge_error)
    corners = laid.points[laid.faces][parts.within]
    if arc and K != 0.0:
        points = weighted(_along_arcs(parts.weights, corners, K), corners).reshape(-1, 3)
        lifted = space_form.lifted(space_form.normalised(points, K)).reshape(corners.shape)
    else:
        lifted = weighted(parts.weights, space_form.lifted(corners.reshape(-1, 3)).reshape(corners.shape))
    places = np.empty((len(parts.vertices), 3))
    places[parts.faces.reshape(-1)] = lifted.reshape(-1, 3)
    gap = float(space_form.straight(lifted - places[parts.faces], K).max(initial=0.0))
    error = _edge_error(parts, places, K, arc)
    return PartsOnMould(space_form.from_lifted(places, K), places, max(laid.gap, gap), max(laid.edge_error, error))


def _along_arcs(weights: FloatArray, corners: FloatArray, K: float) -> FloatArray:
    """Return weights (f, 3, 3) with those of points on sides changed to the same fraction of arc length."""
    changed = weights.copy()
    root = math.sqrt(abs(K))
    sine = np.sin if K > 0.0 else np.sinh
    for side in range(3):
        a, b = side, (side + 1) % 3
        long = root * space_form.geodesics(space_form.chords(corners[:, a], corners[:, b], K), K)
        on = weights[:, :, (side + 2) % 3] == 0.0
        angle = np.broadcast_to(long[:, None], on.shape)[on]
        for corner in (a, b):
            changed[..., corner][on] = sine(weights[..., corner][on] * angle) / sine(angle)
    return changed


def _edge_error(parts: PanelParts, lifted: FloatArray, K: float, arc: bool) -> float:
    """Return the largest relative difference between edges of a panel and those on its mould; with arcs only along mesh edges."""
    ahead = np.roll(parts.faces, -1, axis=1)
    long = np.linalg.norm(parts.vertices[ahead] - parts.vertices[parts.faces], axis=2)
    there = space_form.straight(lifted[ahead] - lifted[parts.faces], K)
    if arc:
        there = space_form.geodesics(there, K)
        along = ((parts.weights == 0.0) & (np.roll(parts.weights, -1, axis=1) == 0.0)).any(axis=2)
        there = np.where(along, there, long)
    return float((np.abs(there - long) / long).max(initial=0.0))
