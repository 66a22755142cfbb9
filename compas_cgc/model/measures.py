"""Measures of K on a mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete import gaussian_curvature
from ..discrete import vertex_areas
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import PerVertex
from ..discrete.corners import corner_angles
from ..discrete.measured_curvature import MeasuredCurvature
from ..discrete.measured_curvature import measured_curvature as mid_edge_curvature
from ..discrete.smooth_measure import layout_errors
from ..discrete.space_form import EXACT
from ..discrete.space_form import space_form_angle_sums
from ..discrete.topology import within_rings
from ..meshing import boundary_loops
from ..meshing.flat_corners import turned_corners
from ..meshing.regions import vertex_labels
from .goals.binding import with_level_edges_held
from .inward_edges import MIN_CORNER
from .problem import CGCProblem
from .roles import CREASE
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL
from .visible import NEAR
from .visible import on_held_edges

__all__ = [
    "MID_EDGE",
    "has_drifted",
    "has_free_edges",
    "inward_supports",
    "is_held_all_round",
    "is_held_along_edges",
    "known_measure",
    "measure_of",
    "measured_curvature",
    "measured_mean_curvature",
    "read_across",
    "read_inwards",
    "with_free_edges_held",
]

MID_EDGE = "mid-edge"
MAX_MEASURE_DRIFT = 1e-6  # error of K over the largest |K̄| when the smooth measure is evaluated again; settled corrections leave 1e-10


def known_measure(name: object) -> str:
    """Return the name of a measure that was read from a file, empty if there is none of that name."""
    return str(name) if name in ("defect", "smooth", *EXACT, MID_EDGE) else ""


def measure_of(problem: CGCProblem) -> str:
    """Return the measure in which K is read off a surface: that of its solve, else by what is known to be accurate on it."""
    origin = problem.origin
    if origin is not None and origin.measure and len(origin.vertices) == len(problem.vertices):
        return origin.measure
    return "smooth" if is_held_all_round(problem) or is_held_along_edges(problem) else MID_EDGE


def measured_curvature(problem: CGCProblem, measure: str = "") -> PerVertex:
    """Return the Gaussian curvature at each vertex, NaN where none is prescribed or can be read (n,) [1/L^2].

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    measure
        ``defect``: angle defect over area (Eq. 10). ``smooth``: the same on the triangles of :func:`read_across`, less the
        error due to the layout of the mesh. ``exact``, ``exact-arc``: the target, plus the angle defect of triangles in the
        space form of the target over the area. ``mid-edge``: shape operators by mid-edge normals, of second order on any triangles,
        where :func:`read_inwards` says.
        Default: that of :func:`measure_of`.
    """
    asked, measure = problem.asked, measure or measure_of(problem)
    if measure == MID_EDGE:
        found = _by_mid_edges(problem)
        return np.where(asked & read_inwards(problem), found.at_vertices(found.gaussian, len(asked)), np.nan)
    if measure in EXACT:
        targets = np.where(asked, problem.targets, 0.0)
        left = 2.0 * np.pi - space_form_angle_sums(problem.vertices, problem.faces, targets, measure == "exact-arc")
        return np.where(asked, targets + left / np.where(asked, vertex_areas(problem.vertices, problem.faces), 1.0), np.nan)
    faces = read_across(problem) if measure == "smooth" else problem.faces
    K = gaussian_curvature(problem.vertices, faces)
    if measure == "smooth":
        K = K - layout_errors(problem.vertices, faces, asked)
    return np.where(asked, K, np.nan)


def has_drifted(problem: CGCProblem, K: PerVertex) -> bool:
    """Return whether K (n,) read off a surface again, with the error due to its layout estimated anew, is not what was asked for."""
    off = np.abs(K - problem.targets)[problem.asked]
    return bool(off.max(initial=0.0) > MAX_MEASURE_DRIFT * problem.target_scale)


def measured_mean_curvature(problem: CGCProblem) -> PerVertex:
    """Return the mean curvature by mid-edge normals at each vertex, NaN where :func:`measured_curvature` is (n,) [1/L].

    It is positive where the surface is convex to the side of its normals.
    """
    found = _by_mid_edges(problem)
    read = problem.asked & read_inwards(problem) if measure_of(problem) == MID_EDGE else problem.asked
    return np.where(read, found.at_vertices(found.mean, len(problem.vertices)), np.nan)


def read_inwards(problem: CGCProblem) -> Mask:
    """Return the internal vertices (n,) at which mid-edge normals read curvature.

    They are more than two edges from supports, where the exact surface may be singular: beside a straight edge with K > 0, or
    beside a point that carries a smooth edge. Regions without such vertices are read everywhere.
    """
    internal, real = problem.roles == INTERNAL, problem.real_faces
    supports = (problem.roles == FIXED) | on_held_edges(problem)
    inwards = internal & ~within_rings(problem.faces[real], supports, NEAR)
    region = vertex_labels(len(internal), problem.faces[real], problem.regions()[real])
    return inwards | (internal & ~np.isin(region, region[inwards]))


def _by_mid_edges(problem: CGCProblem) -> MeasuredCurvature:
    real = problem.real_faces
    return mid_edge_curvature(problem.vertices, problem.faces[real], problem.creases, problem.regions()[real])


def read_across(problem: CGCProblem) -> IntArray:
    """Return the triangles (m, 3) on which the smooth measure reads K.

    They are those of the problem except for faces with three fixed vertices in a corner. There the diagonal is flipped so that
    it runs into the corner, because a face between supports stays flat whatever the surface. Vertices on free edges count as fixed if the
    free edges are found before the surface between them, see :func:`is_held_along_edges`.
    """
    real, faces = problem.real_faces, problem.faces.copy()
    held = with_level_edges_held(problem).roles == FIXED
    held |= (problem.roles == FREE) & is_held_along_edges(problem)
    faces[real] = turned_corners(problem.vertices, faces[real], held, problem.creases)
    return faces


def has_free_edges(problem: CGCProblem) -> bool:
    """Return whether some vertex of the rim is not fixed."""
    return bool((problem.roles[boundary_vertices(problem.vertices, problem.faces)] != FIXED).any())


def inward_supports(problem: CGCProblem) -> list[int]:
    """Return the supports at reentrant corners between free edges, which a surface of K > 0 can rarely pass."""
    angles = np.bincount(problem.faces.ravel(), corner_angles(problem.vertices, problem.faces).ravel(), len(problem.vertices))
    held = problem.roles == FIXED
    found = []
    for loop in boundary_loops(problem.faces):
        alone = held[loop] & ~held[np.roll(loop, 1)] & ~held[np.roll(loop, -1)]
        found += loop[alone & (angles[loop] > np.pi + MIN_CORNER)].tolist()
    return sorted(found)


def with_free_edges_held(problem: CGCProblem) -> CGCProblem:
    """Return a problem whose free edges are fixed in place."""
    return replace(problem, roles=np.where(problem.roles == FREE, FIXED, problem.roles))


def is_held_all_round(problem: CGCProblem) -> bool:
    """Return whether the whole rim is held, there are no creases, and K̄ > 0 everywhere, so that rim and K̄ determine the surface.

    Towards a straight fixed edge one principal curvature is unbounded there. Bending energy is infinite and angle defects are of first
    order in the length of edges, whereas the smooth measure is of order 1.5.
    """
    problem = with_level_edges_held(problem.without_dummies())
    rim = boundary_vertices(problem.vertices, problem.faces)
    held = bool((problem.roles[rim] == FIXED).all() and rim.any())
    return held and not (problem.roles == CREASE).any() and _is_elliptic(problem)


def is_held_along_edges(problem: CGCProblem) -> bool:
    """Return whether edges of the rim are held, K̄ > 0 everywhere, and creases or free edges are unknown."""
    problem = with_level_edges_held(problem.without_dummies())
    edges = edge_faces(problem.faces)
    held = (problem.roles[edges[edges[:, 3] < 0, :2]] == FIXED).all(axis=1)
    return bool(held.any()) and not (held.all() and not (problem.roles == CREASE).any()) and _is_elliptic(problem)


def _is_elliptic(problem: CGCProblem) -> bool:
    types = problem.types[problem.asked]
    return bool(len(types) and (types > 0).all())
