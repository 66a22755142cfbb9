"""Benchmark of solves: relative to one factorisation and to general optimisers, and growth with mesh size."""

from __future__ import annotations

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from typing import Optional

import numpy as np
from scipy import optimize
from scipy import sparse
from scipy.sparse.linalg import splu

from ...discrete import gaussian_curvature
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...discrete.jacobian import CurvatureEquations
from ...discrete.laplacian import cotangent_stiffness
from ...discrete.sparsity import RingPattern
from ...model.problem import CGCProblem
from ...model.result import FAILED
from ...model.roles import FIXED
from ...model.roles import FREE
from ...model.roles import INTERNAL
from ...solvers.newton import NewtonSettings
from ...solvers.newton import newton
from ...solvers.projection import Projector
from ...solvers.run import solve
from .timing import best_of

__all__ = ["against_optimisers", "fairest_growth", "fitted_exponent", "interactive", "newton_growth", "square"]


def square(cells: int) -> CGCProblem:
    """Return a flat square of side 1 with a fixed edge and K̄ = 1."""
    i, j = np.divmod(np.arange((cells + 1) ** 2), cells + 1)
    vertices = np.column_stack([i, j, np.zeros(len(i))]) / cells
    a = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.column_stack([a, a + cells + 1, a + cells + 2, a, a + cells + 2, a + 1]).reshape(-1, 3)
    rim = (np.minimum(i, j) == 0) | (np.maximum(i, j) == cells)
    return CGCProblem(vertices, faces, np.where(rim, FIXED, INTERNAL), np.ones(len(vertices)))


def newton_growth(sizes: tuple[int, ...] = (100, 1_000, 10_000, 100_000), backend: str = "auto") -> list[dict]:
    """Return the cost of Newton's method from a flat initial guess, each size in a separate process to measure peak memory.

    Parameters
    ----------
    sizes
        Approximate numbers of vertices.
    backend
        Linear solver.

    Returns
    -------
    list of dict
        Results by name, one dict per size.

    Examples
    --------
    >>> newton_growth((100, 1000))[0]["seconds"]  # doctest: +SKIP
    """
    rows = []
    for size in sizes:
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            rows.append(pool.submit(_newton_row, round(size**0.5) - 1, backend).result())
    return rows


def _newton_row(cells: int, backend: str) -> dict:
    settings = NewtonSettings(backend=backend)
    newton(square(10), settings=settings)
    problem = square(cells)
    started = time.perf_counter()
    solution = newton(problem, settings=settings)
    seconds = time.perf_counter() - started
    inner = problem.asked
    error = np.abs(gaussian_curvature(solution.vertices, problem.faces) - 1)[inner].max()
    equations = CurvatureEquations(problem.faces, problem.targets, np.flatnonzero(inner), np.flatnonzero(inner))
    residual, area = equations.measure(solution.vertices)
    memory = _peak_memory()
    laplacian = _laplacian_seconds(problem)
    return {
        "vertices": len(problem.vertices),
        "status": solution.status,
        "steps": solution.iterations,
        "seconds": seconds,
        "laplacian_seconds": laplacian,
        "ratio": seconds / laplacian,
        "residual": float(np.abs(residual).max()),
        "max_error": float(error),
        "rounding_floor": float(np.finfo(float).eps / area.min()),
        "peak_memory_bytes": memory,
    }


def fairest_growth(sizes: tuple[int, ...] = (1_000, 10_000, 100_000)) -> list[dict]:
    """Return the cost of the fairest surface on four corners, including checks and verdict, on increasingly fine meshes.

    Parameters
    ----------
    sizes
        Approximate numbers of vertices.

    Returns
    -------
    list of dict
        Results by name, two dicts per size, for K = 1 and K = -1; ``ratio`` is relative to one factorisation of the Laplacian.

    Examples
    --------
    >>> fairest_growth((1000,))[0]["ratio"]  # doctest: +SKIP
    """
    rows = []
    for size in sizes:
        for target in (1.0, -1.0):
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                rows.append(pool.submit(_fairest_row, round(size**0.5) - 1, target).result())
    return rows


def _fairest_row(cells: int, target: float) -> dict:
    # Compile and load everything before the measurement.
    for small in (10, 100):
        solve(square(small).with_supports("corners").with_targets(target))
    problem = square(cells).with_supports("corners").with_targets(target)
    started = time.perf_counter()
    result = solve(problem)
    seconds = time.perf_counter() - started
    memory, laplacian = _peak_memory(), _laplacian_seconds(square(cells))
    return {
        "vertices": len(problem.vertices),
        "K": target,
        "status": result.status,
        "verdict": "-" if result.status in FAILED else result.verdict.word,
        "steps": result.iterations,
        "seconds": seconds,
        "laplacian_seconds": laplacian,
        "ratio": seconds / laplacian,
        "max_error": result.max_error,
        "peak_memory_bytes": memory,
    }


