"""Projection: the fairest surface with the curvature asked for, of any sign.

:func:`project` solves once, :class:`Projector` keeps what can be kept for the next time.
"""

from __future__ import annotations

from ...model.constraints import AtHeight
from ...model.constraints import Constraint
from ...model.constraints import Held
from ...model.constraints import Mirror
from ...model.constraints import Near
from ...model.constraints import OnCurve
from ...model.constraints import OnLine
from ...model.constraints import OnPlane
from .project import project
from .projector import Projector
from .settings import ProjectionSettings

__all__ = [
    "AtHeight",
    "Constraint",
    "Held",
    "Mirror",
    "Near",
    "OnCurve",
    "OnLine",
    "OnPlane",
    "ProjectionSettings",
    "Projector",
    "project",
]
