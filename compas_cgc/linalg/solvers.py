"""Linear solvers: the interface of the backends, and the choice between them."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Optional
from typing import Protocol

from scipy import sparse

from ..discrete.arrays import FloatArray
from .errors import SingularMatrixError

__all__ = ["BACKENDS", "LinearSolver", "SingularMatrixError", "factorise", "linear_solver"]

BACKENDS = ("multifrontal", "superlu", "pardiso", "amg")

# Numbers of unknowns from which PARDISO is faster, which starts more slowly. Multigrid is slower and is used for its smaller memory.
PARDISO_FROM, PARDISO_UNSYMMETRIC = 200_000, 2_000_000
AMG_FROM = 2_000_000


class LinearSolver(Protocol):
    """Interface of the backends.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy import sparse
    >>> from compas_cgc.linalg import factorise
    >>> factorise(sparse.identity(3, format="csr") * 2.0).solve(np.ones(3)).tolist()
    [0.5, 0.5, 0.5]
    """

    def factorise(self, matrix: sparse.csr_matrix) -> LinearSolver:
        """Factorise a matrix; what depends on the sparsity only is reused while the sparsity stays the same.

        Raises :class:`SingularMatrixError` where the matrix has no inverse.
        """
        ...

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution ``(n,)`` or ``(n, k)`` with the last matrix for a right-hand side of that shape."""
        ...


def linear_solver(
    size: int,
    *,
    symmetric: bool = False,
    points: Optional[FloatArray] = None,
    refine: bool = True,
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
        ``(n, d)`` positions of the unknowns, for backends that order by position. Default: found from
        the sparsity. The sparsity has to be symmetric in either case.
    refine
        Whether solutions are checked against the matrix and refined if needed. False is faster and enough for a
        preconditioner; it excludes multigrid, which has no factors.
    backend
        ``"multifrontal"`` (symmetric matrices only), ``"superlu"`` (SciPy), ``"pardiso"`` (package pypardiso),
        ``"amg"`` (package pyamg; symmetric matrices only), or ``"auto"``: by size, among those that are installed.

    Returns
    -------
    LinearSolver
        For a sequence of matrices of one sparsity.

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
        backend = _choose(size, symmetric, refine)
    if backend in ("multifrontal", "amg") and not symmetric:
        raise ValueError(f"the backend {backend!r} solves symmetric matrices only; use 'superlu' or 'pardiso'")
    if backend == "multifrontal":
        from .multifrontal import Multifrontal

        return Multifrontal(points, refine)
    if backend == "superlu":
        from .superlu import SuperLU

        return SuperLU(points, refine)
    if backend == "pardiso":
        from .pardiso import Pardiso

        return Pardiso(symmetric, refine)
    if backend == "amg":
        from .amg import AMG

        return AMG()
    raise ValueError(f"the backend must be 'auto' or one of {', '.join(BACKENDS)}, not {backend!r}")


def factorise(
    matrix: sparse.csr_matrix,
    *,
    symmetric: bool = False,
    points: Optional[FloatArray] = None,
    refine: bool = True,
    backend: str = "auto",
) -> LinearSolver:
    """Return a solver with the factors of one matrix; see :func:`linear_solver`.

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


def _choose(size: int, symmetric: bool, refine: bool) -> str:
    if symmetric and refine and size >= AMG_FROM and find_spec("pyamg"):
        return "amg"
    least = PARDISO_FROM if symmetric else PARDISO_UNSYMMETRIC
    if size >= least and find_spec("pypardiso"):
        from .pardiso import works

        if works():
            return "pardiso"
    return "multifrontal" if symmetric else "superlu"
