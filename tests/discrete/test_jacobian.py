"""The derivatives of the curvature equations agree with differences, on good triangles and bad."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.discrete import MeshError
from compas_cgc.discrete import angle_defects
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import mean_curvature
from compas_cgc.discrete import vertex_areas
from compas_cgc.discrete import vertex_normals
from compas_cgc.discrete.jacobian import CurvatureEquations
from compas_cgc.discrete.laplacian import cotangent_laplacian


def bumpy_grid(cells: int, shear: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a square grid of triangles, shaken and sheared until many are obtuse."""
    rng = np.random.default_rng(7)
    x, y = np.meshgrid(np.arange(cells + 1.0), np.arange(cells + 1.0), indexing="ij")
    vertices = np.column_stack([x.ravel() + shear * y.ravel(), y.ravel(), 0 * x.ravel()])
    vertices += rng.uniform(-0.15, 0.15, vertices.shape)
    i, j = np.divmod(np.arange(cells**2), cells)
    a = i * (cells + 1) + j
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    return vertices, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def obtuse_share(vertices: np.ndarray, faces: np.ndarray) -> float:
    edges = vertices[np.roll(faces, -1, axis=1)] - vertices[faces]
    dots = -np.einsum("fcx,fcx->fc", edges, np.roll(edges, 1, axis=1))
    return float((dots < 0).any(axis=1).mean())


def problem(shear: float) -> tuple[np.ndarray, CurvatureEquations]:
    vertices, faces = bumpy_grid(6, shear)
    inside = np.flatnonzero(~boundary_vertices(vertices, faces))
    movable = np.flatnonzero(np.arange(len(vertices)) % 5 != 3)
    targets = np.linspace(-2, 3, len(vertices))
    return vertices, CurvatureEquations(faces, targets, inside, movable)


def central_difference(function, vertices: np.ndarray, move: np.ndarray) -> np.ndarray:
    step = 1e-6
    return (function(vertices + step * move) - function(vertices - step * move)) / (2 * step)


SHEARS = pytest.mark.parametrize("shear, obtuse", [(0.45, 0.2), (1.4, 0.99)], ids=["regular", "obtuse"])


@SHEARS
def test_residual_is_defect_less_target_times_mixed_area(shear, obtuse):
    vertices, equations = problem(shear)
    assert (obtuse_share(vertices, equations.faces) >= 0.99) == (obtuse == 0.99)
    expected = angle_defects(vertices, equations.faces) - equations.targets * vertex_areas(vertices, equations.faces)
    assert np.allclose(equations.residual(vertices), expected[equations.rows], rtol=0, atol=1e-14)


@SHEARS
def test_full_jacobian_is_the_difference_quotient(shear, obtuse):
    vertices, equations = problem(shear)
    J = equations.jacobian(vertices)
    assert J.shape == (len(equations.rows), 3 * len(equations.columns))
    expected = np.empty(J.shape)
    for at, vertex in enumerate(equations.columns):
        for x in range(3):
            move = np.zeros_like(vertices)
            move[vertex, x] = 1.0
            expected[:, 3 * at + x] = central_difference(equations.residual, vertices, move)
    assert np.abs(J.toarray() - expected).max() < 1e-8


@SHEARS
def test_jacobian_along_normals_is_the_full_one_times_the_normals(shear, obtuse):
    vertices, equations = problem(shear)
    normals = vertex_normals(vertices, equations.faces)[equations.columns]
    J = equations.jacobian(vertices, normals)
    full = equations.jacobian(vertices).toarray().reshape(len(equations.rows), -1, 3)
    assert np.allclose(J.toarray(), np.einsum("rcx,cx->rc", full, normals), rtol=0, atol=1e-12)


def test_taylor_remainder_is_of_second_order():
    vertices, equations = problem(0.45)
    move = np.zeros_like(vertices)
    move[equations.columns] = np.random.default_rng(3).normal(size=(len(equations.columns), 3))
    r, J = equations.residual(vertices), equations.jacobian(vertices)

    def remainder(t):
        return np.linalg.norm(equations.residual(vertices + t * move) - r - t * (J @ move[equations.columns].ravel()))

    steps = np.array([1e-3, 5e-4, 2.5e-4])
    slope = np.polyfit(np.log(steps), np.log([remainder(t) for t in steps]), 1)[0]
    assert 1.9 < slope < 2.1