def _laplacian_seconds(problem: CGCProblem) -> float:
    """Return the time of a factorisation of the cotangent Laplacian of internal vertices by SciPy's SuperLU [s]."""
    rows = np.flatnonzero(problem.asked)
    stiffness = cotangent_stiffness(problem.vertices, RingPattern(problem.faces, len(problem.vertices), rows, rows)).tocsc()

    def factorisation() -> None:
        splu(stiffness, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.0)

    return best_of(factorisation, repeats=1, budget=0.2)


def _peak_memory() -> Optional[int]:
    """Return the peak memory of this process [bytes], None if not available."""
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


def fitted_exponent(rows: list[dict], name: str) -> float:
    """Return the exponent of the growth of a result with the number of vertices, fitted to the larger half of the rows.

    Parameters
    ----------
    rows
        Results by name, including ``vertices``.
    name
        Name of the result.

    Returns
    -------
    float
        The exponent.

    Examples
    --------
    >>> round(fitted_exponent([{"vertices": n, "seconds": n**1.5} for n in (10, 100, 1000, 10000)], "seconds"), 6)
    1.5
    """
    rows = [row for row in rows if row[name]][-3:]
    return float(np.polyfit(np.log([row["vertices"] for row in rows]), np.log([row[name] for row in rows]), 1)[0])


def against_optimisers(cells: int = 30, lbfgs_cells: int = 9) -> list[dict]:
    """Return the time of SciPy's least squares and L-BFGS relative to Newton's method, on the same residual.

    All methods move vertices vertically, from the same low dome and with the exact Jacobian.

    Parameters
    ----------
    cells
        Number of squares per side, for least squares.
    lbfgs_cells
        The same for L-BFGS.

    Returns
    -------
    list of dict
        Results by name, one dict per method.

    Examples
    --------
    >>> against_optimisers(cells=10)[0]["times_slower"]  # doctest: +SKIP
    """
    return [_against("least_squares", cells), _against("L-BFGS", lbfgs_cells)]


def _against(name: str, cells: int) -> dict:
    problem = square(cells)
    inner = np.flatnonzero(problem.asked)
    x, y, _ = problem.vertices.T
    problem = replace(problem, vertices=np.column_stack([x, y, 0.3 * np.sqrt(np.maximum(0, x * (1 - x) * y * (1 - y)))]))
    equations = CurvatureEquations(problem.faces, problem.targets, inner, inner)
    up = np.tile([0.0, 0.0, 1.0], (len(inner), 1))

    def shape(z: FloatArray) -> Vertices:
        vertices = problem.vertices.copy()
        vertices[inner, 2] = z
        return vertices

    def residual(z: FloatArray) -> FloatArray:
        return equations.residual(shape(z))

    def jacobian(z: FloatArray) -> sparse.csr_matrix:
        return equations.jacobian(shape(z), up)

    start = problem.vertices[inner, 2]
    started = time.perf_counter()
    if name == "least_squares":
        found = optimize.least_squares(residual, start, jacobian, xtol=1e-15, ftol=1e-15, gtol=1e-15, tr_solver="lsmr", max_nfev=100)
        z = found.x
    else:

        def value(z: FloatArray) -> tuple[float, FloatArray]:
            r = residual(z)
            return 0.5 * float(r @ r), jacobian(z).T @ r

        options = dict(maxiter=20_000, maxfun=40_000, ftol=0.0, gtol=1e-13)
        z = optimize.minimize(value, start, jac=True, method="L-BFGS-B", options=options).x
    seconds = time.perf_counter() - started
    newton_seconds = best_of(lambda: newton(problem), budget=0.2)
    vertices = shape(z)
    error = np.abs(gaussian_curvature(vertices, problem.faces) - 1)[inner].max()
    return {
        "method": name,
        "vertices": len(problem.vertices),
        "seconds": seconds,
        "newton_seconds": newton_seconds,
        "times_slower": seconds / newton_seconds,
        "max_error": float(error),
    }


def interactive(cells: int = 44) -> dict:
    """Return the time of solving a roof on four corners again from its last shape, after a change of K̄ by 5 %.

    Parameters
    ----------
    cells
        Number of squares per side.

    Returns
    -------
    dict
        Results by name.

    Examples
    --------
    >>> interactive(20)["seconds"]  # doctest: +SKIP
    """
    flat = square(cells)
    x, y, _ = flat.vertices.T
    corner = (np.minimum(x, 1 - x) + np.minimum(y, 1 - y)) < 1e-9
    rim = flat.roles == FIXED
    roof = replace(flat, roles=np.where(corner, FIXED, np.where(rim, FREE, INTERNAL)))
    projector = Projector(roof)
    first = projector.solve()
    targets = 1.05 * roof.targets
    again = best_of(lambda: projector.solve(targets, vertices=first.vertices), budget=0.5)
    solved = projector.solve(targets, vertices=first.vertices)
    return {"vertices": len(flat.vertices), "seconds": again, "status": solved.status, "max_error": solved.max_error}
