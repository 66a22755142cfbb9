"""Read the plan in a DXF file, text or binary, through ezdxf."""

from __future__ import annotations

import io
import logging
import math
import re
from collections import Counter
from collections.abc import Iterable
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...meshing.cleanup import Omission
from ...model.problem import Drawing
from ...model.units import GivenLength
from ...model.units import within
from .._files import read_bytes
from ..cleanup import MAX_COORDINATE
from ..cursor import READ_LIMITS
from ..cursor import guarded
from ..rhino.units import plan_north
from .joining import joined
from .plan import Layer
from .plan import Plan
from .plan import PlanCurve
from .plan import PlanMesh
from .plan import size

__all__ = ["read_dxf_plan"]

BINARY = b"AutoCAD Binary DXF"
UNITS = {1: "Inches", 2: "Feet", 4: "Millimeters", 5: "Centimeters", 6: "Meters", 7: "Kilometers", 10: "Yards"}
MAX_ENTITIES = 200_000  # with those inside of blocks; a few nested blocks can hold more than any memory
MAX_DEPTH = 32  # blocks within blocks
SAGITTA = 1e-5  # of the size of the drawing, between a curve and its chords
SEGMENTS = 16  # chords of a quarter of a circle at least
OUT_OF_RANGE = f"with a coordinate that is not finite or exceeds {MAX_COORDINATE:g}"
CURVES = {"LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC", "ELLIPSE", "SPLINE", "HELIX"}
IN_WORDS = {
    "3DSOLID": "solid",
    "ATTDEF": "attribute definition",
    "ATTRIB": "attribute",
    "BODY": "solid",
    "DIMENSION": "dimension",
    "HATCH": "hatch",
    "IMAGE": "image",
    "LEADER": "leader",
    "MLINE": "multiline",
    "MTEXT": "text",
    "REGION": "region",
    "SURFACE": "surface",
    "TEXT": "text",
    "VIEWPORT": "viewport",
    "XLINE": "infinite line",
    "RAY": "infinite line",
}


def read_dxf_plan(path: Path, layers: Optional[Iterable[str]] = None, join: Optional[GivenLength] = None) -> Plan:
    """Read the curves, points and faces in the model space of a DXF file.

    Blocks are expanded, object coordinates converted, curves flattened, and ends that meet joined.

    Parameters
    ----------
    path
        The file, text or binary.
    layers
        Names of the layers to read, capitals do not matter. Default: all visible ones.
    join
        Distance within which ends of curves are joined [L]. Default: small gaps are closed.

    Raises
    ------
    FileError
        If the file cannot be read, or a layer does not exist.
    """
    document = _document(path)
    chosen = _Layers(document, layers)
    found = _Found()
    _refuse_too_many(document, path)
    for entity, layer in _expanded(document.modelspace(), chosen, found):
        found.add(entity, layer)
    chosen.check(path)
    curves = found.curves()
    points = np.array(found.points, dtype=np.float64).reshape(-1, 3)
    unit = UNITS.get(document.header.get("$INSUNITS", 0), "")
    made = joined(curves, within(join, unit))
    notes = [*made.notes, *found.notes(), *chosen.notes()]
    if not unit:
        notes.append("the drawing states no unit; its numbers are used as they are")
    paper = sum(len(layout) for layout in document.layouts if not layout.is_modelspace)
    if paper and not (curves or found.meshes):
        notes.append(f"{paper} objects lie in paper space, which is not read; move them to model space")
    north, unread = _north(document)
    return Plan(made.curves, points, found.meshes, chosen.listed(), unit, made.tolerance, [*notes, *unread], north)


def _north(document: Any) -> tuple[tuple[float, float], list[str]]:
    """Return the direction of north in plan from the geographic location of a drawing, and notes.

    The angle ``$NORTHDIRECTION`` gives no direction, as DXF does not define its sense of rotation.
    """
    location = document.modelspace().get_geodata()
    # Damaged drawings hold other objects, or handles, in its place.
    if getattr(location, "DXFTYPE", "") == "GEODATA":
        direction = location.dxf.north_direction
        return plan_north(direction.x, direction.y), []
    angle = math.degrees(document.header.get("$NORTHDIRECTION", 0.0))
    notes = [
        f"the drawing has an angle of {angle:.3g}° between y and north ($NORTHDIRECTION), whose sense of rotation DXF does not define; "
        "y is used as north; set the geographic location of the drawing (GEOGRAPHICLOCATION) to give its direction"
    ]
    return Drawing().north, notes if angle else []


def _document(path: Path) -> Any:
    try:
        from ezdxf import recover
        from ezdxf.document import Drawing as Document
        from ezdxf.lldxf.tagger import binary_tags_loader
    except ImportError:
        raise FileError(f"{path}: reading DXF needs ezdxf; install it: pip install 'compas_cgc[fabrication]'") from None
    content = read_bytes(path, READ_LIMITS.bytes)
    # Errors that ezdxf repairs need no note.
    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)
    with guarded(path):
        if content.startswith(BINARY):
            return Document.load(binary_tags_loader(content))
        return recover.read(io.BytesIO(content))[0]


