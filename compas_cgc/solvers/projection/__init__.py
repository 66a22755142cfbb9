"""Projection: the fairest surface with the curvature asked for, of any sign.

:func:`project` solves once, :class:`Projector` keeps what can be kept for the next time.
"""

from __future__ import annotations

from ..._lazy import attach

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
