"""Info: what runs here."""

from __future__ import annotations

import platform
from importlib import metadata
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._version import __version__
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import say

__all__ = ["InfoOutputs", "info"]


class InfoOutputs(NamedTuple):
    """Outputs of the component."""

    info: Optional[list[str]]


@reporting(InfoOutputs)
def info(component: Any) -> InfoOutputs:
    """List the versions of the package, of Python and of what it builds on."""
    say(component, f"v{__version__}")
    lines = [f"compas_cgc {__version__}", f"Python {platform.python_version()} on {platform.system()}"]
    return InfoOutputs(lines + [f"{name} {metadata.version(name)}" for name in ("compas", "numpy", "scipy", "numba", "rhino3dm")])