class _Layers:
    """The layers of a document, and which of them are read."""

    def __init__(self, document: Any, names: Optional[Iterable[str]]):
        self.states = {layer.dxf.name.casefold(): not (layer.is_off() or layer.is_frozen()) for layer in document.layers}
        self.frozen = {layer.dxf.name.casefold() for layer in document.layers if layer.is_frozen()}
        self.counts: Counter = Counter()
        self.spelled = {layer.dxf.name.casefold(): layer.dxf.name for layer in document.layers}
        self.wanted = None if names is None else {name.casefold() for name in names}

    def check(self, path: Path) -> None:
        """Check that the wanted layers exist, in the table of layers or only at objects.

        Raises
        ------
        FileError
            If a layer does not exist.
        """
        missing = (self.wanted or set()) - set(self.spelled)
        if missing:
            raise FileError(f"{path}: there is no layer {min(missing)!r}; the layers are {', '.join(self.spelled.values())}")

    def is_read(self, layer: str) -> bool:
        own = layer.casefold()
        self.spelled.setdefault(own, layer)
        self.counts[own] += 1
        return self._reads(own)

    def _reads(self, own: str) -> bool:
        return self.states.get(own, True) if self.wanted is None else own in self.wanted

    def hides_block(self, layer: str) -> bool:
        return layer.casefold() in self.frozen and self.wanted is None

    def listed(self) -> list[Layer]:
        return [Layer(self.spelled[own], self.counts[own], self.states.get(own, True), self._reads(own)) for own in sorted(self.counts)]

    def notes(self) -> list[str]:
        hidden = [layer for layer in self.listed() if not layer.read]
        if not hidden:
            return []
        why = "hidden" if self.wanted is None else "not chosen"
        return [Omission(f"left out, on layers that are {why}: {', '.join(f'{layer.name} ({layer.objects})' for layer in hidden)}")]


def _refuse_too_many(document: Any, path: Path) -> None:
    """Check the number of objects in a drawing, including those in blocks, before blocks are expanded."""
    counts: dict[str, int] = {}

    def count(entities: Iterable[Any], depth: int) -> int:
        if depth > MAX_DEPTH:
            raise FileError(
                f"{path}: blocks are nested more than {MAX_DEPTH} deep, or contain themselves; explode them and save the file again"
            )
        total = 0
        for entity in entities:
            total += 1
            if entity.dxftype() == "INSERT" and entity.block() is not None:
                name = entity.dxf.name
                if name not in counts:
                    counts[name] = count(entity.block(), depth + 1)
                total += max(1, entity.mcount) * counts[name]
        return total

    total = count(document.modelspace(), 0)
    if total > MAX_ENTITIES:
        many = f"{total:.3g} objects including those in blocks, more than {MAX_ENTITIES:,}"
        raise FileError(f"{path}: the drawing has {many}; save the roof to a separate file")


def _expanded(entities: Iterable[Any], layers: _Layers, found: _Found) -> Iterator[tuple[Any, str]]:
    """Yield the objects, including those in blocks, with their effective layer."""
    stack = [(iter(entities), "0")]
    while stack:
        content, inherited = stack[-1]
        entity = next(content, None)
        if entity is None:
            stack.pop()
            continue
        layer = entity.dxf.get("layer", "0")
        layer = inherited if layer == "0" else layer
        if entity.dxf.get("invisible", 0):
            found.omitted["invisible object"] += 1
        elif entity.dxftype() == "INSERT":
            if layers.hides_block(layer):
                layers.is_read(layer)
            else:
                stack.append((_content(entity, found), layer))
        elif layers.is_read(layer):
            yield entity, layer


def _content(insert: Any, found: _Found) -> Iterator[Any]:
    """Yield the objects of a block reference in the coordinates of the drawing."""
    from ezdxf.lldxf.const import DXFError

    if insert.block() is None:
        found.omitted["reference to a missing block or file"] += 1
        return
    inserts = insert.multi_insert() if insert.mcount > 1 else (insert,)
    try:
        for one in inserts:
            yield from one.virtual_entities()
    except (DXFError, ValueError, ZeroDivisionError):
        found.omitted["block that cannot be expanded"] += 1


