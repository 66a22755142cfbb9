"""Names of unit systems, and the north of a model."""

from __future__ import annotations

import math

from ...errors import FileError
from ...model.problem import Drawing
from ._types import Archive
from ._types import UnitSystem
from .archive import rhino3dm_module

__all__ = ["north_of", "plan_north", "set_north", "unit_name", "unit_system"]


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


def north_of(archive: Archive) -> tuple[float, float]:
    """Return the direction of north in plan, as set by the earth anchor point of a file; y where it has none."""
    north = archive.Settings.EarthAnchorPoint.ModelNorth
    return plan_north(north.X, north.Y)


def plan_north(x: float, y: float) -> tuple[float, float]:
    """Return the unit vector of a direction of north in plan, y if it has no finite length."""
    length = math.hypot(x, y)
    return (x / length, y / length) if math.isfinite(length) and length > 0.0 else Drawing().north


def set_north(archive: Archive, north: tuple[float, float]) -> None:
    """Set the direction of north in plan."""
    anchor = archive.Settings.EarthAnchorPoint
    anchor.ModelNorth = rhino3dm_module().Vector3d(*north, 0.0)
    archive.Settings.EarthAnchorPoint = anchor
