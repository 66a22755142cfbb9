"""Header of an openNURBS archive: what an object is, read without decoding it."""

from __future__ import annotations

import base64
import struct
from typing import Any
from typing import NamedTuple
from typing import Optional
from uuid import UUID

__all__ = ["CURVES", "Head", "read_head"]

CURVES = ("ArcCurve", "LineCurve", "NurbsCurve", "PolyCurve", "PolylineCurve")
_BEGIN = b"\xfa\x7f\x02\x00"  # begins an object, here and in every .3dm file
_LENGTH = 88  # characters of base64 for the 65 bytes needed
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
    """What the archive of an object begins with."""

    name: str  # of the class, "object" for one of no use here
    vertices: int  # of a mesh
    faces: int  # of a mesh


def read_head(archive: Any) -> Optional[Head]:
    """Return what an object in base64 says of itself, None if it is no archive of one."""
    try:
        head = base64.b64decode(archive[:_LENGTH])
    except (TypeError, ValueError):
        return None
    if head[:4] != _BEGIN or len(head) < 40:
        return None
    # In a chunk (type and length in 12 bytes) stand a chunk with the class, then one with the data:
    # those of a mesh begin with a byte for the version and the numbers of vertices and faces.
    name = _NAMES.get(UUID(bytes_le=head[24:40]), "object")
    counts = struct.unpack_from("<ii", head, 57) if name == "Mesh" and len(head) >= 65 else (0, 0)
    return Head(name, *counts)
