"""Panels as the regions of a finer mesh, so that they are laid out like regions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import CGCError
from ..meshing.level_cuts import CutMesh
from ..meshing.level_cuts import uncut
from ..model.problem import CGCProblem
from ..model.problem import Names
from ..model.roles import INTERNAL
from .layout import among
from .panelling import Panel

__all__ = ["PanelRegions", "panel_regions"]


class PanelRegions(NamedTuple):
    """A surface whose regions are panels."""

    problem: CGCProblem  # with the cut mesh, and creases along creases and joints; targets of new vertices are not set
    parent: IntArray  # (m',) face of the surface that contains each face
    panel: IntArray  # (r',) panel of each region of it
    creases: Edges  # (c, 2) creases of the surface, with the vertices that joints add to them


def panel_regions(problem: CGCProblem, panels: Sequence[Panel]) -> PanelRegions:
    """Return a surface divided along joints, with one region per panel.

    The vertices may have moved since the panels were made; their joints move along with the faces.

    Raises
    ------
    CGCError
        If the panels do not contain every face exactly once.
    """
    given: object = panels
    if not isinstance(given, (list, tuple)) or not given or not all(hasattr(own, "cut") for own in given):
        raise CGCError(f"panels must be the result of panels(surface, ...), not {panels!r:.60}")
    cut = panels[0].cut
    whole = uncut(problem.vertices, problem.faces) if cut is None else cut
    faces, parent = whole.faces, whole.parent
    if parent.max(initial=0) >= len(problem.faces):
        raise CGCError("the panels belong to another surface; divide this surface into panels")
    vertices = np.empty((len(whole.vertices), 3))
    vertices[faces] = np.einsum("fcw,fwk->fck", whole.weights, problem.vertices[problem.faces[parent]])
    piece = np.full(len(faces), -1)
    for number, panel in enumerate(panels):
        if (panel.cut is None) != (cut is None) or panel.faces.max(initial=0) >= len(faces) or (piece[panel.faces] >= 0).any():
            raise CGCError(
                f"panel {panel.name} overlaps another panel or belongs to another division; give the result of one call of panels"
            )
        piece[panel.faces] = number
    if (piece < 0).any():
        raise CGCError("the panels do not cover the surface; give the complete result of panels(surface, ...)")
    edges = edge_faces(faces)
    inner = edges[edges[:, 3] >= 0]
    creases = inner[_on_creases(problem, inner, whole), :2]
    joints = inner[piece[inner[:, 2]] != piece[inner[:, 3]], :2]
    old, fresh = problem.names.vertices, len(vertices) - len(problem.vertices)
    roles, targets = np.r_[problem.roles, np.full(fresh, INTERNAL)], np.r_[problem.targets, np.full(fresh, np.nan)]
    names = Names(np.r_[old, old.max(initial=-1) + 1 + np.arange(fresh)], np.arange(len(faces)))
    both = np.unique(np.sort(np.vstack([creases, joints]), axis=1), axis=0)
    divided = CGCProblem(vertices, faces, roles, targets, creases=both, names=names, drawing=problem.drawing)
    label = divided.regions()
    order = np.zeros(int(label.max(initial=-1)) + 1, np.int64)
    order[label] = piece
    return PanelRegions(divided, parent, order, creases)


def _on_creases(problem: CGCProblem, inner: IntArray, cut: CutMesh) -> Mask:
    """Return the mask of inner edges (e, 4) that lie on creases of the surface."""
    left, right = cut.parent[inner[:, 2]], cut.parent[inner[:, 3]]
    found = np.zeros(len(inner), bool)
    for k in range(3):
        # An edge lies on a side of a mesh face if the opposite corner has no weight at its ends.
        at = [np.argmax(cut.faces[inner[:, 2]] == inner[:, [end]], axis=1) for end in (0, 1)]
        off = np.max([cut.weights[inner[:, 2], one, k] for one in at], axis=0)
        side = problem.faces[left][:, [(k + 1) % 3, (k + 2) % 3]]
        found |= (off == 0.0) & (left != right) & among(side, problem.creases, len(problem.vertices))
    return found
