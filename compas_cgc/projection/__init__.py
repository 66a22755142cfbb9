"""Projection: the nearest fair surface with the curvature asked for, of any sign.

:func:`project` solves once, :class:`Projector` keeps what can be kept for the next time.
"""

from __future__ import annotations

from .constraints import AtHeight
from .constraints import Constraint
from .constraints import Held
from .constraints import Mirror
from .constraints import Near
from .constraints import OnCurve
from .constraints import OnLine
from .constraints import OnPlane
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
