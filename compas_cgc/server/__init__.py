"""The compute server: solves over HTTP for browsers, scripts and Grasshopper (Hops)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._lazy import attach

if TYPE_CHECKING:
    from .app import create_app
    from .limits import Limits
    from .run import serve

__all__ = ["Limits", "create_app", "serve"]

# Looked up when first used: the worker processes need no web framework.
__getattr__, __dir__ = attach(__name__, {"Limits": ".limits", "create_app": ".app", "serve": ".run"})
