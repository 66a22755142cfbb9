"""Bending of panels from their moulds into position: differences of shape operators, and the stress of a plate."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.measured_curvature import even_angles
from ..discrete.mid_edge import PACKED
from ..discrete.mid_edge import MidEdgeMesh
from ..discrete.topology import edge_faces
from ..model.problem import CGCProblem
from ..model.roles import FIXED
from .materials import Material
from .materials import bending_stress
from .mould_surface import MouldSurface
from .patchwork import weights_in
from .shape_operators import shape_operators
from .shell.singular import between_hills_and_bowls

__all__ = ["corner_operators", "curvature_changes", "fitted_operators", "plate_stress", "unbounded_curvature"]

STRAIGHT = np.radians(0.5)  # turn of a held edge at a vertex up to which it counts as straight
MIN_SPREAD = 0.05  # area between the centroids around the corners, relative to their face, below which operators are not extrapolated
SHARP = np.radians(45.0)  # turn of a held edge or a crease from which its vertex counts as a corner


def corner_operators(problem: CGCProblem) -> FloatArray:
    """Return the shape operators at the corners of every face as matrices in space, positive if convex (m, 3, 3, 3) [1/L].

    An average by mid-edge normals over the faces of a region around a vertex stands for their centroid. Within each face the operator
    is linear between these centroids, so that the error is of second order in the length of edges also at boundaries and creases.
    """
    V, F = problem.vertices, problem.faces
    normals = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    areas = 0.5 * np.linalg.norm(normals, axis=1, keepdims=True)
    mesh = MidEdgeMesh(F, problem.creases, problem.regions(), np.zeros((len(V), 3)))
    references = np.zeros((len(mesh.angles.ends), 3))
    for corner in range(3):
        np.add.at(references, mesh.angles.of_faces[:, corner], 0.5 * normals / areas)
    mesh.references = references
    averages = mesh.averages(mesh.at(V, even_angles(mesh, V)))
    own = (averages.tensors / averages.areas[:, None])[mesh.pair_of]
    centroids = (mesh.incidence @ (areas * V[F].mean(axis=1)) / (mesh.incidence @ areas))[mesh.pair_of]
    shares = weights_in(np.repeat(V[F], 3, axis=0), centroids.reshape(-1, 3)).reshape(-1, 3, 3)
    clear = np.linalg.det(shares) > MIN_SPREAD
    own[clear] = np.linalg.solve(shares[clear], own[clear])
    return np.asarray(own[:, :, PACKED], dtype=np.float64)


def fitted_operators(problem: CGCProblem, otherwise: FloatArray) -> FloatArray:
    """Return shape operators at the corners of faces by polynomials fitted to rings of vertices of one region (m, 3, 3, 3) [1/L].

    Their errors are independent of those of `otherwise` (m, 3, 3, 3), which stand where a region has too few vertices.
    """
    V, F, label = problem.vertices, problem.faces, problem.regions()
    found = otherwise.copy()
    for number in np.unique(label):
        own = label == number
        fits = shape_operators(V, F[own]).operators[F[own]]
        found[own] = np.where(np.isfinite(fits), fits, otherwise[own])
    return found


def curvature_changes(surface: MouldSurface, on_form: FloatArray, places: FloatArray, operators: FloatArray) -> FloatArray:
    """Return the principal changes of curvature at the corners of faces from a mould into position (m, 3, 2) [1/L].

    The larger one in size comes first. Both second fundamental forms are taken on the edges of the same triangle, so that the principal
    directions of the mould and of the panel may differ.

    Parameters
    ----------
    surface
        The mould.
    on_form
        (m, 3, 3) corners of the faces as points of the space form, with the rotation on the mould.
    places
        (m, 3, 3) corners in position [L].
    operators
        (m, 3, 3, 3) shape operators at the corners in position, with the normals of the mould's side [1/L].
    """
    edges = places[:, 1:] - places[:, :1]
    first = np.einsum("fik,fjk->fij", edges, edges)
    own = np.einsum("fik,fckl,fjl->fcij", edges, operators, edges)
    lower = np.linalg.inv(np.linalg.cholesky(first))[:, None]
    changes = np.linalg.eigvalsh(lower @ (own - surface.second_forms(on_form, first)) @ lower.transpose(0, 1, 3, 2))
    return np.asarray(np.take_along_axis(changes, np.argsort(-np.abs(changes), axis=2, kind="stable"), axis=2), dtype=np.float64)


def plate_stress(material: Material, thickness: float, changes: FloatArray) -> FloatArray:
    """Return the largest bending stress of plates from principal changes of curvature (..., 2) with their signs (...) [Pa].

    The principal stresses are ``E t (Δ1 + ν Δ2) / 2 (1 - ν²)`` and ``E t (Δ2 + ν Δ1) / 2 (1 - ν²)``. In a ductile material the von
    Mises stress counts where it is larger, which it is where the changes have opposite signs.

    Parameters
    ----------
    material
        Material of the plate.
    thickness
        Thickness of the plate [m].
    changes
        Changes of curvature [1/m].
    """
    principal = bending_stress(material, thickness, 1.0) * (changes + material.poisson * changes[..., ::-1])
    largest = np.abs(principal).max(axis=-1)
    if material.ductile:
        largest = np.maximum(largest, np.sqrt((principal**2).sum(axis=-1) - principal.prod(axis=-1)))
    return np.asarray(largest, dtype=np.float64)


def unbounded_curvature(problem: CGCProblem) -> dict[str, Mask]:
    """Return the vertices where the curvature of the surface is unbounded, so that stress grows as the mesh is refined (n,), by cause.

    These are point supports, corners of held edges, where K > 0 straight held edges, which such a surface cannot contain, and ends,
    crossings and kinks of creases. Along a smooth crease curvature is bounded, unless it lies between hills and bowls.
    """
    V, n = problem.vertices, len(problem.vertices)
    fixed = problem.roles == FIXED
    edges = edge_faces(problem.faces)
    held = edges[(edges[:, 3] < 0) & fixed[edges[:, :2]].all(axis=1), :2]
    after, before = np.full(n, -1), np.full(n, -1)
    after[held[:, 0]], before[held[:, 1]] = held[:, 1], held[:, 0]
    chain = np.flatnonzero((after >= 0) & (before >= 0))
    turn = _turns(V, before[chain], chain, after[chain])
    elliptic = np.zeros(n, bool)
    targets = np.array([0.0 if K is None else K for K in problem.region_targets()])
    elliptic[problem.faces[targets[problem.regions()] > 0.0]] = True
    corners, straight, kinks = np.zeros((3, n), bool)
    corners[chain] = turn > SHARP
    straight[chain] = (turn < STRAIGHT) & elliptic[chain]
    creases = np.unique(np.sort(problem.creases, axis=1), axis=0)
    arms = np.bincount(creases.ravel(), minlength=n)
    # Both neighbours along the crease, of every vertex within one.
    one, other = np.vstack([creases, creases[:, ::-1]])[np.argsort(np.concatenate(creases.T), kind="stable")].T
    within = arms[one] == 2
    middle, (back, ahead) = one[within][::2], other[within].reshape(-1, 2).T
    kinks[middle] = _turns(V, back, middle, ahead) > SHARP
    return {
        "a point support": fixed & (after < 0) & (before < 0),
        "a corner of a held edge": corners,
        "a straight held edge (K > 0)": straight,
        "an end of a crease": arms == 1,
        "a crossing of creases": arms > 2,
        "a kink of a crease": kinks,
        "a crease between a hill and a bowl": between_hills_and_bowls(problem),
    }


def _turns(V: FloatArray, before: IntArray, at: IntArray, after: IntArray) -> FloatArray:
    """Return the turn of paths at vertices (k,) [rad]."""
    ahead, back = V[after] - V[at], V[at] - V[before]
    return np.arctan2(np.linalg.norm(np.cross(back, ahead), axis=1), np.einsum("ij,ij->i", back, ahead))
