"""Conversion of a drawing made on the page (outline, holes, creases, columns, supports) to a problem with a mesh."""

from __future__ import annotations

import json
from collections.abc import Mapping
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.plan import flattened
from ...errors import COARSER
from ...errors import CGCError
from ...errors import Sentence
from ...meshing.outline import mesh_from_outline
from ...meshing.polyline import nearest_on_polyline
from ...model.problem import CGCProblem
from ...model.problem import Drawing
from ..api.decoding import LARGEST
from ..api.decoding import check_size
from ..api.decoding import number
from ..api.units import UNITS
from ..api.wording import in_request_words
from ..errors import TooLarge
from ..errors import Unprocessable
from ..limits import Limits
from .preview import contents

__all__ = ["Sketch", "mesh_of_sketch", "read_sketch"]

FIELDS = ("name", "unit", "edge_length", "outline", "holes", "creases", "points", "held")
MAX_CURVES = 500
MIN_SUPPORTS = 3  # a roof on fewer supports is unstable
MAX_POINTS = 20_000  # of all curves together
TOLERANCE = 1e-6  # distance below which two points coincide [L]


class Sketch(NamedTuple):
    """Drawing in plan [L]."""

    name: str
    unit: str  # abbreviation of the unit of length, empty for none
    edge_length: float
    outline: FloatArray  # (k, 2), closed: the last point equals the first
    holes: list[FloatArray]
    creases: list[FloatArray]
    points: FloatArray  # (k, 2) columns
    held: list[FloatArray]  # lines whose vertices are supports


def read_sketch(value: object, limits: Limits) -> Sketch:
    """Return the drawing in JSON data.

    Raises
    ------
    Unprocessable, TooLarge
        If a field is missing, invalid or too large.
    """
    if not isinstance(value, Mapping):
        raise Unprocessable("the drawing must be a JSON object with an 'outline' and an 'edge_length'")
    unknown = sorted(set(value) - set(FIELDS))
    if unknown:
        raise Unprocessable(f"unknown field {unknown[0]!r:.60} in the drawing; the fields are {', '.join(FIELDS)}")
    name, unit = value.get("name", ""), value.get("unit", "")
    if not isinstance(name, str) or unit not in tuple(UNITS):
        raise Unprocessable(f"'name' must be a string, and 'unit' one of {', '.join(filter(None, UNITS))}")
    edge_length = number(value.get("edge_length"), "'edge_length'")
    outline = _line(value.get("outline"), "'outline'", 3)
    groups = {key: _lines(value.get(key, []), key) for key in ("holes", "creases", "held")}
    points = _line(value.get("points", []), "'points'", 0)
    if sum(map(len, (outline, points, *groups["holes"], *groups["creases"], *groups["held"]))) > MAX_POINTS:
        raise TooLarge(f"the drawing has more than {MAX_POINTS} points; draw it with fewer")
    holes = [_closed(hole) for hole in groups["holes"]]
    sketch = Sketch(name[:100], unit, edge_length, _closed(outline), holes, groups["creases"], points, groups["held"])
    if not edge_length > 0:
        raise Unprocessable("the edge length must be greater than zero")
    # The mesh has half a vertex per equilateral triangle. Dividing twice avoids the underflow of a small squared length.
    count = _area(sketch.outline) / 0.866 / edge_length / edge_length
    if not count < limits.vertices:
        text = f"the mesh would have about {count:.2g} vertices; the server accepts at most {limits.vertices}; increase the edge length"
        raise TooLarge(Sentence(text, [COARSER]))
    return sketch


def mesh_of_sketch(sketch: Sketch, limits: Limits) -> bytes:
    """Mesh a drawing; return the mesh and its data as JSON, with the vertices at the columns.

    Raises
    ------
    Unprocessable
        If the drawing cannot be meshed.
    """
    try:
        holes, creases = [flattened(line) for line in sketch.holes], [flattened(line) for line in sketch.creases]
        made = mesh_from_outline(flattened(sketch.outline), holes, creases, sketch.edge_length, TOLERANCE, flattened(sketch.points))
        problem = CGCProblem(made.vertices, made.faces).with_creases(made.creases)
        check_size(len(problem.vertices), len(problem.faces), limits)
        columns, held = _columns(problem, sketch), _on_lines(problem, sketch.held, sketch.edge_length)
        notes = []
        supports = {vertex for vertex in (*columns, *held) if vertex >= 0}
        if len(supports) < MIN_SUPPORTS:
            # The edges of holes remain free, as that of an oculus.
            notes.append(f"the {'outline is also supported' if supports else 'whole outline is supported'} by default")
            supports.update(_on_lines(problem, [sketch.outline], sketch.edge_length))
        problem = problem.with_supports(sorted(supports))
        problem = replace(problem, drawing=Drawing(sketch.name or "Roof", units=UNITS[sketch.unit]))
        found = contents(problem, notes, sketch.name or "Roof")
    except CGCError as error:
        raise Unprocessable(in_request_words(error)) from None
    return json.dumps({**found, "columns": columns}, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _columns(problem: CGCProblem, sketch: Sketch) -> list[int]:
    """Return the vertex at each column inside the drawing."""
    if not len(sketch.points):
        return []
    gap, at = cKDTree(problem.vertices[:, :2]).query(sketch.points)
    return [int(vertex) if near <= 0.2 * sketch.edge_length else -1 for near, vertex in zip(gap, at)]


def _on_lines(problem: CGCProblem, lines: Sequence[FloatArray], edge_length: float) -> list[int]:
    """Return the vertices on lines in plan."""
    flat = problem.vertices * [1.0, 1.0, 0.0]
    near = [nearest_on_polyline(flat, flattened(line))[0] <= 1e-6 * edge_length for line in lines]
    return np.flatnonzero(np.any(near, axis=0)).tolist() if near else []


def _closed(ring: FloatArray) -> FloatArray:
    return ring if (ring[0] == ring[-1]).all() else np.concatenate([ring, ring[:1]])


def _area(ring: FloatArray) -> float:
    x, y = ring.T
    return 0.5 * abs(float(x[:-1] @ y[1:] - x[1:] @ y[:-1]))


def _lines(value: object, key: str) -> list[FloatArray]:
    if not isinstance(value, list) or len(value) > MAX_CURVES:
        raise Unprocessable(f"'{key}' must be a list of at most {MAX_CURVES} lines, each a list of [x, y]")
    return [_line(line, f"line {i} of '{key}'", 3 if key == "holes" else 2) for i, line in enumerate(value)]


def _line(value: object, what: str, least: int) -> FloatArray:
    if not isinstance(value, list) or len(value) < least or len(value) > MAX_POINTS:
        raise Unprocessable(f"{what} must be a list of at least {least} points [x, y]")
    for point in value:
        if not isinstance(point, list) or len(point) != 2:
            raise Unprocessable(f"every point of {what} must be [x, y]")
        for x in point:
            if abs(number(x, f"a coordinate of {what}")) > LARGEST:
                raise Unprocessable(f"a coordinate of {what} exceeds {LARGEST:g}; correct it")
    return np.array(value, dtype=np.float64).reshape(-1, 2)
