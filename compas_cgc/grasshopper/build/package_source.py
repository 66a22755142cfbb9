"""Package source: where Rhino's pip finds the Python package of the components."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Optional

from ..._version import __version__
from ...errors import FileError
from .component_manifest import Bundle

__all__ = ["requirement", "with_package"]

PINNED = f"compas_cgc=={__version__}"
WHEEL = f"compas_cgc-{__version__}-py3-none-any.whl"


def requirement(package: Optional[str] = None) -> str:
    """Return the requirement of the component CGC Install.

    Parameters
    ----------
    package
        Path or address of a wheel, or of a folder of wheels. Default: the index that Rhino's pip is configured for.

    Raises
    ------
    FileError
        If the wheel does not exist, or is another package or version.

    Examples
    --------
    >>> requirement() == f"compas_cgc=={__version__}"
    True
    """
    if package is None:
        return PINNED
    remote = "://" in package
    place = package.rstrip("/") if remote else str(Path(package).expanduser().resolve())
    if not place.endswith(".whl"):
        place = f"{place}/{WHEEL}"
    name = Path(place).name
    if not name.startswith(f"compas_cgc-{__version__}-"):
        raise FileError(f"the wheel {name} is not compas_cgc {__version__}, which these components need; build the wheel of this version")
    if remote:
        return f"compas_cgc @ {place}"
    if not Path(place).is_file():
        raise FileError(f"there is no wheel {place}; build it with 'python -m build --wheel', or give the address of an index folder")
    return f"compas_cgc @ {Path(place).as_uri()}"


def with_package(bundles: Iterable[Bundle], package: Optional[str]) -> list[Bundle]:
    """Return the components with the requirement for a package source, see :func:`requirement`."""
    line = f"# r: {requirement(package)}\n"
    return [replace(bundle, code=bundle.code.replace(f"# r: {PINNED}\n", line)) for bundle in bundles]
