"""Measures of K: how it is read off a mesh."""

from __future__ import annotations

import numpy as np

from ..discrete import gaussian_curvature
from ..discrete import vertex_areas
from ..discrete.arrays import IntArray
from ..discrete.arrays import PerVertex
from ..discrete.smooth_measure import is_regular
from ..discrete.smooth_measure import layout_errors
from ..discrete.space_form import EXACT
from ..discrete.space_form import space_form_angle_sums
from ..meshing.flat_corners import has_corners
from ..meshing.flat_corners import turned_corners
from .problem import CGCProblem
from .roles import FIXED

__all__ = ["is_smooth_alone", "measured_curvature", "read_across"]

CORNERED = 1500, 4000  # vertices of regular meshes whose corners count: smaller ones are to be quick, larger ones differ little


def measured_curvature(problem: CGCProblem, measure: str = "defect") -> PerVertex:
    """Return K (n,) of the vertices of a problem where it is asked for, else NaN [1/L^2].

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    measure
        ``defect``: angle defect over area (Eq. 10). ``smooth``: less what the layout of the mesh puts into it, across
        :func:`read_across`.
        ``exact``, ``exact-arc``: the target and what the triangles of its space form leave open, over the area.
    """
    asked = problem.asked
    if measure in EXACT:
        targets = np.where(asked, problem.targets, 0.0)
        left = 2.0 * np.pi - space_form_angle_sums(problem.vertices, problem.faces, targets, measure == "exact-arc")
        return np.where(asked, targets + left / np.where(asked, vertex_areas(problem.vertices, problem.faces), 1.0), np.nan)
    faces = read_across(problem) if measure == "smooth" else problem.faces
    K = gaussian_curvature(problem.vertices, faces)
    if measure == "smooth":
        K = K - layout_errors(problem.vertices, faces, asked)
    return np.where(asked, K, np.nan)


def read_across(problem: CGCProblem) -> IntArray:
    """Return the triangles (m, 3) across which the smooth measure reads K.

    They are those of the problem, but where one lies flat in a corner between three fixed vertices: there the diagonal is
    turned into the corner, as that of the mesh cuts the corner off, whatever the surface.
    """
    return turned_corners(problem.vertices, problem.faces, problem.roles == FIXED, problem.creases)


def is_smooth_alone(problem: CGCProblem) -> bool:
    """Return whether angle defects misread K in the corners of an edge held all around, so that a dome is too low.

    They do where a face of an irregular mesh lies flat there, and on a regular mesh wherever K > 0, as curvatures grow without
    bounds towards a straight edge that is held.
    """
    if problem.constraints or not problem.asked.any() or not problem.real_faces.all():
        return False
    if not is_regular(problem.faces, problem.asked):
        return read_across(problem) is not problem.faces
    (few, many), held = CORNERED, problem.roles == FIXED
    convex = bool((problem.targets[problem.asked] > 0.0).all())
    return convex and few <= len(held) <= many and has_corners(problem.vertices, problem.faces, held)