class _Found:
    """Objects collected from a drawing."""

    def __init__(self) -> None:
        self.paths: list[tuple[Any, str, Optional[tuple[float, float, float]]]] = []
        self.lines: list[PlanCurve] = []
        self.points: list[tuple[float, float, float]] = []
        self.meshes: list[PlanMesh] = []
        self.quads: dict[str, list[FloatArray]] = {}
        self.omitted: Counter = Counter()

    def add(self, entity: Any, layer: str) -> None:
        from ezdxf.lldxf.const import DXFError

        kind = entity.dxftype()
        try:
            if kind == "LINE":
                self._line([entity.dxf.start, entity.dxf.end], layer)
            elif kind == "POINT":
                self._point(tuple(entity.dxf.location))
            elif kind == "3DFACE":
                corners = np.array([tuple(corner) for corner in entity.wcs_vertices()])
                self.quads.setdefault(layer, []).append(np.concatenate([corners, corners[-1:]])[:4])
            elif kind == "MESH" or (kind == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh)):
                self._mesh(entity, layer)
            elif kind in CURVES:
                self._path(entity, layer)
            elif kind == "MLINE":
                for part in entity.virtual_entities():
                    self.add(part, layer)
            else:
                self.omitted[IN_WORDS.get(kind, kind)] += 1
        except (DXFError, ValueError, TypeError, AttributeError, ZeroDivisionError, IndexError):
            self.omitted[f"damaged {kind}"] += 1

    def _line(self, ends: list, layer: str) -> None:
        points = np.array([tuple(end) for end in ends], dtype=np.float64)
        if not _in_range(points):
            self.omitted[f"curve {OUT_OF_RANGE}"] += 1
        elif (points[0] == points[1]).all():
            self.omitted["line without length"] += 1
        else:
            self.lines.append(PlanCurve(points, layer))

    def _point(self, point: tuple[float, float, float]) -> None:
        if _in_range(np.array(point)):
            self.points.append(point)
        else:
            self.omitted[f"point {OUT_OF_RANGE}"] += 1

    def _path(self, entity: Any, layer: str) -> None:
        from ezdxf.path import make_path

        circle = None
        if entity.dxftype() == "CIRCLE":
            centre = entity.ocs().to_wcs(entity.dxf.center)
            upright = abs(abs(entity.dxf.extrusion.z) - 1.0) < 1e-9
            circle = (centre.x, centre.y, entity.dxf.radius) if upright else None
        path = make_path(entity)
        if not len(path):
            self.omitted["curve without length"] += 1
        else:
            self.paths.append((path, layer, circle))

    def _mesh(self, entity: Any, layer: str) -> None:
        from ezdxf.render.mesh import MeshBuilder

        builder = MeshBuilder.from_mesh(entity) if entity.dxftype() == "MESH" else MeshBuilder.from_polyface(entity)
        faces = [face for polygon in builder.faces for face in _quads(list(polygon))]
        vertices = np.array([tuple(vertex) for vertex in builder.vertices], dtype=np.float64).reshape(-1, 3)
        self.meshes.append(PlanMesh(vertices, np.array(faces, dtype=np.int64).reshape(-1, 4), layer))

    def curves(self) -> list[PlanCurve]:
        """Return the curves as polylines within a small tolerance, and collect the 3D faces as meshes."""
        for layer, quads in self.quads.items():
            vertices = np.concatenate(quads)
            self.meshes.append(PlanMesh(vertices, np.arange(len(vertices)).reshape(-1, 4), layer))
        self.quads = {}
        rough = [PlanCurve(_points(path.control_vertices()), layer) for path, layer, _ in self.paths]
        sagitta = SAGITTA * size([*self.lines, *(curve for curve in rough if _in_range(curve.points))])
        curves = list(self.lines)
        for (path, layer, circle), curve in zip(self.paths, rough):
            # The division of a curve with a coordinate that is not finite would not end.
            divisible = sagitta > 0 and _in_range(curve.points)
            points = _points(path.flattening(sagitta, SEGMENTS)) if divisible else np.empty((0, 3))
            if len(points) < 2 or not _in_range(points):
                self.omitted[f"curve {OUT_OF_RANGE}"] += 1
                continue
            # First and last point must be identical for a closed curve.
            if path.is_closed and len(points) > 3:
                points[-1] = points[0]
            curves.append(PlanCurve(points, layer, circle))
        return curves

    def notes(self) -> list[str]:
        if not self.omitted:
            return []
        listed = ", ".join(f"{count} {kind if count == 1 else _plural(kind)}" for kind, count in sorted(self.omitted.items()))
        return [Omission(f"left out: {listed}")]


def _plural(kind: str) -> str:
    """Return the plural of a noun, which a clause may follow."""
    noun, *clause = re.split(r"(?= without | with | to | that )", kind, maxsplit=1)
    return f"{noun}{'es' if noun.endswith('h') else 's'}{''.join(clause)}"


def _quads(polygon: list[int]) -> Iterator[list[int]]:
    """Yield the corners of a polygon as a quad, or as a fan of triangles that repeat their last corner."""
    if len(polygon) == 4:
        yield polygon
        return
    for a, b in zip(polygon[1:], polygon[2:]):
        yield [polygon[0], a, b, b]


def _in_range(points: FloatArray) -> bool:
    return bool((np.abs(points) <= MAX_COORDINATE).all())


def _points(places: Iterable) -> FloatArray:
    return np.array([tuple(place) for place in places], dtype=np.float64).reshape(-1, 3)
