"""COMPAS data: JSON to objects of a fixed list of types, so that no file decides what is imported."""

from __future__ import annotations

from typing import Any
from typing import Optional

from ..errors import FileError

__all__ = ["KNOWN_TYPES", "objects_of"]

_GEOMETRY = (
    "Box Circle Ellipse Frame Line Plane Point Pointcloud Polygon Polyline Quaternion Sphere Transformation Translation Rotation Vector"
)
KNOWN_TYPES = frozenset(
    ["compas_cgc.datastructures/CGCMesh", "compas.datastructures/Mesh", "compas.datastructures/Graph", "compas.colors/Color"]
    + [f"compas.geometry/{name}" for name in _GEOMETRY.split()]
)


def objects_of(value: Any, expected: Optional[type] = None) -> Any:
    """Return parsed JSON with the COMPAS objects in it.

    ``compas.json_load`` imports the module of every type that the data names, which runs code of the choice of whoever wrote it.

    Parameters
    ----------
    value
        As the ``json`` module returns it.
    expected
        A further type that may be made, such as a subclass of a known one.

    Raises
    ------
    FileError
        If the data names another type than :data:`KNOWN_TYPES`, and no base class among them.
    """
    if isinstance(value, list):
        return [objects_of(item, expected) for item in value]
    if not isinstance(value, dict):
        return value
    inner = {key: objects_of(item, expected) for key, item in value.items()}
    if "dtype" not in inner:
        return inner
    # The most special class that is known; what derives from it elsewhere names its base classes.
    bases = value.get("inheritance") or []
    named = [value["dtype"], *(bases if isinstance(bases, list) else [])]
    if expected is not None and named[0] == expected.__clstype__():  # type: ignore[attr-defined]
        return expected.__jsonload__(inner.get("data"), guid=inner.get("guid"), name=inner.get("name"))  # type: ignore[attr-defined]
    known = next((name for name in named if isinstance(name, str) and name in KNOWN_TYPES), None)
    if known is None:
        raise FileError(f"the data contain an object of type {str(value['dtype'])[:60]!r}; only COMPAS meshes and simple geometry are read")
    from compas.data.encoders import cls_from_dtype

    kind: Any = cls_from_dtype(known)
    return kind.__jsonload__(inner.get("data"), guid=inner.get("guid"), name=inner.get("name"))
