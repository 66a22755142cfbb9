"""Linear solvers: the interface of the backends, and the choice between them."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Optional
from typing import Protocol

from scipy import sparse

from ..discrete.arrays import FloatArray
from .errors import SingularMatrixError

__all__ = ["BACKENDS", "LinearSolver", "SingularMatrixError", "factorise", "linear_solver"]

BACKENDS = ("superlu", "pardiso", "amg")

# From here PARDISO is the faster one, and multigrid, slower than both, is taken for its
# memory. Below, SuperLU makes up for a slower factorisation by its solves and its start; where
# matrices are not symmetric it does so up to a million unknowns at least.
PARDISO_FROM, PARDISO_UNSYMMETRIC = 200_000, 2_000_000
PARDISO_FRESH = 10_000  # of a wide stencil, where nearly every right side has a matrix of its own: new factors take a sixth of the time
AMG_FROM = 2_000_000


class LinearSolver(Protocol):
    """What every backend offers; `quick` says whether new factors cost no more than a few solutions by old ones.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy import sparse
    >>> from compas_cgc.linalg import factorise
    >>> factorise(sparse.identity(3, format="csr") * 2.0).solve(np.ones(3)).tolist()
    [0.5, 0.5, 0.5]
    """

    quick: bool

    def factorise(self, matrix: sparse.csr_matrix) -> LinearSolver:
        """Take a matrix in; what depends on the sparsity only is kept from the last matrix where that was the same.

        Raises :class:`SingularMatrixError` where the matrix has no inverse.
        """
        ...

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution ``(n,)`` or ``(n, k)`` of the last matrix for a right side of that shape."""
        ...


def linear_solver(
    size: int,
    *,
    symmetric: bool = False,
    points: Optional[FloatArray] = None,
    refine: bool = True,
    fresh: bool = False,
    backend: str = "auto",
) -> LinearSolver:
    """Return a solver for systems of one sparsity.

    Parameters
    ----------
    size
        Number of unknowns.
    symmetric
        The matrices are symmetric and positive definite.
    points
        ``(n, d)`` place of every unknown, for backends that order by place. Default: places
        found in the sparsity, which has to be symmetric in either case.
    refine
        Whether solutions are checked against the matrix, and refined where that is in need.
        Without, they are as good as the factors, which multigrid has none of: enough where any
        fixed matrix near to the inverse will do, and quicker where solves are many.
    fresh
        Whether nearly every right side has a matrix of its own, and that has a wide stencil.
    backend
        ``"superlu"`` (SciPy), ``"pardiso"`` (package pypardiso), ``"amg"`` (package pyamg;
        symmetric matrices only), or ``"auto"``: by size, among those that are installed.

    Returns
    -------
    LinearSolver
        That takes in matrices of one sparsity, one after another.

    Raises
    ------
    ValueError
        If the backend is unknown or does not fit the matrices.
    ImportError
        If the package of the backend is missing.

    Examples
    --------
    >>> solver = linear_solver(3)
    >>> type(solver).__name__.startswith("_")
    False
    """
    if backend == "auto":
        backend = _choose(size, symmetric, refine, fresh)
    if backend == "superlu":
        from .superlu import SuperLU

        return SuperLU(symmetric, points, refine)
    if backend == "pardiso":
        from .pardiso import Pardiso

        return Pardiso(symmetric, refine)
    if backend == "amg":
        if not symmetric:
            raise ValueError("backend 'amg' is for symmetric positive definite matrices; use 'superlu' or 'pardiso'")
        from .amg import AMG

        return AMG()
    raise ValueError(f"backend must be 'auto' or one of {', '.join(BACKENDS)}, not {backend!r}")


def factorise(
    matrix: sparse.csr_matrix,
    *,
    symmetric: bool = False,
    points: Optional[FloatArray] = None,
    refine: bool = True,
    backend: str = "auto",
) -> LinearSolver:
    """Return a solver that has taken in one matrix; see :func:`linear_solver`.

    Parameters
    ----------
    matrix
        ``(n, n)``.
    symmetric, points, refine, backend
        As for :func:`linear_solver`.

    Returns
    -------
    LinearSolver
        Ready to solve with this matrix.

    Examples
    --------
    >>> from scipy import sparse
    >>> factorise(sparse.csr_matrix([[2.0, 0.0], [0.0, 4.0]])).solve([1.0, 1.0]).tolist()
    [0.5, 0.25]
    """
    return linear_solver(matrix.shape[0], symmetric=symmetric, points=points, refine=refine, backend=backend).factorise(matrix)


def _choose(size: int, symmetric: bool, refine: bool, fresh: bool) -> str:
    if symmetric and refine and size >= AMG_FROM and find_spec("pyamg"):
        return "amg"
    least = PARDISO_UNSYMMETRIC if not symmetric else PARDISO_FRESH if fresh else PARDISO_FROM
    if size >= least and find_spec("pypardiso"):
        from .pardiso import works

        if works():
            return "pardiso"
    return "superlu"