def test_moving_and_turning_everything_changes_no_defect():
    vertices, faces = bumpy_grid(5, 0.3)
    inside = np.flatnonzero(~boundary_vertices(vertices, faces))
    equations = CurvatureEquations(faces, np.ones(len(vertices)), inside, np.arange(len(vertices)))
    J = equations.jacobian(vertices)
    for move in (np.tile([1.0, -2.0, 0.5], (len(vertices), 1)), np.cross([0.3, 0.8, -0.2], vertices)):
        assert np.abs(J @ move.ravel()).max() < 1e-12


def test_sparsity_is_the_ring_of_each_vertex():
    vertices, equations = problem(0.45)
    J = equations.jacobian(vertices)
    assert J.has_sorted_indices
    ring = {int(v): set() for v in equations.rows}
    for face in equations.faces.tolist():
        for v in face:
            if v in ring:
                ring[v].update(face)
    place = {int(v): c for c, v in enumerate(equations.columns)}
    for row, vertex in enumerate(equations.rows):
        columns = {int(c) // 3 for c in J.indices[J.indptr[row] : J.indptr[row + 1]]}
        assert columns == {place[v] for v in ring[int(vertex)] if v in place}


def test_no_equation_on_an_open_boundary():
    vertices, faces = bumpy_grid(3, 0.0)
    with pytest.raises(MeshError, match="vertex 0 has no closed ring"):
        CurvatureEquations(faces, np.ones(len(vertices)), [5, 0], [5])


# ----------------------------------------------------------------------
# The cotangent Laplacian, on the same sparsity
# ----------------------------------------------------------------------


def test_the_laplacian_knows_constants_and_is_symmetric_and_negative():
    vertices, faces = bumpy_grid(5, 0.3)
    L = cotangent_laplacian(vertices, faces)
    assert abs(L - L.T).max() < 1e-14
    assert np.abs(L @ np.ones(len(vertices))).max() < 1e-12
    assert np.linalg.eigvalsh(L.toarray()).max() < 1e-10


def test_the_laplacian_of_a_linear_function_on_a_plane_vanishes_inside():
    vertices, faces = bumpy_grid(5, 0.3)
    vertices[:, 2] = 0.0
    inside = ~boundary_vertices(vertices, faces)
    assert np.abs((cotangent_laplacian(vertices, faces) @ vertices)[inside]).max() < 1e-12


def test_the_laplacian_of_the_coordinates_is_twice_the_mean_curvature():
    from ..support import shapes

    vertices, faces = shapes.icosphere(3, radius=2.0)
    vectors = cotangent_laplacian(vertices, faces) @ vertices
    H = mean_curvature(vertices, faces)
    assert np.allclose(np.linalg.norm(vectors, axis=1), 2 * H * vertex_areas(vertices, faces))


def test_leaving_the_areas_out_leaves_the_derivative_of_the_defects():
    vertices, equations = problem(0.45)
    bare = CurvatureEquations(equations.faces, np.zeros(len(vertices)), equations.rows, equations.columns)
    assert np.array_equal(equations.jacobian(vertices, areas=False).data, bare.jacobian(vertices).data)


def test_cells_that_keep_their_kind_have_smooth_areas_beyond_a_right_angle():
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    flat = np.array([[0.0, 0.0, 0.0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    equations = CurvatureEquations(faces, np.ones(5), [0], [0, 1])
    kept = equations.with_cells_of(flat)
    move = np.zeros((5, 3))
    move[1] = [0.0, -1.0, 0.0]

    def slope(which, at):
        return (which.jacobian(flat + at * move) @ move[[0, 1]].ravel()).item()

    # The angle at the middle becomes obtuse: mixed areas have a kink, and areas of cells that keep their kind have none.
    assert abs(slope(equations, 1e-6) - slope(equations, -1e-6)) > 1e-2
    assert abs(slope(kept, 1e-6) - slope(kept, -1e-6)) < 1e-5
    for at in (-0.2, 0.0, 0.2):
        step = 1e-6
        difference = (kept.residual(flat + (at + step) * move) - kept.residual(flat + (at - step) * move)) / (2.0 * step)
        assert slope(kept, at) == pytest.approx(difference.item(), abs=1e-8)
    assert np.array_equal(equations.residual(flat), kept.residual(flat))
