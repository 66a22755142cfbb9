"""Classes of rhino3dm by name, for annotations: its own descriptions call read-only what can be set, and lists no iterables."""

from __future__ import annotations

from typing import Any

__all__ = ["Archive", "Curve", "Geometry", "Mesh", "ObjectAttributes", "Point3d", "UnitSystem"]

Archive = Any  # File3dm
Curve = Any
Geometry = Any  # GeometryBase
Mesh = Any
ObjectAttributes = Any
Point3d = Any
UnitSystem = Any
