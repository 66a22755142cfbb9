"""CGC Install: the Python package of all components."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._version import __version__
from ..runtime.component_feedback import add_error
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.loaded_packages import conflicts
from ..runtime.loaded_packages import installed_versions

__all__ = ["InstallOutputs", "install"]


class InstallOutputs(NamedTuple):
    """Outputs of the component."""

    info: Optional[list[str]]


@reports_errors(InstallOutputs)
def install(component: Any) -> InstallOutputs:
    """Return the installed versions; an error names packages that another plug-in loaded in another version."""
    for sentence in conflicts():
        add_error(component, sentence)
    set_message(component, f"v{__version__}")
    return InstallOutputs([f"{name} {version}" for name, version in installed_versions().items()])
