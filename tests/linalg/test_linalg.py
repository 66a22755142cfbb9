"""Sparse systems: every backend gives the same answers, and says when there is none."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete.jacobian import CurvatureEquations
from compas_cgc.discrete.laplacian import cotangent_stiffness
from compas_cgc.linalg import SingularMatrixError
from compas_cgc.linalg import factorise
from compas_cgc.linalg import linear_solver
from compas_cgc.linalg import nearly_solved
from compas_cgc.linalg import nested_dissection

from ..support import shapes


def installed(backend):
    package = {"pardiso": "pypardiso", "amg": "pyamg"}.get(backend)
    return pytest.param(backend, marks=pytest.mark.skipif(bool(package) and find_spec(package) is None, reason=f"no {package}"))


DIRECT = [installed("superlu"), installed("pardiso")]
SYMMETRIC = [installed("multifrontal"), *DIRECT]
ALL = [*SYMMETRIC, installed("amg")]


@pytest.fixture(scope="module")
def meshed():
    """Return the equations of a dome and its vertices."""
    vertices, faces = shapes.grid(24)
    x, y, _ = vertices.T
    vertices = np.column_stack([x, y, 3 * x * (1 - x) * y * (1 - y)])
    inner = np.flatnonzero(~boundary_vertices(vertices, faces))
    return CurvatureEquations(faces, np.ones(len(vertices)), inner, inner), vertices


def stiffness(meshed):
    equations, vertices = meshed
    return cotangent_stiffness(vertices, equations.pattern), vertices[equations.rows]


def jacobian(meshed, lift=1.0):
    equations, vertices = meshed
    up = np.tile([0.0, 0.0, 1.0], (len(equations.columns), 1))
    return equations.jacobian(vertices * [1, 1, lift], up), vertices[equations.rows]


def right_side(n):
    return np.random.default_rng(5).normal(size=n)


@pytest.mark.parametrize("backend", ALL)
def test_a_symmetric_system(meshed, backend):
    A, points = stiffness(meshed)
    b = right_side(A.shape[0])
    x = factorise(A, symmetric=True, points=points, backend=backend).solve(b)
    assert np.abs(A @ x - b).max() < 1e-9


@pytest.mark.parametrize("backend", DIRECT)
@pytest.mark.parametrize("placed", [True, False])
def test_an_unsymmetric_system(meshed, backend, placed):
    A, points = jacobian(meshed)
    assert abs(A - A.T).max() > 1e-3
    b = right_side(A.shape[0])
    x = factorise(A, points=points if placed else None, backend=backend).solve(b)
    assert np.abs(A @ x - b).max() < 1e-9
    assert np.allclose(x, np.linalg.solve(A.toarray(), b), rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("backend", ALL)
def test_several_right_sides_at_once(meshed, backend):
    A, points = stiffness(meshed)
    B = np.column_stack([right_side(A.shape[0]), np.ones(A.shape[0])])
    X = factorise(A, symmetric=True, points=points, backend=backend).solve(B)
    assert X.shape == B.shape
    assert np.abs(A @ X - B).max() < 1e-9


@pytest.mark.parametrize("backend", DIRECT)
def test_one_solver_takes_matrix_after_matrix_of_one_sparsity_or_another(meshed, backend):
    first, points = jacobian(meshed)
    second, _ = jacobian(meshed, lift=1.3)
    other = sparse.diags(np.arange(1.0, first.shape[0] + 1)).tocsr()
    solver = linear_solver(first.shape[0], points=points, backend=backend)
    b = right_side(first.shape[0])
    for A in (first, second, other, first):
        assert np.abs(A @ solver.factorise(A).solve(b) - b).max() < 1e-9


@pytest.mark.parametrize("backend", DIRECT)
def test_as_many_entries_in_other_places_are_another_sparsity(meshed, backend):
    A, _ = jacobian(meshed)
    n = A.shape[0]
    order = np.random.default_rng(2).permutation(n)
    other = A[order][:, order].tocsr()
    other.sort_indices()
    assert other.nnz == A.nnz and not np.array_equal(other.indices, A.indices)
    # Without refinement, which would find wrong factors out and make others.
    solver, b = linear_solver(n, backend=backend, refine=False), right_side(n)
    x = solver.factorise(A).solve(b)
    assert np.allclose(solver.factorise(other).solve(b[order]), x[order], rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("backend", DIRECT)
def test_the_matrix_is_left_as_it_was(meshed, backend):
    A, points = jacobian(meshed)
    before = A.copy()
    factorise(A, points=points, backend=backend).solve(right_side(A.shape[0]))
    assert np.array_equal(A.data, before.data) and np.array_equal(A.indices, before.indices)


def test_pivots_leave_the_diagonal_where_they_must():
    tiny = 1e-30
    A = sparse.csr_matrix([[tiny, 1.0, 0.0], [1.0, tiny, 2.0], [0.0, 2.0, 1.0]])
    b = np.array([1.0, 2.0, 3.0])
    x = factorise(A, points=np.arange(3.0)[:, None], backend="superlu").solve(b)
    assert np.allclose(A @ x, b)


def test_where_the_diagonal_is_worth_nothing_the_pivots_are_chosen_anew():
    """A cycle with a whiff of a diagonal: its inverse is the cycle backwards, and no refinement makes up for such pivots."""
    n = 12
    cycle = sparse.csr_matrix((np.ones(n), ((np.arange(n) + 1) % n, np.arange(n))), shape=(n, n))
    solver = linear_solver(n, backend="superlu")
    b = right_side(n)
    for _ in range(2):
        assert np.allclose(solver.factorise(cycle + 1e-20 * sparse.identity(n)).solve(b), np.roll(b, -1), rtol=1e-12, atol=1e-12)
        A = (cycle + 3 * sparse.identity(n)).tocsr()
        assert np.abs(A @ solver.factorise(A).solve(b) - b).max() < 1e-12, "the next matrix has a diagonal again"
    full = np.random.default_rng(7).normal(size=(n, n))
    full[np.diag_indices(n)] = 1e-30
    several = np.column_stack([b, np.ones(n)])
    assert np.allclose(factorise(sparse.csr_matrix(full), backend="superlu").solve(several), np.linalg.solve(full, several), rtol=1e-8)


@pytest.mark.parametrize("backend", SYMMETRIC)
def test_the_same_system_gives_the_same_bits_wherever_it_lies_in_memory(backend):
    line = sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(150, 150))
    grid = sparse.csr_matrix(sparse.kronsum(line, line))
    n = grid.shape[0]
    for A in (grid, (grid @ grid).tocsr()):
        solver = factorise(A, symmetric=True, refine=False, backend=backend)
        answers = set()
        for shift in range(8):
            b = np.zeros(n + 8)[shift : shift + n]
            b[:] = right_side(n)
            answers.add(solver.solve(b).tobytes())
        assert len(answers) == 1


@pytest.mark.parametrize("backend", SYMMETRIC)
def test_without_refinement_a_good_matrix_is_solved_as_well(meshed, backend):
    A, _ = stiffness(meshed)
    solver = factorise(A, symmetric=True, refine=False, backend=backend)
    for b in (right_side(A.shape[0]), np.column_stack([right_side(A.shape[0]), np.ones(A.shape[0])])):
        assert np.abs(A @ solver.solve(b) - b).max() < 1e-9


def test_refinement_is_what_a_poor_pivot_needs():
    A = sparse.csr_matrix([[1e-12, 1.0], [1.0, 1e-12]])
    b = np.array([1.1, 2.3])
    refined, plain = (np.abs(A @ factorise(A, refine=refine, backend="superlu").solve(b) - b).max() for refine in (True, False))
    assert refined < 1e-9 < 1e-6 < plain


def test_a_middling_pivot_needs_refinement_and_no_new_pivots(monkeypatch):
    A = sparse.csr_matrix([[1e-8, 1.0], [1.0, 1e-8]])
    b = np.array([1.1, 2.3])
    calls = []
    monkeypatch.setattr("compas_cgc.linalg.superlu.splu", lambda *args, **more: calls.append(more) or splu(*args, **more))
    refined, plain = (np.abs(A @ factorise(A, refine=refine, backend="superlu").solve(b) - b).max() for refine in (True, False))
    assert refined < 1e-14 < 1e-11 < plain and len(calls) == 2


@pytest.mark.parametrize("backend", DIRECT)
def test_no_inverse_is_an_error_in_words(backend):
    A = sparse.csr_matrix([[1.0, 1.0], [1.0, 1.0]])
    with pytest.raises(SingularMatrixError):
        factorise(A, backend=backend).solve(np.array([1.0, 0.0]))


def entries(matrix, order="NATURAL"):
    return splu(matrix.tocsc(), permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True}).nnz


@pytest.mark.parametrize("placed", [True, False])
def test_nested_dissection_orders_everything_once_and_keeps_the_factors_sparse(meshed, placed):
    A, points = stiffness(meshed)
    order = nested_dissection(A, points if placed else None)
    assert sorted(order.tolist()) == list(range(A.shape[0]))
    assert entries(A[order][:, order]) < 0.7 * entries(A)


@pytest.mark.parametrize("placed", [True, False])
def test_nested_dissection_keeps_its_way_where_minimum_degree_loses_it(placed):
    """A closed mesh, nearly all of whose vertices have six neighbours."""
    vertices, faces = shapes.icosphere(4)
    A = neighbours(len(vertices), faces)
    order = nested_dissection(A, vertices if placed else None)
    assert entries(A[order][:, order]) < 0.5 * entries(A, "MMD_AT_PLUS_A")


def neighbours(n, faces):
    """Return the Laplacian of the graph of a mesh, and one."""
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    graph = sparse.csr_matrix((np.ones(len(u)), (u, v)), shape=(n, n)).maximum(sparse.csr_matrix((np.ones(len(u)), (v, u)), shape=(n, n)))
    return (sparse.diags(1.0 + np.asarray(graph.sum(axis=1)).ravel()) - graph).tocsr()


def test_nested_dissection_takes_parts_that_are_not_joined_apart(meshed):
    A, _ = stiffness(meshed)
    order = nested_dissection(A)
    one = entries(A[order][:, order])
    mixed = np.random.default_rng(1).permutation(3 * A.shape[0])
    three = sparse.block_diag([A] * 3).tocsr()[mixed][:, mixed]
    order = nested_dissection(three)
    assert entries(three[order][:, order]) < 1.1 * 3 * one


def test_nested_dissection_copes_with_points_on_one_spot():
    A = sparse.csr_matrix(np.ones((40, 40)))
    for points in (np.zeros((40, 3)), None):
        assert sorted(nested_dissection(A, points, leaf=1).tolist()) == list(range(40))


def test_nothing_is_ordered_too():
    assert nested_dissection(sparse.csr_matrix((0, 0))).shape == (0,)


def test_systems_go_to_the_backend_that_is_the_fastest_for_them():
    assert type(linear_solver(100)).__name__ == type(linear_solver(300_000)).__name__ == "SuperLU"
    assert type(linear_solver(100_000, symmetric=True)).__name__ == "Multifrontal"


@pytest.mark.skipif(find_spec("pypardiso") is None, reason="no pypardiso")
def test_large_symmetric_systems_go_to_pardiso():
    assert type(linear_solver(300_000, symmetric=True, refine=False)).__name__ == "Pardiso"


def test_unknown_and_unfit_backends_are_named():
    with pytest.raises(ValueError, match="'auto' or one of multifrontal, superlu, pardiso, amg, not 'umfpack'"):
        linear_solver(10, backend="umfpack")
    for backend in ("multifrontal", "amg"):
        with pytest.raises(ValueError, match=f"'{backend}' solves symmetric matrices only"):
            linear_solver(10, backend=backend)


def test_factors_of_a_matrix_near_by_solve_to_the_tolerance_or_say_that_they_are_too_far(meshed):
    equations, vertices = meshed
    up, lower = np.tile([0.0, 0.0, 1.0], (len(equations.columns), 1)), vertices * [1.0, 1.0, 0.8]
    matrix, right = equations.jacobian(vertices, up), np.cos(np.arange(len(equations.rows)))
    for tolerance in (0.3, 1e-3):
        found = nearly_solved(matrix, factorise(equations.jacobian(lower, up)).solve, right, tolerance)
        assert 0.0 < np.linalg.norm(matrix @ found - right) <= 1.001 * tolerance * np.linalg.norm(right)
    assert nearly_solved(matrix, lambda v: v, right, 1e-3) is None
    assert nearly_solved(matrix, lambda v: np.nan * v, right, 1e-3) is None
    assert not nearly_solved(matrix, lambda v: v, 0.0 * right, 1e-3).any()
