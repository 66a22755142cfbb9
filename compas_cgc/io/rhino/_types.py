"""Type aliases for classes of rhino3dm, whose own stubs wrongly mark attributes as read-only and lists as not iterable."""

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
