"""Info: versions of the installed packages."""

from __future__ import annotations

import platform
from importlib import metadata
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._version import __version__
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["InfoOutputs", "info"]


class InfoOutputs(NamedTuple):
    """Outputs of the component."""

    info: Optional[list[str]]


@reports_errors(InfoOutputs)
def info(component: Any) -> InfoOutputs:
    """Return the versions of the package, of Python and of its dependencies."""
    set_message(component, f"v{__version__}")
    lines = [f"compas_cgc {__version__}", f"Python {platform.python_version()} on {platform.system()}"]
    return InfoOutputs(lines + [_version(name) for name in ("compas", "numpy", "scipy", "numba", "rhino3dm")])


def _version(name: str) -> str:
    try:
        return f"{name} {metadata.version(name)}"
    except metadata.PackageNotFoundError:  # an optional dependency
        return f"{name} is not installed"
