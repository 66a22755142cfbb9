"""Surfaces of piecewise constant Gaussian curvature.

A designer's mesh goes in; the surface with the Gaussian curvature asked for in each region
comes out. See :func:`compas_cgc.solve`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._lazy import attach
from ._version import __version__

if TYPE_CHECKING:
    from ._samples import get
    from ._samples import samples
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
    from .model.goals.inequalities import Above
    from .model.goals.inequalities import Below
    from .model.goals.inequalities import Clearance
    from .model.goals.inequalities import NearPlane
    from .model.goals.inequalities import Within
    from .model.goals.places import EdgeInPlan
    from .model.goals.places import Height
    from .model.goals.places import Level
    from .model.goals.places import OnSurface
    from .model.goals.wholes import Area
    from .model.goals.wholes import Length
    from .model.goals.wholes import Rise
    from .model.goals.wholes import Unknown
    from .model.goals.wholes import Volume
    from .model.problem import CGCProblem
    from .solvers.flow import FlowSettings
    from .solvers.newton import NewtonSettings
    from .solvers.projection import ProjectionSettings
    from .solvers.registry import settings_for
    from .solvers.run import solve
    from .solvers.sensitivity import sensitivity
    from .solvers.settings import AutoSettings

__all__ = [
    "Above",
    "Area",
    "AtHeight",
    "AutoSettings",
    "Below",
    "CGCError",
    "CGCMesh",
    "CGCProblem",
    "Clearance",
    "Constraint",
    "EdgeInPlan",
    "FileError",
    "Fixed",
    "FlowSettings",
    "Height",
    "Length",
    "Level",
    "MeshError",
    "Mirror",
    "NearPlane",
    "NewtonSettings",
    "OnCurve",
    "OnLine",
    "OnPlane",
    "OnSurface",
    "ProblemError",
    "ProjectionSettings",
    "Proximity",
    "Rise",
    "SolveResult",
    "Unknown",
    "Volume",
    "Within",
    "__version__",
    "analyse",
    "check",
    "get",
    "read",
    "samples",
    "sensitivity",
    "settings_for",
    "solve",
    "write",
]

# COMPAS looks for plugins here.
__all_plugins__ = ["compas_cgc.scene", "compas_cgc.io.plugins"]

_ERRORS = dict.fromkeys(("CGCError", "FileError", "MeshError", "ProblemError"), ".errors")
_CONSTRAINTS = dict.fromkeys(
    ("AtHeight", "Constraint", "Fixed", "Mirror", "OnCurve", "OnLine", "OnPlane", "Proximity"), ".model.constraints"
)

_GOALS = {
    **dict.fromkeys(("Area", "Length", "Rise", "Unknown", "Volume"), ".model.goals.wholes"),
    **dict.fromkeys(("EdgeInPlan", "Height", "Level", "OnSurface"), ".model.goals.places"),
    **dict.fromkeys(("Above", "Below", "Clearance", "NearPlane", "Within"), ".model.goals.inequalities"),
}

__getattr__, __dir__ = attach(
    __name__,
    {
        **_ERRORS,
        **_CONSTRAINTS,
        **_GOALS,
        "AutoSettings": ".solvers.settings",
        "CGCMesh": ".datastructures",
        "CGCProblem": ".model.problem",
        "FlowSettings": ".solvers.flow",
        "NewtonSettings": ".solvers.newton",
        "ProjectionSettings": ".solvers.projection",
        "SolveResult": ".datastructures",
        "analyse": ".analysis",
        "check": ".model.checks",
        "get": "._samples",
        "read": ".io",
        "samples": "._samples",
        "sensitivity": ".solvers.sensitivity",
        "settings_for": ".solvers.registry",
        "solve": ".solvers.run",
        "write": ".io",
    },
)
