"""The compute server: solves over HTTP for browsers, scripts and Grasshopper (Hops)."""

from __future__ import annotations

from importlib import import_module

__all__ = ["Limits", "create_app", "serve"]

# Looked up when first used: the worker processes need no web framework.
_HOME = {"Limits": ".limits", "create_app": ".app", "serve": ".run"}


def __getattr__(name: str) -> object:
    if name in _HOME:
        return getattr(import_module(_HOME[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
