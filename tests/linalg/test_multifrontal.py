"""Factors of symmetric matrices of either sign, against dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from compas_cgc.linalg import SingularMatrixError
from compas_cgc.linalg.multifrontal import Multifrontal


def saddle(squares: int, seed: int) -> tuple[sparse.csr_matrix, np.ndarray]:
    """Return a saddle matrix over a grid of squares, and places: a Laplacian with negative entries, and equations of some unknowns."""
    random = np.random.default_rng(seed)
    line = sparse.diags([-np.ones(squares - 1), 2.0 * np.ones(squares), -np.ones(squares - 1)], [-1, 0, 1])
    n = squares**2
    W = sparse.kronsum(line, line) + sparse.diags(random.normal(size=n))
    rows = np.sort(random.choice(n, n // 3, replace=False))
    J = sparse.csr_matrix(sparse.kronsum(line, line))[rows]
    whole = sparse.bmat([[W, J.T], [J, -1e-6 * sparse.identity(len(rows))]]).tocsr()
    whole.sort_indices()
    grid = np.stack(np.meshgrid(np.arange(squares), np.arange(squares)), axis=-1).reshape(-1, 2)
    return whole, np.vstack([grid, grid[rows]]).astype(np.float64)


@pytest.mark.parametrize("squares", [1, 2, 5, 12, 60])
def test_solutions_and_signs_of_eigenvalues_are_those_of_dense_matrices(squares):
    # 60: unknowns are ordered by dissection, and the widest front has several blocks of pivots.
    A, points = saddle(squares, 1)
    factors, right = Multifrontal(points), np.random.default_rng(2).normal(size=(A.shape[0], 3))
    negative = factors.factorise(A).negative
    if squares <= 12:
        assert negative == (np.linalg.eigvalsh(A.toarray()) < 0.0).sum()
    else:
        assert negative >= A.shape[0] - squares**2  # as many as equations, and those of W on their kernel
    found = factors.solve(right)
    np.testing.assert_allclose(A @ found, right, atol=1e-7 * np.abs(found).max())
    np.testing.assert_array_equal(factors.solve(right[:, 1]), found[:, 1])


def test_other_entries_of_the_same_sparsity_give_what_they_give_alone():
    (first, points), (second, _) = saddle(9, 3), saddle(9, 3)
    second = sparse.csr_matrix((2.5 * second.data, first.indices, first.indptr), shape=first.shape)
    again, alone, right = Multifrontal(points), Multifrontal(points), np.arange(float(first.shape[0]))
    again.factorise(first)
    assert again.factorise(second).negative == alone.factorise(second).negative
    np.testing.assert_array_equal(again.solve(right), alone.solve(right))


def test_another_sparsity_is_taken_in():
    factors = Multifrontal()
    for squares in (7, 3, 8):
        A, _ = saddle(squares, squares)
        factors.factorise(A)
        x = np.ones(A.shape[0])
        np.testing.assert_allclose(factors.solve(A @ x), x, rtol=1e-6)


def test_parts_that_are_not_coupled_are_solved_side_by_side():
    A, _ = saddle(4, 5)
    apart = sparse.block_diag([A, sparse.diags([3.0, -2.0]), A]).tocsr()
    apart.sort_indices()
    factors = Multifrontal()
    assert factors.factorise(apart).negative == 2 * Multifrontal().factorise(A).negative + 1
    x = np.linspace(1.0, 2.0, apart.shape[0])
    np.testing.assert_allclose(factors.solve(apart @ x), x, rtol=1e-6)


@pytest.mark.parametrize("bad", [0.0, np.nan, np.inf])
def test_pivots_that_vanish_or_are_no_numbers_are_refused(bad):
    matrix = sparse.csr_matrix(([1.0, bad, 2.0], [0, 1, 2], [0, 1, 2, 3]), shape=(3, 3))
    with pytest.raises(SingularMatrixError, match="singular"):
        Multifrontal().factorise(matrix)


def test_pivots_leave_the_diagonal_where_refinement_does_not_help():
    A = sparse.csr_matrix([[1e-30, 1.0, 0.0], [1.0, 1e-30, 2.0], [0.0, 2.0, 1.0]])
    b = np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(A @ Multifrontal(np.arange(3.0)[:, None]).factorise(A).solve(b), b)


def test_entries_that_cancel_on_one_side_of_the_diagonal_do_no_harm():
    A, points = saddle(12, 6)
    random = np.random.default_rng(7)
    zeros = sparse.csr_matrix((np.zeros(300), random.integers(0, A.shape[0], (2, 300))), shape=A.shape)
    uneven = sparse.csr_matrix((np.r_[A.tocoo().data, zeros.data], np.c_[A.nonzero(), zeros.tocoo().coords]), shape=A.shape)
    right = np.arange(float(A.shape[0]))
    np.testing.assert_allclose(
        Multifrontal(points).factorise(uneven).solve(right), Multifrontal(points).factorise(A).solve(right), rtol=1e-6
    )


def test_no_unknowns_have_a_solution_and_empty_rows_none():
    assert Multifrontal().factorise(sparse.csr_matrix((0, 0))).solve(np.zeros(0)).shape == (0,)
    with pytest.raises(SingularMatrixError):
        Multifrontal().factorise(sparse.csr_matrix((3, 3)))
