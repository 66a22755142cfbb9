"""Polygon file format .ply in double precision, with role and target of every vertex and creases as edges."""

from __future__ import annotations

import re
from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Iterator
from collections.abc import Mapping
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
from .cursor import reason_of
from .reading import ReadProblem
from .rows import Rows
from .rows import check_corners
from .rows import integer_of
from .rows import number_of

__all__ = ["ply_text", "read_ply"]

_END_OF_HEADER = re.compile(rb"(?<=[\r\n])end_header[ \t]*(?:\r\n|\r|\n)")
CORNERS = ("vertex_indices", "vertex_index")  # names of the property with the corners of faces
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


def read_ply(path: Path, tolerance: float = 0.0) -> ReadProblem:
    """Read a .ply file, text or binary of either byte order.

    The properties ``role`` and ``target`` of vertices and ``crease`` of edges, as written by
    :func:`ply_text`, are optional. Triangle strips become triangles.

    Parameters
    ----------
    path
        The file.
    tolerance
        Distance within which vertices are welded [L].
    """
    cursor = Cursor.of_file(path)
    where = ""
    try:
        kind, elements = _header(cursor)
        if kind == "ascii":
            rows = Rows(cursor, comments=("comment", "obj_info"))
            try:
                read = _text_values(cursor, rows, elements)
            except (IndexError, ValueError):
                where = rows.where
                raise
        else:
            read = _binary_rows(cursor, elements, kind)
        tables = dict(zip((element.name for element in elements), read))
        table = tables["vertex"]
        vertices = np.column_stack([np.asarray(table[axis], dtype=np.float64) for axis in "xyz"])
        faces = _faces(tables)
        edges = tables.get("edge", {})
        marked = zip(edges["vertex1"], edges["vertex2"], edges["crease"]) if "crease" in edges else ()
        creases = [[int(u), int(v)] for u, v, on in marked if on]
        roles = np.asarray(table.get("role", []), dtype=np.int64)
        targets = np.asarray(table["target"], dtype=np.float64) if "target" in table else None
    except (KeyError, IndexError, ValueError, OverflowError) as error:
        raise FileError(f"{path}{where} cannot be read as .ply ({reason_of(error)}); export it again") from None
    single = any(p.kind == "f4" and p.name == "x" for element in elements for p in element.properties)
    supports = np.flatnonzero(roles == FIXED).tolist()
    return clean_problem(
        path, vertices, faces, supports=supports, creases=creases, targets=targets, tolerance=tolerance, single=single and kind != "ascii"
    )


def _faces(tables: Mapping[str, Mapping[str, list]]) -> list[list[int]]:
    """Return the corners of all faces and of the triangles of strips."""
    shapes = tables.get("face", {})
    corners = next((name for name in CORNERS if name in shapes), None)
    if shapes and corners is None:
        raise ValueError(f"its faces have no vertex_indices, but {', '.join(shapes)}")
    faces = [[int(i) for i in face] for face in shapes[corners]] if corners else []
    strips = next((table for name, table in tables.items() if name in ("tristrips", "tri_strips")), {})
    for strip in next(iter(strips.values()), []):
        faces += _triangles(strip)
    return faces


def _triangles(strip: Iterable[int]) -> list[list[int]]:
    """Return the triangles of a strip, in which -1 begins a new one; every second triangle runs the other way."""
    triangles: list[list[int]] = []
    run: list[int] = []
    for vertex in [*strip, -1]:
        if vertex >= 0:
            run.append(int(vertex))
            continue
        parts = [[run[k], run[k + 1], run[k + 2]] if k % 2 == 0 else [run[k + 1], run[k], run[k + 2]] for k in range(len(run) - 2)]
        triangles += [part for part in parts if len(set(part)) == 3]
        run = []
    return triangles


def _header(cursor: Cursor) -> tuple[str, list[_Element]]:
    # Rows may end as on any system; the words may occur in comments too.
    end = _END_OF_HEADER.search(cursor.data)
    if not cursor.data[:4].lower().startswith(b"ply") or end is None:
        raise ValueError("it does not begin with a header")
    cursor.skip(end.end())
    kind, elements = "", []
    for words in (line.split() for line in cursor.data[: end.start()].decode("ascii", "replace").splitlines()):
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


def _text_values(cursor: Cursor, rows: Rows, elements: list[_Element]) -> list[dict[str, list]]:
    """Read one row for each entry, or values wherever the rows break if the number of rows differs."""
    if rows.left == sum(cursor.count(element.size, 1, f"elements {element.name!r}") for element in elements):
        return [_table_of_rows(element, rows) for element in elements]
    tables = [_table(element, (rows.words for _ in range(element.size))) for element in elements]
    rows.refuse_rest()
    return tables


def _table(element: _Element, sources: Iterable[Callable[[int], list[str]]]) -> dict[str, list]:
    """Return the values of an element by property; each source returns the next words of one entry."""
    table: dict[str, list] = {p.name: [] for p in element.properties}
    for words in sources:
        for p in element.properties:
            read = number_of if p.kind[0] == "f" else integer_of
            if p.length is None:
                table[p.name].append(read(words(1)[0]))
            else:
                length = _length(words(1)[0])
                if p.name in CORNERS and element.name == "face":
                    check_corners(length)
                table[p.name].append([read(word) for word in words(length)])
    return table


def _table_of_rows(element: _Element, rows: Rows) -> dict[str, list]:
    """Return the values of an element with one entry in each row, followed by the same number of further values."""
    further: set[int] = set()

    def sources() -> Iterator[Callable[[int], list[str]]]:
        for _ in range(element.size):
            row = _Row(rows.row())
            yield row.words
            further.add(row.left)
            if len(further) > 1:
                raise ValueError(f"the row has {row.left} values more than the header declares, unlike other rows")

    return _table(element, sources())


class _Row:
    """The words of one row."""

    def __init__(self, words: list[str]):
        self._words = words
        self._position = 0

    @property
    def left(self) -> int:
        return len(self._words) - self._position

    def words(self, count: int) -> list[str]:
        if count > self.left:
            raise ValueError("the row has fewer values than the header declares")
        self._position += count
        return self._words[self._position - count : self._position]


def _length(word: str) -> int:
    """Return the length of a list, which some programs write as a float."""
    value = number_of(word)
    if value != int(value):
        raise ValueError(f"the number of entries of a list must be an integer, not {word!r}")
    if value < 0:
        raise ValueError(f"the number of entries of a list must not be negative, unlike {word!r}")
    return int(value)


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
                    length = int(cursor.array(order + p.length, 1)[0])
                    if p.name in CORNERS and element.name == "face":
                        check_corners(length)
                    table[p.name].append(cursor.array(order + p.kind, length).tolist())
        tables.append(table)
    if cursor.left:
        raise ValueError(f"the file contains {cursor.left} bytes more than its header declares")
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
