"""Runs of examples, with their records."""

from __future__ import annotations

import time
from dataclasses import dataclass
from dataclasses import replace
from typing import Optional
from typing import Union

import numpy as np

from ...datastructures import CGCMesh
from ...datastructures import SolveResult
from ...discrete import gaussian_curvature
from ...discrete.arrays import FloatArray
from ...model.problem import CGCProblem
from ...model.result import SolveState
from ...model.roles import DUMMY
from ...solvers.flow import CurveResult
from ...solvers.flow import FlowSettings
from ...solvers.flow import curve_flow
from ...solvers.run import solve
from ..examples import CurveExample
from ..examples import SurfaceExample
from ..examples import example2
from ..examples import table2

__all__ = ["CurveRun", "SurfaceRun", "run_example", "run_table2", "warm_up"]


@dataclass(frozen=True)
class CurveRun:
    """A run of a variant of Example 1.

    Parameters
    ----------
    example
        The example.
    points
        (n, 2) initial points.
    options
        Arguments of the flow.
    result
        Result of the run.
    seconds
        Time of the run, without compilation [s].
    early
        Result after 3 steps, as in Fig. 6.

    Examples
    --------
    >>> from compas_cgc.paper.examples import examples_of
    >>> from compas_cgc.paper.reproduction import run_example
    >>> run_example(examples_of(1)[1]).result.max_error < 1e-6
    True
    """

    example: CurveExample
    points: FloatArray  # (n, 2) initial points
    options: dict
    result: CurveResult
    seconds: float
    early: CurveResult  # result after 3 steps, as in Fig. 6

    def record(self) -> dict:
        """Return the record of the run as JSON data."""
        options = {**self.options, "s": float(self.options["s"])}
        edges = np.diff(self.result.points, axis=0)
        angles = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
        return {
            "example": self.example.name,
            "title": self.example.title,
            "settings": options,
            "max_error": self.result.max_error,
            "height": float(self.result.points[:, 1].max()),
            "turning": float(angles[0] - angles[-1]),
            "shortest_edge": float(np.linalg.norm(edges, axis=1).min()),
            "seconds": self.seconds,
            "points": self.result.points.tolist(),
            "history": {"max_error": self.result.history.tolist()},
        }


@dataclass(frozen=True)
class SurfaceRun:
    """A run of a variant of Examples 2 to 7.

    Parameters
    ----------
    example
        The example.
    mesh
        Initial mesh, including dummies.
    settings
        Settings of the flow.
    result
        Result of the run.
    before_divergence
        Last usable shape, if the run diverged.

    Examples
    --------
    >>> from compas_cgc.paper.examples import examples_of
    >>> from compas_cgc.paper.reproduction import run_example
    >>> run_example(examples_of(2)[0]).result.iterations
    200
    """

    example: SurfaceExample
    mesh: CGCMesh  # initial mesh, including dummies
    settings: FlowSettings
    result: SolveResult
    before_divergence: Optional[SolveState]  # last usable shape, if the run diverged

    @property
    def problem(self) -> CGCProblem:
        """Initial mesh as arrays, including dummies."""
        return CGCProblem.from_mesh(self.mesh)

    def final_vertices(self) -> FloatArray:
        """Return the final shape (n, 3) including dummies; for a diverged run, the last usable shape."""
        vertices = self.problem.vertices.copy()
        real = self.problem.roles != DUMMY
        if self.before_divergence is not None:
            vertices[real] = self.before_divergence.vertices
        else:
            vertices[real] = self.result.mesh.arrays()[0]
        return vertices

    def errors(self, vertices: FloatArray) -> FloatArray:
        """Return K - K̄ (n,), NaN where K is not prescribed."""
        problem = self.problem
        error = gaussian_curvature(vertices, problem.faces) - problem.targets
        return np.where(problem.asked, error, np.nan)

    def start_error(self) -> float:
        """Return the largest |K - K̄| of the initial mesh."""
        return float(np.nanmax(np.abs(self.errors(self.problem.vertices))))

    def record(self) -> dict:
        """Return the record of the run as JSON data."""
        example, result = self.example, self.result
        n, m = self.mesh.number_of_vertices(), self.mesh.number_of_faces()
        return {
            "example": example.name,
            "title": example.title,
            "counterpart": example.counterpart,
            "vertices": n,
            "faces": m,
            "settings": self.settings.to_dict(),
            "status": result.status,
            "message": result.message,
            "steps": result.iterations,
            "seconds": result.seconds,
            "microseconds_per_vertex_and_step": 1e6 * result.seconds / n / max(1, result.iterations),
            "start_error": self.start_error(),
            "max_error": result.max_error,
            "height": float(result.mesh.arrays()[0][:, 2].max()),
            "paper": {
                "vertices": example.paper_size[0],
                "faces": example.paper_size[1],
                "seconds": example.paper_seconds,
                "max_error": example.paper_error,
                "start_error": example.paper_start_error,
            },
            "history": result.history.to_dict(),
        }


def run_example(example: Union[CurveExample, SurfaceExample]) -> Union[CurveRun, SurfaceRun]:
    """Solve an example with the method and settings of the paper.

    Parameters
    ----------
    example
        An example of the catalogue.

    Returns
    -------
    CurveRun or SurfaceRun
        The run with its result and time.

    Examples
    --------
    >>> from compas_cgc.paper.examples import examples_of
    >>> run_example(examples_of(2)[0]).result.status
    'step_limit'
    """
    if isinstance(example, CurveExample):
        points, options = example.build()
        started = time.perf_counter()
        curve = curve_flow(points, **options)
        seconds = time.perf_counter() - started
        return CurveRun(example, points, options, curve, seconds, curve_flow(points, **{**options, "steps": 3}))
    mesh, settings = example.build()
    result = solve(mesh, settings=settings)
    torn = _shape_before(mesh, settings) if result.status == "diverged" else None
    return SurfaceRun(example, mesh, settings, result, torn)


def _shape_before(mesh: CGCMesh, settings: FlowSettings) -> Optional[SolveState]:
    """Run again and return the last shape in which no vertex has moved by more than a tenth of the mesh size."""
    vertices, _ = mesh.arrays()
    reach = 0.1 * float(np.linalg.norm(np.ptp(vertices, axis=0)))
    last: list[SolveState] = []

    def keep(state: SolveState) -> bool:
        if np.abs(state.vertices - vertices).max() > reach:
            return True
        last[:] = [state]
        return False

    solve(mesh, settings=settings, callback=keep)
    return last[0] if last else None


def run_table2(sizes: tuple[int, ...] = (5, 10, 15, 20)) -> dict[int, dict]:
    """Return the results of Table 2 by the number of squares per side.

    Parameters
    ----------
    sizes
        Number of squares per side.

    Returns
    -------
    dict
        Records by size.

    Examples
    --------
    >>> list(run_table2((5,)))
    [5]
    """
    rows = {}
    for n in sizes:
        mesh, settings = table2(n)
        result = solve(mesh, settings=settings)
        rows[n] = {
            "vertices": mesh.number_of_vertices(),
            "faces": mesh.number_of_faces(),
            "steps": result.iterations,
            "seconds": result.seconds,
            "max_error": result.max_error,
            "settings": settings.to_dict(),
        }
    return rows


def warm_up() -> None:
    """Load the compiled kernels, so that their loading is not included in the first time.

    Examples
    --------
    >>> warm_up()
    """
    mesh, settings = example2()
    solve(mesh, settings=replace(settings, steps=1))
