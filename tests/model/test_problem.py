"""Problems as arrays: the same answers as through COMPAS, without it."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.analysis import analyse
from compas_cgc.errors import ProblemError
from compas_cgc.meshing import boundary_loops
from compas_cgc.meshing import triangles_of
from compas_cgc.model.checks import check
from compas_cgc.model.roles import DUMMY
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL

from ..support import shapes


def vault():
    """Three strips between two creases, on their corners."""
    mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    mesh.set_supports("corners")
    mesh.set_creases([[10 * i + k for i in range(10)] for k in (3, 6)])
    mesh.set_target(0.004)
    mesh.set_target(0.01, region=1)
    return mesh


def renamed(mesh):
    """Return the mesh with other keys in another order, and how the old positions are now called."""
    order = np.random.default_rng(3).permutation(mesh.number_of_vertices())
    names = {key: int(7 * order[i] + 5) for i, key in enumerate(mesh.vertices())}
    other = CGCMesh.from_vertices_and_faces(
        {names[v]: mesh.vertex_coordinates(v) for v in mesh.vertices()},
        {3 * f: [names[v] for v in mesh.face_vertices(f)] for f in mesh.faces()},
    )
    other.set_creases([[names[v] for v in path] for path in mesh.creases()])
    other.set_supports([names[v] for v in mesh.supports()])
    for v in mesh.vertices():
        other.vertex_target(names[v], mesh.vertex_target(v))
    return other


@pytest.mark.parametrize("mesh", [vault(), renamed(vault())], ids=["plain keys", "any keys"])
def test_arrays_and_meshes_are_solved_alike(mesh):
    problem = CGCProblem.from_mesh(mesh)
    result, solution = solve(mesh), solve(problem)
    assert solution.status == "converged" and solution.method == result.method
    assert np.array_equal(result.mesh.arrays()[0], solution.vertices)
    assert result.message == solution.message
    assert analyse(mesh).to_dict() == analyse(problem).to_dict()


def test_keys_do_not_matter():
    mesh, other = vault(), renamed(vault())
    assert {len(faces) for faces in other.regions()} == {len(faces) for faces in mesh.regions()}
    assert [len(loop) for loop in other.boundary_loops()] == [len(loop) for loop in mesh.boundary_loops()] == [36]
    assert other.check() == mesh.check() == []
    other.delete_vertex(other.supports()[0])
    mesh.delete_vertex(mesh.supports()[0])
    assert len(other.check()) == len(mesh.check())


def test_dummies_are_left_out_and_come_back():
    mesh = vault()
    mesh.add_dummy_ring()
    with_ring = CGCProblem.from_mesh(mesh)
    plain = CGCProblem.from_mesh(vault())
    real = with_ring.without_dummies()
    assert (with_ring.roles == DUMMY).sum() == 36
    for name in ("vertices", "faces", "roles", "targets", "creases"):
        assert np.array_equal(getattr(real, name), getattr(plain, name)), name


def test_what_is_wrong_with_arrays_is_said_by_positions():
    vertices, faces = shapes.grid(4)
    roles = np.where(np.arange(len(vertices)) < 5, FIXED, INTERNAL)
    good = CGCProblem(vertices, faces, roles, 0.01)
    assert check(good) == []
    sentences = {
        "no support": CGCProblem(vertices, faces, np.full(len(vertices), INTERNAL), 0.01),
        "creases 0-24 do not follow": CGCProblem(vertices, faces, roles, 0.01, creases=[[0, 24]]),
        "no target curvature is set": CGCProblem(vertices, faces, roles, np.nan),
        "targets of vertices 7 are not finite": CGCProblem(vertices, faces, roles, np.where(np.arange(len(vertices)) == 7, np.inf, 0.01)),
        "no faces": CGCProblem(vertices, np.empty((0, 3), int), roles, 0.01),
    }
    for part, problem in sentences.items():
        with pytest.raises(ProblemError, match=part):
            solve(problem)


def test_loops_have_the_surface_to_their_left():
    vertices, faces = shapes.grid(3)
    (loop,) = boundary_loops(faces)
    x, y = vertices[loop, :2].T
    assert len(loop) == 12 and loop[0] == 0
    assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == pytest.approx(np.prod(np.ptp(vertices[:, :2], axis=0)))
    assert boundary_loops(shapes.icosphere(1)[1]) == []


def test_polygons_know_whose_triangles_they_are():
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]]
    triangles, owner = triangles_of(vertices, [[0, 1, 2, 3], [1, 4, 4], [1, 4, 2]])
    assert owner.tolist() == [0, 0, 2] and triangles.shape == (3, 3)
    triangles, owner = triangles_of(vertices, [[0, 1, 2], [1, 4, 4], [1, 4, 2]])
    assert owner.tolist() == [0, 2] and triangles.tolist() == [[0, 1, 2], [1, 4, 2]]


def test_a_closed_mesh_is_not_told_to_hold_an_edge_that_it_has_not():
    ball = CGCProblem([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    said = next(text for text in check(ball.with_targets(0.1)) if "no support" in text)
    assert "--supports boundary" not in said and "closed" in said


def test_over_an_edge_without_area_nothing_is_refused():
    # A pocket: its edge runs forth and back along one line.
    vertices = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, 0], [1, 0.2, -1]]
    problem = CGCProblem(vertices, [[i, (i + 1) % 4, 4] for i in range(4)]).with_supports("boundary").with_targets(0.1)
    assert not any("is more than" in text for text in check(problem))


def test_a_prompt_shows_problems_and_results_in_one_line():
    import compas_cgc

    result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    told = repr(result)
    assert "\n" not in told and repr(result.problem) in told and told.endswith(f"{result.ending}>")
    assert "247 vertices, 432 faces" in told


def test_a_dummy_ring_does_not_join_regions():
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    mesh.set_creases([[21, 22, 23, 24, 25, 26, 27]])
    mesh.add_dummy_ring()
    problem = mesh.to_problem().with_targets({0: 0.02, 1: 0.04})
    assert problem.number_of_regions() == len(mesh.regions()) == 2 and problem.region_targets() == [0.02, 0.04]
    assert (problem.regions() == 2).sum() == (~problem.real_faces).sum() > 0
    for number, faces in enumerate(mesh.regions()):
        assert problem.names.faces[problem.regions() == number].tolist() == faces
