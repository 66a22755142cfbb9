"""Functions of the components, run in the workers."""

from __future__ import annotations

import time
from typing import Optional

import numpy as np

from ...analysis import analyse
from ...datastructures import SolveResult
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing import vertex_labels
from ...model.checks import check
from ...model.measures import measured_curvature
from ...model.measures import measured_mean_curvature
from ...model.problem import CGCProblem
from ...solvers.flow import FlowSettings
from ...solvers.registry import method_of
from ..api.requests import SolveRequest
from ..api.rhino_mesh import mesh_text
from ..api.tasks import run_request
from ..api.wording import in_request_words
from ..errors import RequestError
from ..limits import Limits
from .build_functions import BUILD_FUNCTIONS
from .data_tree import entry
from .data_tree import finite_items
from .data_tree import passed_over
from .data_tree import read_values
from .endpoints import endpoint
from .inputs import dome_request
from .inputs import solve_inputs_request
from .rationalisation import run_rationalise
from .rationalise_endpoint import RATIONALISE
from .reply import Reply
from .reply import spent

__all__ = ["run_function", "surface_values"]

MAX_REGIONS = 20  # number of regions listed in the info
GOOD_ENOUGH = ("converged", "step_limit", "stalled")


def run_function(uri: str, values: object, context: dict, limits: Limits) -> Reply:
    """Run a function on the values of a request; errors in the values are reported in the reply."""
    started = time.perf_counter()
    try:
        reply = FUNCTIONS[uri](read_values(endpoint(uri), values), context, limits, started)
        return reply._replace(warnings=[*reply.warnings, *passed_over(endpoint(uri), values)])
    except RequestError as error:
        return Reply(error.status, [], [str(error)], [], {})
    except ValueError as error:
        return Reply(422, [], [in_request_words(error)], [], {})


def _dome(inputs: dict, context: dict, limits: Limits, started: float) -> Reply:
    return _solved(dome_request(inputs, context, limits, inputs["K"]), started)


def _solve(inputs: dict, context: dict, limits: Limits, started: float) -> Reply:
    return _solved(solve_inputs_request(inputs, context, limits), started)


def _solved(request: SolveRequest, started: float) -> Reply:
    read = time.perf_counter()
    result = run_request(request)
    solved = time.perf_counter()
    notes = list(request.notes)
    if result.status not in GOOD_ENOUGH:
        return Reply(422, [], [result.message], notes, spent(started, read, solved))
    judged = f"the surface is {result.verdict}"
    remarks = [] if result.converged else [in_request_words(said) for said in check(request.problem)]
    warnings = ([] if result.verdict.fair else [judged]) if result.converged else [result.message, *remarks]
    info = "\n".join([result.summary, f"{result.ending} ({result.seconds:.2f} s)", *notes, *remarks])
    return Reply(200, surface_values(result, info), [], warnings, spent(started, read, solved))


def _flow(inputs: dict, context: dict, limits: Limits, started: float) -> Reply:
    request = dome_request(inputs, context, limits, inputs["K"])
    read = time.perf_counter()
    settings = FlowSettings(steps=inputs["Steps"], finish=False)
    result = run_request(request._replace(method=method_of(settings), settings=settings))
    solved = time.perf_counter()
    # Reaching the requested number of steps is not a failure.
    warnings = [] if result.status in ("converged", "step_limit") else [result.message]
    values = surface_values(result, "\n".join([result.message, *request.notes]))
    return Reply(200, values, [], warnings, spent(started, read, solved))


def _analyse(inputs: dict, context: dict, limits: Limits, started: float) -> Reply:
    target = inputs["Target"]
    problem, *_, notes = dome_request(inputs, context, limits, target)
    read = time.perf_counter()
    vertices, faces = problem.vertices, problem.faces
    K, H = measured_curvature(problem), measured_mean_curvature(problem)
    report = str(analyse(problem))
    measured = time.perf_counter()
    columns, found = zip(*(finite_items(np.where(np.isnan(values), 0.0, values)) for values in (K, H)))
    warnings = list(dict.fromkeys(filter(None, found)))
    values = [
        entry("Mesh", "Mesh", [_coloured(vertices, faces, K - target, target)]),
        entry("K", "Number", columns[0]),
        entry("H", "Number", columns[1]),
        entry("Info", "Text", ["\n".join([report, *notes])]),
    ]
    return Reply(200, values, [], warnings, spent(started, read, measured))


FUNCTIONS = {
    "cgc/dome": _dome,
    "cgc/solve": _solve,
    "cgc/goals": _solve,
    "cgc/flow": _flow,
    "cgc/analyse": _analyse,
    **BUILD_FUNCTIONS,
    RATIONALISE: run_rationalise,
}


def surface_values(result: SolveResult, info: str) -> list[dict]:
    """Return the outputs Mesh, Info and Error; the info ends with a line per region."""
    problem = result.problem
    missed = result.curvature - problem.targets
    found = np.abs(missed[np.isfinite(missed)])
    return [
        entry("Mesh", "Mesh", [_coloured(problem.vertices, problem.faces, missed, problem.target_scale)]),
        entry("Info", "Text", ["\n".join([info, *_regions(problem, missed)])]),
        entry("Error", "Number", found.max(keepdims=True).tolist() if found.size else []),
    ]


def _regions(problem: CGCProblem, missed: FloatArray) -> list[str]:
    """Return a line per region with its target and the largest deviation."""
    label = problem.regions()
    region = vertex_labels(len(problem.vertices), problem.faces, label)
    count = int(label.max(initial=-1)) + 1
    lines = []
    for number in range(min(count, MAX_REGIONS)):
        own = problem.asked & (region == number)
        if not own.any():
            lines.append(f"region {number}: {(label == number).sum()} triangles, no internal vertex")
            continue
        low, high = problem.targets[own].min(), problem.targets[own].max()
        asked = f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
        lines.append(
            f"region {number}: {(label == number).sum()} triangles, K̄ {asked}, largest |K - K̄| {np.nanmax(np.abs(missed[own])):.3g}"
        )
    return [*lines, *([f"and {count - MAX_REGIONS} more regions"] if count > MAX_REGIONS else [])]


def _coloured(vertices: FloatArray, faces: IntArray, missed: FloatArray, scale: Optional[float]) -> str:
    """Return the mesh coloured by its error; negligible errors stay white."""
    size = np.abs(missed[np.isfinite(missed)]).max(initial=0.0)
    return mesh_text(vertices, faces, missed, max(float(size), 1e-3 * abs(scale or 0.0)) or 1.0)
