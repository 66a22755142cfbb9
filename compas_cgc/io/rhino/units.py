"""Names of unit systems."""

from __future__ import annotations

from ...errors import FileError
from ._types import UnitSystem
from .archive import rhino3dm_module

__all__ = ["unit_name", "unit_system"]


def unit_name(system: UnitSystem) -> str:
    """Return the name of a unit system, such as ``Millimeters``."""
    return str(system).rsplit(".", 1)[-1]


def unit_system(name: str) -> UnitSystem:
    """Return the unit system with a name such as ``Millimeters``.

    Raises
    ------
    FileError
        If the name is unknown.
    """
    rhino3dm = rhino3dm_module()

    system = getattr(rhino3dm.UnitSystem, name, None)
    if not isinstance(system, rhino3dm.UnitSystem):
        raise FileError(f"unknown unit {name!r}; use a unit of Rhino such as Millimeters, Meters or Feet")
    return system
