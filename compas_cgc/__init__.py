"""Surfaces of piecewise constant Gaussian curvature.

A designer's mesh goes in; the nearest fair surface with the Gaussian curvature asked for
in each region comes out. See :func:`compas_cgc.solve`.
"""

from __future__ import annotations

from importlib import import_module

from ._version import __version__

__all__ = [
    "CGCError",
    "CGCMesh",
    "CGCProblem",
    "FlowSettings",
    "NewtonSettings",
    "ProjectionSettings",
    "SolveResult",
    "__version__",
    "solve",
    "solve_problem",
]

__all_plugins__ = ["compas_cgc.scene"]

# Names are looked up when they are first used, so that importing the package costs nothing.
_HOME = {
    "CGCError": ".errors",
    "CGCMesh": ".datastructures",
    "CGCProblem": ".model.problem",
    "FlowSettings": ".solvers.flow",
    "NewtonSettings": ".solvers.newton",
    "ProjectionSettings": ".solvers.projection",
    "SolveResult": ".model.result",
    "solve": ".solvers.solve",
    "solve_problem": ".solvers.solve",
}


def __getattr__(name: str) -> object:
    if name in _HOME:
        return getattr(import_module(_HOME[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
