"""Endpoints: the functions of the server for Hops, with all registered methods and options."""

from __future__ import annotations

from typing import Union

from ...solvers.registry import METHODS
from ...solvers.registry import method_names
from ...solvers.registry import options
from ...solvers.registry import owners
from ...solvers.settings import AutoSettings
from ...solvers.settings import Option
from .build_endpoints import BUILDS
from .build_endpoints import build_endpoints
from .goals import GOAL_INPUTS
from .rationalise_endpoint import RATIONALISE
from .rationalise_endpoint import rationalise_endpoint
from .schema import MAX_ITEMS
from .schema import Endpoint
from .schema import Input
from .schema import Output
from .schema import icon

__all__ = ["OPTION_INPUTS", "REPEATABLE", "endpoint", "endpoints"]


REPEATABLE = ("cgc/dome", "cgc/solve", "cgc/goals", "cgc/flow", "cgc/analyse", *BUILDS, RATIONALISE)  # responses can be cached
OPTION_INPUTS = {
    "S": ("S", "s"),
    "Delay": ("D", "delay"),
    "Tolerance": ("T", "tolerance"),
    "Measure": ("Ms", "measure"),
}  # nickname and option
MESH = Input("Mesh", "M", "Mesh", "Start mesh. A surface of positive K rises to the side of its normals.")
K = Input("K", "K", "Number", "Target Gaussian curvature in 1 / (model unit)².", low=-1e9, high=1e9)
SURFACE = Output("Mesh", "M", "Mesh", "Surface, coloured by the error of K: blue too small, red too large.")
INFO = Output("Info", "I", "Text", "How the solve ended, and changes made to the input.")
ERROR = Output("Error", "E", "Number", "Largest error of K in 1 / (model unit)².")

DRAWN_INPUTS = (
    MESH,
    Input("Supports", "P", "Point", "Points at the support vertices. If empty, the whole edge is supported.", many=True, optional=True),
    Input("Creases", "C", "Curve", "Curves along which the surface may fold.", many=True, most=MAX_ITEMS, optional=True),
    Input(
        "K",
        "K",
        "Number",
        "Target Gaussian curvature: one for all regions, or one per point At.",
        many=True,
        most=MAX_ITEMS,
        low=-1e9,
        high=1e9,
    ),
    Input("At", "A", "Point", "A point in each region, in the order of K.", many=True, most=MAX_ITEMS, optional=True),
)


LAW = Input(
    "Law",
    "L",
    "Text",
    "Laws other than constant K: minimal or H = 0.1 for all regions, or 2=minimal; 4=H = 0.1 by region. Empty for none.",
    default="",
)


def _method_input() -> Input:
    *others, last = method_names()
    return Input("Method", "Me", "Text", f"{', '.join(others)} or {last}. Defaults to {others[0]}.", default=others[0])


def _option_input(name: str, nickname: str, option: str) -> Input:
    own = options()[option]
    default = _default(own)
    if own.kind is str:
        return Input(name, nickname, "Text", f"{own.summary} One of {', '.join(own.choices)}. Defaults to {default}.", default=default)
    kind = "Integer" if own.kind is int else "Number"
    text = f"{own.summary} Defaults to {default:g}: the default of the method."
    return Input(name, nickname, kind, text, default=default, low=own.low, high=own.high)


def _default(option: Option) -> Union[float, int, str]:
    """Return the value that Hops sends for an unconnected input."""
    if option.kind is str:
        return option.default
    common = option.name in AutoSettings.options()
    return 0.0 if common else getattr(METHODS[owners(option.name)[0]].settings(), option.name)


def _solve_inputs() -> tuple[Input, ...]:
    return (*DRAWN_INPUTS, _method_input(), *(_option_input(name, *own) for name, own in OPTION_INPUTS.items()), LAW)


def endpoint(uri: str) -> Endpoint:
    """Return the function at a path such as ``cgc/dome``."""
    return endpoints()[uri]


def endpoints() -> dict[str, Endpoint]:
    """Return all functions by their path."""
    found = (
        Endpoint(
            "cgc/dome",
            "CGC Dome",
            "Find the surface of constant Gaussian curvature over the fixed edge of a mesh.",
            icon("M3 18C3 8 21 8 21 18M3 18H21M12 10.5V18"),
            (MESH, K),
            (SURFACE, INFO, ERROR),
        ),
        Endpoint(
            "cgc/solve",
            "CGC Solve",
            "Find the surface with the target Gaussian curvature in each region between creases.",
            icon("M3 18C5 11 10 9 12 12C14 9 19 11 21 18M12 12V18"),
            _solve_inputs(),
            (SURFACE, INFO, ERROR),
        ),
        # A separate component, as Hops in Rhino 7 requires list inputs to be connected.
        Endpoint(
            "cgc/goals",
            "CGC Goals",
            "Find the surface that meets goals such as a rise or a clearance, optionally with unknown K.",
            icon("M3 18C5 11 10 9 12 12C14 9 19 11 21 18M12 12V4M9 7L12 4L15 7"),
            (*_solve_inputs(), *GOAL_INPUTS),
            (SURFACE, INFO, ERROR),
        ),
        Endpoint(
            "cgc/flow",
            "CGC Flow",
            "Run some steps of the Gaussian curvature flow with a fixed edge. Feed the result back to animate the flow.",
            icon("M3 19C8 19 8 13 12 13S16 7 21 7M17 4L21 7L18 11"),
            (MESH, K, Input("Steps", "N", "Integer", "Number of steps. Defaults to 10.", default=10, low=1, high=10000)),
            (SURFACE, INFO, ERROR),
        ),
        Endpoint(
            "cgc/analyse",
            "CGC Analyse",
            "Measure the curvature of a mesh at its interior vertices.",
            icon("M4 20V10M10 20V4M16 20V13M21 20H3", "#2b7bba"),
            (
                MESH,
                Input("Target", "T", "Number", "K at which the colour is neutral. Defaults to 0.", default=0.0, low=-1e9, high=1e9),
            ),
            (
                Output("Mesh", "M", "Mesh", "The mesh, coloured by K - Target: blue too small, red too large, grey on the edge."),
                Output("K", "K", "Number", "Gaussian curvature at each vertex in 1 / (model unit)², 0 on the edge."),
                Output("H", "H", "Number", "Mean curvature at each vertex in 1 / (model unit), 0 on the edge."),
                Output("Info", "I", "Text", "Report."),
            ),
        ),
        *build_endpoints({own.name: own for own in (*DRAWN_INPUTS, LAW)}, INFO),
        rationalise_endpoint(INFO),
        Endpoint(
            "cgc/submit",
            "CGC Submit",
            "Start a long solve in the background; CGC Fetch returns the result.",
            icon("M12 20V6M6 11L12 5L18 11"),
            _solve_inputs(),
            (Output("Job", "J", "Text", "Id of the job, for CGC Fetch."),),
        ),
        Endpoint(
            "cgc/fetch",
            "CGC Fetch",
            "Return the result of a job, or its progress.",
            icon("M12 4V18M6 13L12 19L18 13"),
            (
                Input("Job", "J", "Text", "Job from CGC Submit."),
                Input(
                    "Tick",
                    "T",
                    "Integer",
                    "A changing number, from a Timer or a slider, that triggers an update. Defaults to 0.",
                    default=0,
                ),
            ),
            (
                Output("Mesh", "M", "Mesh", "Surface, when the job is finished."),
                Output("Done", "D", "Boolean", "Whether the job is finished."),
                Output("Progress", "P", "Number", "Completed fraction of the steps, 0 to 1."),
                INFO,
            ),
        ),
    )
    return {own.uri: own for own in found}
