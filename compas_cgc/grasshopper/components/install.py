"""CGC Install: the Python package of all components."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from importlib import metadata
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._version import __version__
from ..runtime.component_feedback import add_error
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["InstallOutputs", "install"]

NAME = re.compile(r"[A-Za-z0-9._-]+")


class InstallOutputs(NamedTuple):
    """Outputs of the component."""

    info: Optional[list[str]]


@reports_errors(InstallOutputs)
def install(component: Any) -> InstallOutputs:
    """Return the installed versions; an error names packages that another plug-in loaded in another version."""
    installed = _installed()
    for name, version in installed.items():
        loaded = getattr(sys.modules.get(name), "__version__", version)
        if loaded != version:
            add_error(
                component,
                f"another plug-in has loaded {name} {loaded}, but compas_cgc uses {version}; restart Rhino and open this definition first",
            )
    set_message(component, f"v{__version__}")
    return InstallOutputs([f"{name} {version}" for name, version in installed.items()])


def _installed() -> dict[str, str]:
    """Return the versions of the package and of those that it requires on this system."""
    versions = {"compas_cgc": __version__}
    for line in metadata.requires("compas_cgc") or []:
        found = NAME.match(line)
        if found and "extra ==" not in line:
            with suppress(metadata.PackageNotFoundError):  # required on other systems or by other versions of Python only
                versions[found.group()] = metadata.version(found.group())
    return versions
