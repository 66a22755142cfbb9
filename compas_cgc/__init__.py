"""Surfaces of piecewise constant Gaussian curvature.

A designer's mesh goes in; the surface with the Gaussian curvature asked for in each region
comes out. See :func:`compas_cgc.solve`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._lazy import attach
from ._renamed import install as _install_old_names
from ._version import __version__

if TYPE_CHECKING:
    from .analysis import analyse
    from .datastructures import CGCMesh
    from .datastructures import SolveResult
    from .errors import CGCError
    from .errors import FileError
    from .errors import MeshError
    from .errors import ProblemError
    from .io import read
    from .io import write
    from .model.checks import check
    from .model.constraints import AtHeight
    from .model.constraints import Constraint
    from .model.constraints import Fixed
    from .model.constraints import Mirror
    from .model.constraints import OnCurve
    from .model.constraints import OnLine
    from .model.constraints import OnPlane
    from .model.constraints import Proximity
    from .model.problem import CGCProblem
    from .solvers.flow import FlowSettings
    from .solvers.newton import NewtonSettings
    from .solvers.projection import ProjectionSettings
    from .solvers.registry import settings_for
    from .solvers.run import solve
    from .solvers.settings import AutoSettings

__all__ = [
    "AtHeight",
    "AutoSettings",
    "CGCError",
    "CGCMesh",
    "CGCProblem",
    "Constraint",
    "FileError",
    "Fixed",
    "FlowSettings",
    "MeshError",
    "Mirror",
    "NewtonSettings",
    "OnCurve",
    "OnLine",
    "OnPlane",
    "ProblemError",
    "ProjectionSettings",
    "Proximity",
    "SolveResult",
    "__version__",
    "analyse",
    "check",
    "read",
    "settings_for",
    "solve",
    "write",
]

_install_old_names()

# COMPAS looks for plugins here.
__all_plugins__ = ["compas_cgc.scene", "compas_cgc.io.plugins"]

_ERRORS = dict.fromkeys(("CGCError", "FileError", "MeshError", "ProblemError"), ".errors")
_CONSTRAINTS = dict.fromkeys(
    ("AtHeight", "Constraint", "Fixed", "Mirror", "OnCurve", "OnLine", "OnPlane", "Proximity"), ".model.constraints"
)

__getattr__, __dir__ = attach(
    __name__,
    {
        **_ERRORS,
        **_CONSTRAINTS,
        "AutoSettings": ".solvers.settings",
        "CGCMesh": ".datastructures",
        "CGCProblem": ".model.problem",
        "FlowSettings": ".solvers.flow",
        "NewtonSettings": ".solvers.newton",
        "ProjectionSettings": ".solvers.projection",
        "SolveResult": ".datastructures",
        "analyse": ".analysis",
        "check": ".model.checks",
        "read": ".io",
        "settings_for": ".solvers.registry",
        "solve": ".solvers.run",
        "solve_problem": "._deprecated",
        "write": ".io",
    },
)
