"""Polygon file format .ply in double precision, with role and target of every vertex and creases as edges."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..errors import FileError
from ..model.problem import CGCProblem
from ..model.roles import FIXED
from ..model.roles import ROLES
from .cleanup import clean_problem
from .cursor import Cursor
from .reading import ReadProblem

__all__ = ["ply_text", "read_ply"]

_TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}


class _Property(NamedTuple):
    name: str
    kind: str  # numpy type
    length: Optional[str]  # numpy type of the length of a list, None for a single value


class _Element(NamedTuple):
    name: str
    size: int
    properties: list[_Property]


def read_ply(path: Path) -> ReadProblem:
    """Read a .ply file, text or binary of either byte order.

    The properties ``role`` and ``target`` of vertices and ``crease`` of edges, as written by
    :func:`ply_text`, are optional.
    """
    cursor = Cursor.of_file(path)
    try:
        kind, elements = _header(cursor)
        rows = _text_rows(cursor, elements) if kind == "ascii" else _binary_rows(cursor, elements, kind)
        tables = dict(zip((element.name for element in elements), rows))
        table = tables["vertex"]
        vertices = np.column_stack([np.asarray(table[axis], dtype=np.float64) for axis in "xyz"])
        shapes = tables.get("face", {"vertex_indices": []})
        corners = next(name for name in ("vertex_indices", "vertex_index") if name in shapes)
        faces = [[int(i) for i in face] for face in shapes[corners]]
        edges = tables.get("edge", {})
        marked = zip(edges["vertex1"], edges["vertex2"], edges["crease"]) if "crease" in edges else ()
        creases = [[int(u), int(v)] for u, v, on in marked if on]
        roles = np.asarray(table.get("role", []), dtype=np.int64)
        targets = np.asarray(table["target"], dtype=np.float64) if "target" in table else None
    except (KeyError, IndexError, ValueError, StopIteration, OverflowError) as error:
        raise FileError(f"{path} cannot be read as .ply ({error or 'it ends too early'}); export it again") from None
    single = any(p.kind == "f4" and p.name == "x" for element in elements for p in element.properties) and kind != "ascii"
    notes = ("this .ply file stores only seven digits; .3dm and .obj files keep full precision",) if single else ()
    supports = np.flatnonzero(roles == FIXED).tolist()
    return clean_problem(path, vertices, faces, supports=supports, creases=creases, targets=targets, notes=notes)


def _header(cursor: Cursor) -> tuple[str, list[_Element]]:
    data = cursor.data
    end = data.find(b"end_header")
    if not data[:4].lower().startswith(b"ply") or end < 0:
        raise ValueError("it does not begin with a header")
    cursor.skip(data.index(b"\n", end) + 1)
    kind, elements = "", []
    for words in (line.split() for line in data[:end].decode("ascii", "replace").splitlines()):
        if words[:1] == ["format"]:
            kind = words[1]
        elif words[:1] == ["element"]:
            elements.append(_Element(words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1].properties.append(_Property(words[4], _TYPES[words[3]], _TYPES[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1].properties.append(_Property(words[2], _TYPES[words[1]], None))
    if kind not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise ValueError(f"the format {kind!r} is unknown")
    return kind, elements


def _text_rows(cursor: Cursor, elements: list[_Element]) -> list[dict[str, list]]:
    words = cursor.words()
    tables = []
    for element in elements:
        table: dict[str, list] = {p.name: [] for p in element.properties}
        for _ in range(cursor.count(element.size, len(element.properties), f"elements {element.name!r}")):
            for p in element.properties:
                read = float if p.kind[0] == "f" else int
                if p.length is None:
                    table[p.name].append(read(next(words)))
                else:
                    count = cursor.count(int(next(words)), 1, f"values of {p.name!r}")
                    table[p.name].append([read(next(words)) for _ in range(count)])
        tables.append(table)
    return tables


def _binary_rows(cursor: Cursor, elements: list[_Element], kind: str) -> list[dict[str, list]]:
    tables = []
    order = "<" if kind == "binary_little_endian" else ">"
    for element in elements:
        if all(p.length is None for p in element.properties):
            rows = cursor.array([(p.name, order + p.kind) for p in element.properties], element.size)
            tables.append({p.name: rows[p.name].tolist() for p in element.properties})
            continue
        table: dict[str, list] = {p.name: [] for p in element.properties}
        least = sum(np.dtype(p.length or p.kind).itemsize for p in element.properties)
        for _ in cursor.timed(range(cursor.count(element.size, least, f"elements {element.name!r}"))):
            for p in element.properties:
                if p.length is None:
                    table[p.name].append(cursor.array(order + p.kind, 1)[0].item())
                else:
                    table[p.name].append(cursor.array(order + p.kind, int(cursor.array(order + p.length, 1)[0])).tolist())
        tables.append(table)
    return tables


def ply_text(problem: CGCProblem) -> str:
    """Return a mesh as a .ply file in text."""
    lines = ["ply", "format ascii 1.0", f"comment compas_cgc: role = {', '.join(f'{i} {role}' for i, role in enumerate(ROLES))}"]
    lines += [f"element vertex {len(problem.vertices)}", *(f"property double {axis}" for axis in "xyz")]
    lines += ["property uchar role", "property double target"]
    lines += [f"element face {len(problem.faces)}", "property list uchar int vertex_indices"]
    if len(problem.creases):  # some readers know vertices and faces only
        lines += [f"element edge {len(problem.creases)}", "property int vertex1", "property int vertex2", "property uchar crease"]
    lines += ["end_header"]
    columns = zip(*problem.vertices.T.tolist(), problem.roles.tolist(), problem.targets.tolist())
    lines += [f"{x!r} {y!r} {z!r} {role} {K!r}" for x, y, z, role, K in columns]
    lines += [f"3 {a} {b} {c}" for a, b, c in zip(*problem.faces.T.tolist())]
    lines += [f"{u} {v} 1" for u, v in problem.creases.tolist()]
    return "\n".join(lines) + "\n"
