"""The functions behind the components, run in the workers."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..api.options import Asked
from ..api.requests import Given
from ..api.tasks import Progress
from ..errors import RequestProblem
from .data_tree import entry
from .data_tree import finite_items
from .data_tree import read_values
from .endpoints import ENDPOINTS
from .geometry import mesh_text
from .inputs import given_surface
from .inputs import given_with_targets

if TYPE_CHECKING:
    from ...model.problem import CGCProblem

__all__ = ["Reply", "run_function", "surface_values"]

MOST_TOLD = 20  # regions
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
    return _solved(given_surface(inputs, context), Asked(supports="boundary", targets=inputs["K"]), started)


def _solve(inputs: dict, context: dict, started: float) -> Reply:
    return _solved(*given_with_targets(inputs, context), started)


def _solved(given: Given, asked: Asked, started: float) -> Reply:
    from ...model.checks import check
    from ...solvers import solve as solver

    problem = asked.put_on(given.problem, given.names)
    read = time.perf_counter()
    solution = solver.solve_problem(problem, asked.method, asked.method_settings(), Progress(), (), given.names)
    solved = time.perf_counter()
    notes = list(given.notes)
    if solution.status not in GOOD_ENOUGH:
        return Reply(422, [], [solution.message], notes, _spent(started, read, solved))
    remarks = [] if solution.status == "converged" else [str(said) for said in check(problem, given.names)]
    warnings = [] if solution.status == "converged" else [solution.message, *remarks]
    info = "\n".join([f"{solution.message} ({solution.seconds:.2f} s)", *notes, *remarks])
    return Reply(200, surface_values(problem, solution.vertices, info, solution.max_error), [], warnings, _spent(started, read, solved))


def _flow(inputs: dict, context: dict, started: float) -> Reply:
    from ...model.checks import check
    from ...model.checks import refuse
    from ...solvers.flow import FlowSettings
    from ...solvers.flow import flow

    given = given_surface(inputs, context)
    problem = Asked(supports="boundary", targets=inputs["K"]).put_on(given.problem, given.names)
    refuse(check(problem, given.names))
    read = time.perf_counter()
    solution = flow(problem, FlowSettings(steps=inputs["Steps"]), Progress())
    solved = time.perf_counter()
    # Steps that were asked for and taken are no failure.
    warnings = [] if solution.status in ("converged", "step_limit") else [solution.message]
    values = surface_values(problem, solution.vertices, "\n".join([solution.message, *given.notes]), solution.max_error)
    return Reply(200, values, [], warnings, _spent(started, read, solved))


def _analyse(inputs: dict, context: dict, started: float) -> Reply:
    from ...analysis import analyse_problem
    from ...discrete import gaussian_curvature
    from ...discrete import mean_curvature

    given, target = given_surface(inputs, context), inputs["Target"]
    problem = Asked(supports="boundary", targets=target).put_on(given.problem, given.names)
    read = time.perf_counter()
    vertices, faces, asked = problem.vertices, problem.faces, problem.asked
    K, H = (np.where(asked, values, 0.0) for values in (gaussian_curvature(vertices, faces), mean_curvature(vertices, faces)))
    report = str(analyse_problem(problem))
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
        entry("Info", "Text", ["\n".join([report, *given.notes])]),
    ]
    return Reply(200, values, [], warnings, _spent(started, read, measured))


FUNCTIONS = {"cgc/dome": _dome, "cgc/solve": _solve, "cgc/flow": _flow, "cgc/analyse": _analyse}


def surface_values(problem: CGCProblem, vertices: np.ndarray, info: str, error: float) -> list[dict]:
    """Return the outputs Mesh, Info and Error; the regions are told of at the end of the info."""
    from ...discrete import gaussian_curvature

    K = gaussian_curvature(vertices, problem.faces)
    missed = np.where(problem.asked, K - problem.targets, np.nan)
    return [
        entry("Mesh", "Mesh", [_coloured(vertices, problem.faces, missed, problem.target_scale)]),
        entry("Info", "Text", ["\n".join([info, *_regions(problem, missed)])]),
        entry("Error", "Number", [error] if np.isfinite(error) else []),
    ]


def _regions(problem: CGCProblem, missed: np.ndarray) -> list[str]:
    """Return a line on each region: what is asked for there, and by how much it is missed."""
    from ...meshing import vertex_labels

    label = problem.regions()
    region = vertex_labels(len(problem.vertices), problem.faces, label)
    count = int(label.max(initial=-1)) + 1
    lines = []
    for number in range(min(count, MOST_TOLD)):
        own = problem.asked & (region == number)
        if not own.any():
            lines.append(f"region {number}: {(label == number).sum()} triangles, no internal vertex")
            continue
        low, high = problem.targets[own].min(), problem.targets[own].max()
        asked = f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
        lines.append(f"region {number}: {(label == number).sum()} triangles, K̄ {asked}, largest |K - K̄| {np.abs(missed[own]).max():.3g}")
    return [*lines, *([f"and {count - MOST_TOLD} more regions"] if count > MOST_TOLD else [])]


def _coloured(vertices: np.ndarray, faces: np.ndarray, missed: np.ndarray, scale: Optional[float]) -> str:
    """Return the mesh coloured by its error; errors that nobody can see stay white."""
    size = np.abs(missed[np.isfinite(missed)]).max(initial=0.0)
    return mesh_text(vertices, faces, missed, max(float(size), 1e-3 * abs(scale or 0.0)) or 1.0)


def _spent(started: float, read: float, solved: float) -> dict[str, float]:
    return {"decode": read - started, "solve": solved - read, "encode": time.perf_counter() - solved}
