"""The functions behind the components, run in the workers."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..problems import RequestProblem
from ..solving import Progress
from .catalogue import ENDPOINTS
from .geometry import mesh_text
from .problem import clean_mesh
from .problem import solve_problem
from .values import entry
from .values import finite_items
from .values import read_values

if TYPE_CHECKING:
    from ...datastructures import CGCMesh
    from ...problem import CGCProblem

__all__ = ["Reply", "run_function", "surface_values"]

GOOD_ENOUGH = ("converged", "step_limit", "stalled")


class Reply(NamedTuple):
    """What a function answers."""

    status: int
    values: list[dict]
    errors: list[str]
    warnings: list[str]
    spent: dict[str, float]  # seconds by part


def run_function(uri: str, values: object, context: dict) -> Reply:
    """Run a function on the values of a request; what is wrong with them is told in the reply."""
    started = time.perf_counter()
    try:
        inputs = read_values(ENDPOINTS[uri], values)
        return FUNCTIONS[uri](inputs, context, started)
    except RequestProblem as error:
        return Reply(error.status, [], [str(error)], [], {})
    except ValueError as error:
        return Reply(422, [], [str(error)], [], {})


def _dome(inputs: dict, context: dict, started: float) -> Reply:
    from ...solver import solve

    mesh, notes = clean_mesh(inputs, context)
    mesh.set_supports("boundary")
    mesh.set_target(inputs["K"])
    read = time.perf_counter()
    result = solve(mesh, callback=Progress())
    return _reply(result, mesh, notes, started, read)


def _solve(inputs: dict, context: dict, started: float) -> Reply:
    from ...solver import solve

    mesh, asked, notes = solve_problem(inputs, context)
    asked.put_on(mesh)
    read = time.perf_counter()
    result = solve(mesh, asked.method, asked.method_settings(), callback=Progress())
    return _reply(result, mesh, notes, started, read)


def _flow(inputs: dict, context: dict, started: float) -> Reply:
    from ...errors import ProblemError
    from ...flow import FlowSettings
    from ...flow import flow
    from ...problem import CGCProblem

    mesh, notes = clean_mesh(inputs, context)
    mesh.set_supports("boundary")
    mesh.set_target(inputs["K"])
    fatal = [problem for problem in mesh.check() if problem.fatal]
    if fatal:
        raise ProblemError(fatal)
    read = time.perf_counter()
    problem = CGCProblem.from_mesh(mesh)
    solution = flow(problem, FlowSettings(steps=inputs["Steps"]), Progress())
    solved = time.perf_counter()
    # Steps that were asked for and taken are no failure.
    warnings = [] if solution.status in ("converged", "step_limit") else [solution.message]
    values = surface_values(problem, solution.vertices, "\n".join([solution.message, *notes]), solution.max_error)
    return Reply(200, values, [], warnings, _spent(started, read, solved))


def _analyse(inputs: dict, context: dict, started: float) -> Reply:
    from ...analysis import analyse
    from ...discrete import gaussian_curvature
    from ...discrete import mean_curvature

    mesh, notes = clean_mesh(inputs, context)
    mesh.set_supports("boundary")
    target = inputs["Target"]
    mesh.set_target(target)
    read = time.perf_counter()
    vertices, faces = mesh.arrays()
    asked = np.array([role == "internal" for role in mesh.vertices_role()])
    K, H = (np.where(asked, values, 0.0) for values in (gaussian_curvature(vertices, faces), mean_curvature(vertices, faces)))
    report = str(analyse(mesh))
    measured = time.perf_counter()
    warnings = []
    columns = []
    for values in (K, H):
        items, warning = finite_items(values)
        columns.append(items)
        warnings += [warning] if warning and warning not in warnings else []
    values = [
        entry("Mesh", "Mesh", [_coloured(vertices, faces, np.where(asked, K - target, np.nan), target)]),
        entry("K", "Number", columns[0]),
        entry("H", "Number", columns[1]),
        entry("Info", "Text", ["\n".join([report, *notes])]),
    ]
    return Reply(200, values, [], warnings, _spent(started, read, measured))


FUNCTIONS = {"cgc/dome": _dome, "cgc/solve": _solve, "cgc/flow": _flow, "cgc/analyse": _analyse}


def _reply(result: object, mesh: CGCMesh, notes: list[str], started: float, read: float) -> Reply:
    from ...problem import CGCProblem

    solved = time.perf_counter()
    if result.status not in GOOD_ENOUGH:
        return Reply(422, [], [result.message], notes, _spent(started, read, solved))
    remarks = [] if result.converged else [str(problem) for problem in mesh.check()]
    warnings = [*([] if result.converged else [result.message]), *remarks]
    info = "\n".join([f"{result.message} ({result.seconds:.2f} s)", *notes, *remarks])
    problem = CGCProblem.from_mesh(result.mesh)
    values = surface_values(problem, problem.vertices, info, result.max_error)
    return Reply(200, values, [], warnings, _spent(started, read, solved))


def surface_values(problem: CGCProblem, vertices: np.ndarray, info: str, error: float) -> list[dict]:
    """Return the outputs Mesh, Info and Error."""
    from ...discrete import gaussian_curvature

    K = gaussian_curvature(vertices, problem.faces)
    missed = np.where(problem.asked, K - problem.targets, np.nan)
    return [
        entry("Mesh", "Mesh", [_coloured(vertices, problem.faces, missed, problem.target_scale)]),
        entry("Info", "Text", [info]),
        entry("Error", "Number", [error] if np.isfinite(error) else []),
    ]


def _coloured(vertices: np.ndarray, faces: np.ndarray, missed: np.ndarray, scale: Optional[float]) -> str:
    """Return the mesh coloured by its error; errors that nobody can see stay white."""
    size = np.abs(missed[np.isfinite(missed)]).max(initial=0.0)
    return mesh_text(vertices, faces, missed, max(float(size), 1e-3 * abs(scale or 0.0)) or 1.0)


def _spent(started: float, read: float, solved: float) -> dict[str, float]:
    return {"decode": read - started, "solve": solved - read, "encode": time.perf_counter() - solved}
