"""Conversion of the inputs of a solve on the canvas to a request."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...io.reading import ReadProblem
from ...io.rhino.assemble import assemble
from ...io.rhino.sketch import Drawn
from ...model.laws import ConstantCurvature
from ...model.laws import laws_by_region
from ...model.problem import CGCProblem
from ..api.decoding import read_json
from ..api.requests import SolveRequest
from ..api.requests import solve_request
from ..errors import Unprocessable
from ..limits import Limits
from .data_tree import read_values
from .endpoints import OPTION_INPUTS
from .endpoints import endpoint
from .geometry import read_curve
from .geometry import read_mesh
from .goals import drawn_goals
from .goals import goal_options

__all__ = ["design_of", "dome_request", "read_hops_request", "solve_inputs_request", "surface_of"]


def read_hops_request(options: dict, body: bytes, limits: Limits) -> SolveRequest:
    """Return the request of ``cgc/submit`` from its stored JSON."""
    request: Any = read_json(body, limits)
    return solve_inputs_request(read_values(endpoint("cgc/solve"), request["values"]), request["context"], limits)


def dome_request(inputs: dict, context: dict, limits: Limits, K: float, **options: object) -> SolveRequest:
    """Return the request for a surface of one curvature over the edge of the input Mesh, welded and triangulated."""
    read = _assembled({"Mesh": inputs["Mesh"]}, context, limits)
    return solve_request(read.checked(), {"supports": "boundary", "targets": K, **options}, limits, _notes(read))


def solve_inputs_request(inputs: dict, context: dict, limits: Limits) -> SolveRequest:
    """Return the request of the inputs of ``cgc/solve``.

    Parameters
    ----------
    inputs
        Inputs by name.
    context
        ``modelunits`` and ``absolutetolerance`` of the document [L].
    limits
        Limits of the server.

    Raises
    ------
    Unprocessable, CGCError
        If an input is invalid.
    """
    _check_targets(inputs)
    read = _assembled(inputs, context, limits)
    problem = read.checked()
    laws = _laws(inputs, problem)
    by_region = {"laws": {str(region): text for region, text in laws.items()}} if laws else {}
    return solve_request(problem, {**_options(inputs), **by_region, **goal_options(inputs, limits)}, limits, _notes(read))


def surface_of(inputs: dict, context: dict, limits: Limits) -> tuple[CGCProblem, list[str]]:
    """Return a surface without solving, with the given K and laws, and notes on changes made to the input.

    Raises
    ------
    Unprocessable, CGCError
        If an input is invalid.
    """
    _check_targets(inputs)
    read = _assembled(inputs, context, limits)
    problem = read.checked()
    if "Supports" in inputs and not inputs["Supports"]:
        problem = problem.with_supports("boundary")
    problem = problem if inputs["At"] else problem.with_targets(inputs["K"][0])
    return problem.with_laws(_laws(inputs, problem)), _notes(read)


def design_of(inputs: dict, context: dict, limits: Limits) -> tuple[CGCProblem, list[str]]:
    """Return a design with its supports, and notes on changes made to the input.

    Raises
    ------
    Unprocessable, CGCError
        If an input is invalid.
    """
    read = _assembled(inputs, context, limits)
    return read.checked(), _notes(read)


def _laws(inputs: Mapping[str, Any], problem: CGCProblem) -> dict[int, str]:
    """Return the laws of regions as texts, none if an endpoint has no such input."""
    return laws_by_region(filter(str.strip, inputs.get("Law", "").split(";")), problem.number_of_regions())


def _check_targets(inputs: Mapping[str, Any]) -> None:
    K, At = inputs["K"], inputs["At"]
    if At and len(At) != len(K):
        raise Unprocessable(f"input 'At' has {len(At)} points, but input 'K' has {len(K)} numbers; connect one point per number")
    if not At and len(K) != 1:
        raise Unprocessable(f"input 'K' has {len(K)} numbers; connect as many points At, one in each region, or one number for all")


def _options(inputs: Mapping[str, Any]) -> dict:
    """Return the inputs that are not geometry as options of a request."""
    defaults = {own.name: own.default for own in endpoint("cgc/solve").inputs}
    # Hops also sends the defaults of unconnected inputs; they are not settings of the user.
    given = {option: inputs[name] for name, (_, option) in OPTION_INPUTS.items() if inputs[name] != defaults[name]}
    options: dict = {"method": inputs["Method"], "settings": given}
    if not inputs["Supports"]:
        options["supports"] = "boundary"
    if not inputs["At"]:
        options["targets"] = inputs["K"][0]
    return options


def _notes(read: ReadProblem) -> list[str]:
    # Missing supports are reported by the check of the solve, which names the inputs.
    return [note for note in read.notes if "no support" not in note]


def _assembled(inputs: dict, context: dict, limits: Limits) -> ReadProblem:
    part = read_mesh(inputs["Mesh"], "Mesh", limits)
    supports = np.array(inputs.get("Supports") or [], dtype=np.float64).reshape(-1, 3)
    curves = inputs.get("Creases") or []
    places = inputs.get("At") or []

    def support(tolerance: float) -> list[Drawn]:
        return [Drawn("of input 'Supports'", "point cloud", supports, None, {})] if len(supports) else []

    def creases(tolerance: float) -> list[Drawn]:
        named = enumerate(curves)
        return [Drawn(f"{i} of input 'Creases'", "curve", read_curve(data, "Creases", tolerance), None, {}) for i, data in named]

    def targets(tolerance: float) -> list[Drawn]:
        named = enumerate(zip(inputs["K"], places))
        return [Drawn(f"point {i} of input 'At'", "point", np.array([place]), ConstantCurvature(K), {}) for i, (K, place) in named]

    return assemble(
        "mesh",
        [part],
        support,
        creases,
        targets if places else lambda tolerance: [],
        lambda tolerance: [],
        context["modelunits"],
        context["absolutetolerance"],
        goals=lambda tolerance: drawn_goals(inputs, tolerance),
    )
