"""Headless documents: each solution must be complete, because nothing runs a component again."""

from __future__ import annotations

from typing import Any

__all__ = ["is_headless"]


def is_headless(component: Any) -> bool:
    """Check whether a component is in a cluster, or in a Rhino without windows such as rhino.compute."""
    import Rhino

    document = component.OnPingDocument()
    in_cluster = document is not None and getattr(document, "Owner", None) is not None
    return in_cluster or bool(getattr(getattr(Rhino, "RhinoApp", None), "IsRunningHeadless", False))
