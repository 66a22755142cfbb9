"""What designers ask besides K is fulfilled exactly, together with K."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import boundary_vertices
from compas_cgc.errors import ProblemError
from compas_cgc.meshing.closest_points import feet_on_polyline
from compas_cgc.model.constraints import Fixed
from compas_cgc.model.constraints import Height
from compas_cgc.model.constraints import Mirror
from compas_cgc.model.constraints import OnCurve
from compas_cgc.model.constraints import OnLine
from compas_cgc.model.constraints import OnPlane
from compas_cgc.model.constraints import Proximity
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL
from compas_cgc.solvers.projection import project

from ...support import shapes

N = 20
I, J = np.divmod(np.arange((N + 1) ** 2), N + 1)
EDGE = np.flatnonzero((I == 0) & (J > 0) & (J < N))
RIDGE = np.flatnonzero((I == N // 2) & (J > 0) & (J < N))
CENTRE = int(np.flatnonzero((I == N // 2) & (J == N // 2))[0])
T = np.linspace(0, np.pi, 60)
ARCH = np.column_stack([0 * T, 5 - 5 * np.cos(T), 1.5 * np.sin(T)])


def roof(target: float = 0.01, crease: bool = False) -> CGCProblem:
    """A flat roof of ten by ten metres on four corners."""
    vertices, faces = shapes.grid(N, 10.0)
    roles = np.where(boundary_vertices(vertices, faces), FREE, INTERNAL)
    roles[np.isin(I, (0, N)) & np.isin(J, (0, N))] = FIXED
    if crease:
        roles[RIDGE] = CREASE
    return CGCProblem(vertices, faces, roles, target)


def solved(constraints, problem=None) -> np.ndarray:
    solution = project((problem or roof()).with_goals(constraints))
    assert solution.status == "converged", solution.message
    assert solution.max_error < 1e-12
    return solution.vertices


def test_an_edge_in_a_plane():
    upright = solved([OnPlane(EDGE, (0, 0, 0), (2, 0, 0))])
    assert np.abs(upright[EDGE, 0]).max() < 1e-13
    tilted = solved([OnPlane(EDGE, (0, 0, 0), (1, 0, 0.5))])
    assert np.abs(tilted[EDGE] @ [1, 0, 0.5]).max() < 1e-13 and np.ptp(tilted[EDGE, 0]) > 0.1


def test_a_crown_at_a_height_and_a_level_edge():
    for height in (0.8, 1.5):
        assert solved([Height([CENTRE], height)])[CENTRE, 2] == pytest.approx(height, abs=1e-13)
    level = solved([Height(EDGE, 0.6)])
    assert np.abs(level[EDGE, 2] - 0.6).max() < 1e-13 and np.ptp(level[:, 2]) > 0.6


def test_an_edge_on_a_line():
    vertices = solved([OnLine(EDGE, (0, 0, 0.5), (0, 3, 0))])
    assert np.abs(vertices[EDGE][:, [0, 2]] - [0, 0.5]).max() < 1e-13


@pytest.mark.parametrize("curve", [ARCH, ARCH[::12]], ids=["fine", "coarse"])
def test_an_edge_on_an_arch(curve):
    vertices = solved([OnCurve(EDGE, curve)])
    assert np.linalg.norm(feet_on_polyline(vertices[EDGE], curve)[0] - vertices[EDGE], axis=1).max() < 1e-13
    assert (np.diff(vertices[EDGE, 1]) > 0).all(), "in order along the curve"


def test_a_crease_free_held_or_drawn_to_a_curve():
    free = solved([], roof(crease=True))
    held = solved([Fixed(RIDGE)], roof(crease=True))
    assert np.array_equal(held[RIDGE], roof().vertices[RIDGE]), "bit for bit"
    high = ARCH + [5, 0, 1.0]
    drawn = solved([OnCurve(RIDGE, high)], roof(crease=True))
    assert np.linalg.norm(feet_on_polyline(drawn[RIDGE], high)[0] - drawn[RIDGE], axis=1).max() < 1e-13
    assert 0 < free[RIDGE, 2].max() < drawn[RIDGE, 2].max()


def test_several_constraints_at_once_and_on_one_vertex():
    vertices = solved([OnCurve(EDGE, ARCH), Height([CENTRE], 1.2), OnPlane([CENTRE], (5, 0, 0), (1, 0, 0))])
    assert vertices[CENTRE, [0, 2]] == pytest.approx([5, 1.2], abs=1e-13)


def test_near_vertices_move_less():
    problem = roof()
    problem.vertices[:, 2] = 0.1 * I * (N - I) / N + 0.05 * np.sin(J) * (problem.roles != FIXED)
    loose, near = (np.linalg.norm((solved(c, problem) - problem.vertices)[RIDGE]) for c in ([], [Proximity(RIDGE, 1000.0)]))
    assert near < 0.5 * loose


def symmetric_roof() -> CGCProblem:
    """A lopsided, shaken shape on a mesh whose diagonals are symmetric about both middle lines."""
    problem = roof()
    quad = I * (N + 1) + J
    quad = quad[(I < N) & (J < N)]
    i, j = np.divmod(quad, N + 1)
    turned = (i < N / 2) ^ (j < N / 2)
    a, b, c, d = quad, quad + N + 1, quad + N + 2, quad + 1
    even, odd = ([a, b, c], [a, c, d]), ([a, b, d], [b, c, d])
    faces = [np.column_stack(corners)[~turned] for corners in even] + [np.column_stack(corners)[turned] for corners in odd]
    x, y = problem.vertices[:, 0], problem.vertices[:, 1]
    z = 0.8 * np.sin(np.pi * x / 10) * np.sin(np.pi * y / 10) + 0.01 * np.sin(0.5 * x) * y
    z += 0.01 * np.random.default_rng(0).normal(size=len(x))
    vertices = np.column_stack([x, y, np.where(problem.roles == FIXED, 0, z)])
    return CGCProblem(vertices, np.vstack(faces), problem.roles, 0.01)


LEFT_RIGHT, FRONT_BACK, DIAGONAL = Mirror((5, 5, 0), (1, 0, 0)), Mirror((5, 5, 0), (0, 2, 0)), Mirror((5, 5, 0), (1, -1, 0))


@pytest.mark.parametrize(
    "mirrors, turns",
    [
        ([LEFT_RIGHT], [(N - I, J, [-1, 1, 1])]),
        ([LEFT_RIGHT, FRONT_BACK], [(N - I, J, [-1, 1, 1]), (N - I, N - J, [-1, -1, 1])]),
        ([LEFT_RIGHT, DIAGONAL], [(N - I, J, [-1, 1, 1]), (I, N - J, [1, -1, 1])]),
    ],
    ids=["one", "two", "eightfold"],
)
def test_mirrors_make_a_lopsided_start_symmetric(mirrors, turns):
    arms = solved(mirrors, symmetric_roof()) - [5, 5, 0]
    for i, j, signs in turns:
        assert np.abs(arms[i * (N + 1) + j] * signs - arms).max() < 1e-13
    if DIAGONAL in mirrors:
        assert np.abs(arms[J * (N + 1) + I][:, [1, 0, 2]] - arms).max() < 1e-13


def test_mirrors_and_curves_together():
    vertices = solved([LEFT_RIGHT, OnCurve(EDGE, ARCH)], symmetric_roof())
    other = EDGE + N * (N + 1)
    assert np.abs(vertices[other] * [-1, 1, 1] + [10, 0, 0] - vertices[EDGE]).max() < 1e-13
    assert np.linalg.norm(feet_on_polyline(vertices[EDGE], ARCH)[0] - vertices[EDGE], axis=1).max() < 1e-13


def test_constraints_that_contradict_each_other_stall_and_name_the_vertex():
    with pytest.raises(ProblemError, match=f"the height 1.5 of vertices and the height 1 of vertices .* at vertex {CENTRE}"):
        project(roof().with_goals([Height([CENTRE], 1.0), Height([CENTRE], 1.5)]))
    with pytest.raises(ProblemError, match=f"the level plane at 1.5 and the height 1 of vertices .* at vertex {CENTRE}"):
        project(roof().with_goals([Height([CENTRE], 1.0), OnPlane([CENTRE], (0, 0, 1.5), (0, 0, 1))]))
    solution = project(roof().with_goals([Height([CENTRE], 1.0), OnLine([CENTRE], (0, 0, 1.5), (1, 0, 0))]))
    assert solution.status == "stalled"
    assert f"vertex {CENTRE} cannot fulfil its constraints: the height of vertices and " in solution.message
    assert np.isfinite(solution.vertices).all()


@pytest.mark.parametrize(
    "constraint, words",
    [
        (Height([0], 2.0), "vertex 0 is fixed, but not where a constraint requires it"),
        (Height([7, 10_000], 2.0), "names vertex 10000, but the mesh has vertices 0 to 440"),
        (Fixed([-1]), "names vertex -1"),
        (Mirror((4, 5, 0), (1, 0, 0)), "has no mirror image of its own"),
        ([Mirror((5, 5, 0), (1, 0, 0)), Mirror((5.01, 5, 0), (1, 0, 0))], "images of a vertex"),
    ],
    ids=["fixed", "missing", "negative", "lopsided", "endless"],
)
def test_constraints_that_cannot_be_are_refused(constraint, words):
    with pytest.raises(ProblemError, match=words):
        project(roof().with_goals(constraint))


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: project(roof().with_goals([OnPlane([CENTRE], (0, 0, 1), (0, 0, 0))])), "normal of a plane must be three numbers"),
        (lambda: OnCurve([1], [(0, 0, 0)]), "two or more different points"),
        (lambda: Height([1], float("nan")), "height must be a number"),
        (lambda: Proximity([1], -1.0), "weight must be a positive number"),
    ],
)
def test_constraints_without_sense_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_nearest_points_slide_along_a_polyline_and_stop_at_its_ends():
    corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0]], float)
    points = np.array([[0.3, -0.2, 0], [1.5, -0.5, 0], [1, 1.7, 0], [-1, 0.1, 0]])
    feet, slide = feet_on_polyline(points, corner)
    assert np.allclose(feet, [[0.3, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]])
    assert np.allclose(slide, [[1, 0, 0], [0.5**0.5, 0.5**0.5, 0], [0, 0, 0], [0, 0, 0]])
    feet, slide = feet_on_polyline(np.array([[0.2, 0.4, 0]]), corner, closed=True)
    assert np.allclose(feet, [[0.3, 0.3, 0]]) and np.allclose(np.abs(slide), [[0.5**0.5, 0.5**0.5, 0]])
