"""Header of an openNURBS archive: the class of an object, read without decoding it."""

from __future__ import annotations

import base64
import struct
from typing import Any
from typing import NamedTuple
from typing import Optional
from uuid import UUID

__all__ = ["CURVES", "Head", "read_head"]

CURVES = ("ArcCurve", "LineCurve", "NurbsCurve", "PolyCurve", "PolylineCurve")
_BEGIN = b"\xfa\x7f\x02\x00"  # type code at the beginning of every object
_LENGTH = 88  # base64 characters of the first 65 bytes
_NAMES = {
    UUID("4ed7d4e4-e947-11d3-bfe5-0010830122f0"): "Mesh",
    UUID("60b5dbc5-e660-11d3-bfe4-0010830122f0"): "Brep",
    UUID("f09ba4d9-455b-42c3-ba3b-e6ccacef853b"): "SubD",
    UUID("36f53175-72b8-4d47-bf1f-b4e6fc24f4b9"): "Extrusion",
    UUID("4ed7d4de-e947-11d3-bfe5-0010830122f0"): "NurbsSurface",
    UUID("c3101a1d-f157-11d3-bfe7-0010830122f0"): "Point",
    UUID("2488f347-f8fa-11d3-bfec-0010830122f0"): "PointCloud",
    UUID("74198302-cdf4-4f95-9609-6d684f22ab37"): "TextDot",
    UUID("cf33be2a-09b4-11d4-bffb-0010830122f0"): "ArcCurve",
    UUID("4ed7d4db-e947-11d3-bfe5-0010830122f0"): "LineCurve",
    UUID("4ed7d4dd-e947-11d3-bfe5-0010830122f0"): "NurbsCurve",
    UUID("4ed7d4e0-e947-11d3-bfe5-0010830122f0"): "PolyCurve",
    UUID("4ed7d4e6-e947-11d3-bfe5-0010830122f0"): "PolylineCurve",
}


class Head(NamedTuple):
    """Beginning of the archive of an object."""

    name: str  # name of the class, "object" for unsupported classes
    vertices: int  # number of vertices of a mesh
    faces: int  # number of faces of a mesh


def read_head(archive: Any) -> Optional[Head]:
    """Return the header of an object in base64, None if it is not a valid archive."""
    try:
        head = base64.b64decode(archive[:_LENGTH])
    except (TypeError, ValueError):
        return None
    if head[:4] != _BEGIN or len(head) < 40:
        return None
    # A chunk (12 bytes of type and length) contains a chunk with the class and one with the data.
    # The data of a mesh begin with a version byte and the numbers of vertices and faces.
    name = _NAMES.get(UUID(bytes_le=head[24:40]), "object")
    counts = struct.unpack_from("<ii", head, 57) if name == "Mesh" and len(head) >= 65 else (0, 0)
    return Head(name, *counts)
