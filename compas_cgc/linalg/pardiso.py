"""PARDISO of Intel's MKL, through the package pypardiso: multithreaded, and the symbolic factorisation is reused."""

from __future__ import annotations

import os
import weakref
from functools import cache
from importlib.metadata import PackageNotFoundError
from importlib.metadata import distribution
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from .errors import SingularMatrixError
from .ordering import has_pattern

__all__ = ["Pardiso", "works"]

UNSYMMETRIC, POSITIVE_DEFINITE = 11, 2
ANALYSE, FACTORISE, SOLVE = 11, 22, 33
FORWARD, BACKWARD = 331, 333  # substitutions only: half the time of SOLVE, which also checks whether to refine
REPRODUCIBLE = 2  # MKL_CBWR_AUTO: the fastest code of this processor, always the same
REFINEMENTS = 8  # index of the parameter iparm with the number of refinement steps; PARDISO's default is two

LIBRARY = "PYPARDISO_MKL_RT"  # environment variable with the path of MKL, read by pypardiso

POOR = 1e-3  # relative residual above which a solution is rejected


@cache
def works() -> bool:
    """Check whether pypardiso finds its library on this machine."""
    library = _library()
    if library:
        # Without it, pypardiso searches the whole environment for every solver, which takes a third of a second.
        os.environ.setdefault(LIBRARY, library)
    try:
        import pypardiso  # noqa: F401
    except (ImportError, OSError):
        return False
    return True


def _library() -> Optional[str]:
    """Return the path of the MKL library that pypardiso loads, None if unknown."""
    try:
        files = distribution("mkl").files or []
    except PackageNotFoundError:
        return None
    found = sorted(os.path.realpath(file.locate()) for file in files if "mkl_rt" in file.name and file.suffix != ".lib")
    return next((path for path in found if os.path.exists(path)), None)


class Pardiso:
    """LU or Cholesky factors by PARDISO.

    Parameters
    ----------
    symmetric
        The matrices are symmetric and positive definite.
    refine
        Whether solutions are checked and refined.
    """

    def __init__(self, symmetric: bool = False, refine: bool = True):
        if not works():
            raise ImportError("pypardiso does not find MKL's library; install the package mkl, or use the backend 'superlu'")
        from pypardiso import PyPardisoSolver

        self._symmetric = symmetric
        self._refine = refine
        self._pattern: Optional[tuple[CSRIndices, CSRIndices]] = None
        self._solver = PyPardisoSolver(mtype=POSITIVE_DEFINITE if symmetric else UNSYMMETRIC)
        # Otherwise the last bits depend on the alignment of vectors in memory.
        self._solver.libmkl.MKL_CBWR_Set(REPRODUCIBLE)
        if not refine:
            self._solver.set_iparm(REFINEMENTS, 0)
        weakref.finalize(self, self._solver.free_memory, everything=True)

    def factorise(self, matrix: sparse.csr_matrix) -> Pardiso:
        """Factorise a matrix; the symbolic factorisation is reused if the sparsity is that of the last one."""
        self._whole = matrix = sparse.csr_matrix(matrix)
        if self._symmetric:
            matrix = sparse.triu(matrix, format="csr")
        matrix.sort_indices()
        if not np.diff(matrix.indptr).all():
            raise SingularMatrixError("the matrix is singular: it has an empty row")
        self._matrix = matrix
        if not has_pattern(matrix, self._pattern):
            self._pattern = matrix.indptr, matrix.indices
            self._call(ANALYSE, np.zeros(matrix.shape[0]))
        self._call(FACTORISE, np.zeros(matrix.shape[0]))
        return self

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution for a right-hand side."""
        right = np.asfortranarray(rhs, dtype=np.float64)
        if not self._refine:
            return self._call(BACKWARD, np.asfortranarray(self._call(FORWARD, right)))
        x = self._call(SOLVE, right)
        # PARDISO replaces vanishing pivots instead of reporting an error.
        if not np.abs(self._whole @ x - rhs).max(initial=0.0) <= POOR * np.abs(rhs).max(initial=0.0):
            raise SingularMatrixError("the matrix is singular to rounding: the residual of the solution is too large")
        return x

    def _call(self, phase: int, rhs: FloatArray) -> FloatArray:
        from pypardiso.pardiso_wrapper import PyPardisoError

        # pypardiso's own factorize() repeats the symbolic analysis every time.
        self._solver.set_phase(phase)
        try:
            return self._solver._call_pardiso(self._matrix, rhs)
        except PyPardisoError as error:
            self._pattern = None
            raise SingularMatrixError(str(error)) from None
