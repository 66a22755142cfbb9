"""Irregular meshes of known surfaces with K > 0, held at their rims, from starts 3 % off: no wrinkles are left, on finer meshes neither."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_normals
from compas_cgc.discrete import vertex_normals
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL

from ..system.fairness_study import mesh
from ..system.fairness_study import outline
from ..system.fairness_study import profile

SIZE = 0.5


def wavy(kind: str, count: int) -> CGCProblem:
    """A Delaunay patch of a surface of revolution, with waves of 3 % of its size within its rim."""
    rng = np.random.default_rng(0)
    plan, faces = mesh(outline("disc", rng), "delaunay", count, rng)
    radius, height, K = profile(kind, SIZE * plan[:, 1])
    turn = SIZE * plan[:, 0] / float(profile(kind, np.array([-SIZE, 0.0, SIZE]))[0][1])
    vertices = np.column_stack([radius * np.sin(turn), -radius * np.cos(turn), height])
    roles = np.where(boundary_vertices(vertices, faces), FIXED, INTERNAL)
    wave = 0.03 * SIZE * np.sin(3 * plan[:, 0] + 1) * np.cos(3 * plan[:, 1] + 2) * (roles == INTERNAL)
    return CGCProblem(vertices + wave[:, None] * vertex_normals(vertices, faces), faces, roles, K)


def onto(kind: str, vertices: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Return the points of the surface of revolution next to vertices."""
    radius, height, _ = profile(kind, heights)
    # The profile's lowest point has height 0; at the rim both are on the surface.
    rho = np.hypot(vertices[:, 0], vertices[:, 1])
    at = cKDTree(np.column_stack([radius, height])).query(np.column_stack([rho, vertices[:, 2]]))[1]
    return np.column_stack([vertices[:, :2] * (radius[at] / rho)[:, None], height[at]])


def folds(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    edges = edge_faces(faces)
    edges = edges[edges[:, 3] >= 0]
    left, right = face_normals(vertices, faces)[edges[:, 2:].T]
    along = vertices[edges[:, 1]] - vertices[edges[:, 0]]
    sine = np.einsum("ij,ij->i", np.cross(left, right), along / np.linalg.norm(along, axis=1)[:, None])
    return np.arctan2(sine, np.einsum("ij,ij->i", left, right))


@pytest.mark.parametrize("count", [300, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["sphere", "bulge", "spindle"])
def test_no_wrinkles_are_left(kind, count):
    problem = wavy(kind, count)
    rng = np.random.default_rng(0)
    plan, _ = mesh(outline("disc", rng), "delaunay", count, rng)
    result = solve(problem)
    assert result.converged and result.measure == "smooth" and result.verdict.fair, result.message
    true = onto(kind, result.vertices, np.linspace(SIZE * plan[:, 1].min(), SIZE * plan[:, 1].max(), 400_001))
    asked = folds(true, problem.faces)
    assert np.linalg.norm(folds(result.vertices, problem.faces) - asked) <= 1e-3 * np.linalg.norm(asked)
    cosine = np.einsum("ij,ij->i", vertex_normals(true, problem.faces), vertex_normals(result.vertices, problem.faces))
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() <= 0.05
