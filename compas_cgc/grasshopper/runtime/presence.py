"""Presence of a component on an open canvas."""

from __future__ import annotations

from typing import Any

__all__ = ["is_present"]


def is_present(component: Any) -> bool:
    """Check whether a component is on a canvas and enabled, and so are the clusters that contain it."""
    try:
        while True:
            document = component.OnPingDocument()
            if document is None or getattr(component, "Locked", False):
                return False
            # The owner of the document inside a cluster is the cluster, a component of another document.
            component = getattr(document, "Owner", None)
            if component is None or not hasattr(component, "OnPingDocument"):
                return True
    except Exception:  # the canvas may be taken apart in another thread meanwhile
        return False
