"""Projection: the fairest surface with the curvature asked for, of any sign.

:func:`project` solves once, :class:`Projector` keeps what can be kept for the next time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._lazy import attach
from .method import METHOD
from .settings import ProjectionSettings

if TYPE_CHECKING:
    from .projector import Projector
    from .projector import project

__all__ = ["METHOD", "ProjectionSettings", "Projector", "project"]

__getattr__, __dir__ = attach(__name__, {"Projector": ".projector", "project": ".projector"})
