"""Packages that this package requires and another plug-in of the same Rhino has loaded in another version."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from importlib import metadata

from ..._version import __version__

__all__ = ["conflicts", "installed_versions"]

NAME = re.compile(r"[A-Za-z0-9._-]+")


def conflicts() -> list[str]:
    """Return a sentence for each package that is loaded in another version than the installed one."""
    found = []
    for name, version in installed_versions().items():
        loaded = getattr(sys.modules.get(name), "__version__", version)
        if loaded != version:
            found.append(
                f"another plug-in has loaded {name} {loaded}, but compas_cgc uses {version}; restart Rhino and open this definition first"
            )
    return found


def installed_versions() -> dict[str, str]:
    """Return the versions of the package and of those that it requires on this system."""
    versions = {"compas_cgc": __version__}
    for line in metadata.requires("compas_cgc") or []:
        found = NAME.match(line)
        if found and "extra ==" not in line:
            with suppress(metadata.PackageNotFoundError):  # required on other systems or by other versions of Python only
                versions[found.group()] = metadata.version(found.group())
    return versions
