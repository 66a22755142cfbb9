"""What goes wrong in solves: a status and a sentence each, a good surface, no NaN, an end."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import FlowSettings
from compas_cgc import NewtonSettings
from compas_cgc import ProjectionSettings
from compas_cgc import solve
from compas_cgc.discrete import face_areas
from compas_cgc.errors import MeshError
from compas_cgc.errors import ProblemError
from compas_cgc.model.result import STATUSES
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.newton import newton
from compas_cgc.solvers.projection import project

from ..support import shapes


def grid(n=9, target=0.005):
    mesh = CGCMesh.from_meshgrid(dx=n, nx=n)
    mesh.set_supports("boundary")
    mesh.set_target(target)
    return mesh


def infeasible():
    """A target below the bound of the check, but more than a creased mesh's regions can carry."""
    mesh = grid(9, 0.3)
    mesh.set_creases([[40 + j for j in range(10)]])
    return mesh


def wild_neighbours():
    mesh = grid(12, 1e-6)
    mesh.set_creases([[13 * i + 6 for i in range(13)]])
    mesh.set_target(0.01, region=1)
    return mesh


def a_region_of_one_face():
    mesh = grid()
    face = mesh.face_vertices(60)
    mesh.set_creases([[*face, face[0]]])
    return mesh


def an_island():
    mesh = grid(12)
    path = [13 * 4 + j for j in range(4, 9)] + [13 * i + 8 for i in range(5, 9)]
    path += [13 * 8 + j for j in range(7, 3, -1)] + [13 * i + 4 for i in range(7, 3, -1)]
    mesh.set_creases([path])
    mesh.set_target(0.02, region=1)
    return mesh


def nearly_flat_triangles():
    """Needles of one to a thousand along one edge."""
    vertices, faces = shapes.grid(8, 8.0)
    vertices[vertices[:, 0] == 1.0, 0] = 1e-3
    mesh = CGCMesh.from_vertices_and_faces(vertices, faces)
    mesh.set_supports("boundary")
    mesh.set_target(0.005)
    return mesh


def a_spike():
    mesh = grid()
    mesh.vertex_attribute(44, "z", 20.0)
    return mesh


def noise():
    mesh = grid(15, 0.003)
    rng = np.random.default_rng(0)
    for key in mesh.vertices():
        if mesh.vertex_role(key) == "internal":
            mesh.vertex_attribute(key, "z", float(rng.normal(scale=0.3)))
    return mesh


CASES = [infeasible, wild_neighbours, a_region_of_one_face, an_island, nearly_flat_triangles, a_spike, noise]
LONG = (infeasible, nearly_flat_triangles)
SOLVED = (wild_neighbours, a_region_of_one_face, an_island, nearly_flat_triangles)  # by `auto`
METHODS = {
    "auto": None,
    "flow": FlowSettings(steps=300),
    "newton": NewtonSettings(),
    "projection": ProjectionSettings(steps=60),
}


# All methods on every case; those of `auto` that go through all searches run nightly.
EVERY = [
    pytest.param(make, method, id=f"{make.__name__}-{method}", marks=[pytest.mark.nightly] if method == "auto" and make in LONG else [])
    for make in CASES
    for method in METHODS
]


@pytest.mark.parametrize("make, method", EVERY)
def test_every_method_ends_with_a_status_a_sentence_and_a_surface(make, method):
    mesh = make()
    result = solve(mesh, method=method, settings=METHODS[method])
    vertices, faces = result.mesh.arrays()
    assert result.status in STATUSES and len(result.message) > 20 and "nan" not in result.message.lower()
    assert np.isfinite(vertices).all() and np.isfinite(result.max_error)
    size = np.linalg.norm(np.ptp(mesh.arrays()[0], axis=0))
    assert np.linalg.norm(np.ptp(vertices, axis=0)) < 10 * size, "blown up"
    assert result.converged or method != "auto" or make not in SOLVED, result.message
    if result.converged:
        assert face_areas(vertices, faces).min() > 0
    for v in mesh.supports():
        assert result.mesh.vertex_coordinates(v) == mesh.vertex_coordinates(v)


def test_more_than_a_boundary_carries_is_refused_in_arrays_too():
    vertices, faces = shapes.grid(9, 9.0)
    rim = (np.minimum(vertices[:, 0], vertices[:, 1]) == 0) | (np.maximum(vertices[:, 0], vertices[:, 1]) == 9)
    problem = CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), 0.06)
    solution = newton(problem)
    assert solution.status == "infeasible" and np.array_equal(solution.vertices, vertices)


def test_a_piece_that_nothing_holds_is_refused_by_name():
    vertices, faces = shapes.grid(3)
    mesh = CGCMesh.from_vertices_and_faces(np.vstack([vertices, vertices + [5, 0, 0]]), np.vstack([faces, faces + len(vertices)]))
    mesh.set_supports([0, 3, 12, 15])
    mesh.set_target(0.1)
    with pytest.raises(ProblemError, match="the piece of the mesh with vertex 16 has no supports; fix some of its vertices or remove it"):
        solve(mesh)


@pytest.mark.parametrize("solver", [newton, pytest.param(project, marks=pytest.mark.nightly)], ids=lambda solver: solver.__name__)
def test_one_bad_triangle_among_thousands_is_named_or_survived(solver):
    vertices, faces = shapes.grid(60)
    rim = (np.minimum(vertices[:, 0], vertices[:, 1]) == 0) | (np.maximum(vertices[:, 0], vertices[:, 1]) == 1)
    roles = np.where(rim, FIXED, INTERNAL)
    vertices[1830] = vertices[1831]
    try:
        solution = solver(CGCProblem(vertices, faces, roles, 1.0))
    except MeshError as error:
        assert "183" in str(error)
    else:
        assert solution.status in STATUSES and np.isfinite(solution.vertices).all()
    faces[1000, 2] = 10**6
    with pytest.raises(MeshError, match="face 1000 names a vertex that does not exist"):
        CGCProblem(vertices, faces, roles, 1.0)


def test_one_bad_triangle_in_a_mesh_is_found_by_the_check():
    mesh = grid(60, 1e-4)
    mesh.vertex[1830].update(mesh.vertex[1831])
    (problem,) = [p for p in mesh.check() if p.fatal]
    assert "degenerate (zero area)" in problem
