"""Mesh of a drawing made on the page: closed lines, folds, columns and held sides in, a posed problem out."""

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
from ...errors import CGCError
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
CURVES = 500  # most of one drawing
ENOUGH = 3  # supports; on fewer a roof tips over
POINTS = 20_000  # most of all its curves
TOLERANCE = 1e-6  # length below which two points are one


class Sketch(NamedTuple):
    """What is drawn in plan [L]."""

    name: str
    unit: str  # short name of a unit of length, empty for none
    edge_length: float
    outline: FloatArray  # (k, 2), the first point again at the end
    holes: list[FloatArray]
    creases: list[FloatArray]
    points: FloatArray  # (k, 2) columns
    held: list[FloatArray]  # lines whose vertices are held


def read_sketch(value: object, limits: Limits) -> Sketch:
    """Return the drawing in plain data.

    Raises
    ------
    Unprocessable, TooLarge
        With a sentence that names the field.
    """
    if not isinstance(value, Mapping):
        raise Unprocessable("the drawing must be a JSON object with an 'outline' and an 'edge_length'")
    unknown = sorted(set(value) - set(FIELDS))
    if unknown:
        raise Unprocessable(f"a drawing has no {unknown[0]!r:.60}; it has {', '.join(FIELDS)}")
    name, unit = value.get("name", ""), value.get("unit", "")
    if not isinstance(name, str) or unit not in tuple(UNITS):
        raise Unprocessable(f"'name' must be a text, and 'unit' one of {', '.join(filter(None, UNITS))}")
    edge_length = number(value.get("edge_length"), "'edge_length'")
    outline = _line(value.get("outline"), "'outline'", 3)
    groups = {key: _lines(value.get(key, []), key) for key in ("holes", "creases", "held")}
    points = _line(value.get("points", []), "'points'", 0)
    if sum(map(len, (outline, points, *groups["holes"], *groups["creases"], *groups["held"]))) > POINTS:
        raise TooLarge(f"the drawing has more than {POINTS} points; draw it with fewer")
    holes = [_closed(hole) for hole in groups["holes"]]
    sketch = Sketch(name[:100], unit, edge_length, _closed(outline), holes, groups["creases"], points, groups["held"])
    if not edge_length > 0:
        raise Unprocessable("the edge length must be above zero")
    # An equilateral triangle has half a vertex; the square of a tiny length would be zero.
    count = _area(sketch.outline) / 0.866 / edge_length / edge_length
    if not count < limits.vertices:
        raise TooLarge(
            f"with edges this short the mesh would have some {count:.2g} vertices, the server takes {limits.vertices}; make them longer"
        )
    return sketch


def mesh_of_sketch(sketch: Sketch, limits: Limits) -> bytes:
    """Mesh a drawing; tell what it holds as JSON, with the vertices of its columns.

    Raises
    ------
    Unprocessable
        With the sentence of the mesher.
    """
    try:
        holes, creases = [flattened(line) for line in sketch.holes], [flattened(line) for line in sketch.creases]
        made = mesh_from_outline(flattened(sketch.outline), holes, creases, sketch.edge_length, TOLERANCE, flattened(sketch.points))
        problem = CGCProblem(made.vertices, made.faces).with_creases(made.creases)
        check_size(len(problem.vertices), len(problem.faces), limits)
        columns, held = _columns(problem, sketch), _on_lines(problem, sketch.held, sketch.edge_length)
        notes = []
        supports = {vertex for vertex in (*columns, *held) if vertex >= 0}
        if len(supports) < ENOUGH:
            # Not the edges of holes: an oculus is free.
            notes.append(f"the {'outline is held too' if supports else 'whole outline is held'}, to begin with")
            supports.update(_on_lines(problem, [sketch.outline], sketch.edge_length))
        problem = problem.with_supports(sorted(supports))
        problem = replace(problem, drawing=Drawing(sketch.name or "Roof", units=UNITS[sketch.unit]))
        found = contents(problem, notes, sketch.name or "Roof")
    except CGCError as error:
        raise Unprocessable(in_request_words(error)) from None
    return json.dumps({**found, "columns": columns}, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _columns(problem: CGCProblem, sketch: Sketch) -> list[int]:
    """Return the vertex at each column, of those that stand within the drawing."""
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
    if not isinstance(value, list) or len(value) > CURVES:
        raise Unprocessable(f"'{key}' must be a list of at most {CURVES} lines, each a list of [x, y]")
    return [_line(line, f"line {i} of '{key}'", 3 if key == "holes" else 2) for i, line in enumerate(value)]


def _line(value: object, what: str, least: int) -> FloatArray:
    if not isinstance(value, list) or len(value) < least or len(value) > POINTS:
        raise Unprocessable(f"{what} must be a list of at least {least} points [x, y]")
    for point in value:
        if not isinstance(point, list) or len(point) != 2:
            raise Unprocessable(f"every point of {what} must be [x, y]")
        for x in point:
            if abs(number(x, f"a coordinate of {what}")) > LARGEST:
                raise Unprocessable(f"a coordinate of {what} is larger than {LARGEST:g}; correct it")
    return np.array(value, dtype=np.float64).reshape(-1, 2)
