"""Object file format .off: vertices and faces in full precision."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import FileError
from ..model.problem import CGCProblem
from .cleanup import clean_problem
from .cursor import Cursor
from .reading import ReadProblem
from .rows import Rows
from .rows import check_corners
from .rows import integer_of
from .rows import number_of

__all__ = ["off_text", "read_off"]

# Texture, colour, normal, homogeneous and any dimension; the counts may follow without a space.
_HEADER = re.compile(r"^(ST)?(C)?(N)?(4)?(n)?OFF(?=\d|$)")
_BINARY = re.compile(rb"\w*OFF[ \t]+BINARY\b", re.IGNORECASE)
COLOURS = (0, 1, 3, 4)  # values after the corners of a face


class _Layout(NamedTuple):
    """Numbers of each vertex."""

    size: int  # of the coordinates
    whole: int  # with normal, colour and texture


def read_off(path: Path, tolerance: float = 0.0) -> ReadProblem:
    """Read a .off file, with or without its first word; colours, normals and textures are not used.

    Parameters
    ----------
    path
        The file.
    tolerance
        Distance within which vertices are welded [L].
    """
    cursor = Cursor.of_file(path)
    if _BINARY.match(cursor.data):
        raise FileError(f"{path} is a binary .off file, which is not read; export it as text")
    rows = Rows(cursor)
    layout = _header(rows, path)
    try:
        n, m = rows.integer(), rows.integer()
        # The number of edges, which some programs leave out.
        if rows.in_row or (rows.left > n + m and rows.row_size == 1):
            rows.integer()
        cursor.count(n, 1, "vertices")
        cursor.count(m, 1, "faces")
        places, faces = (_by_rows if rows.left == n + m else _by_words)(rows, n, m, layout)
    except (IndexError, ValueError) as error:
        raise FileError(f"{path}{rows.where}: {error}; correct the file or export it again") from None
    if layout.size == 4:
        places = places / places[:, 3:]
    return clean_problem(path, places[:, :3], faces, tolerance=tolerance)


def _header(rows: Rows, path: Path) -> _Layout:
    word = rows.peek()
    found = _HEADER.match(word) or _HEADER.match(word.upper())
    if found is None and not re.fullmatch(r"\d+", word):
        raise FileError(f"{path} does not begin with OFF or with counts; give an .off file")
    if found is None:
        return _Layout(3, 3)
    texture, colour, normal, four, any_size = found.groups()
    rows.replace_next(word[found.end() :])
    size = 4 if four else 3
    if any_size and rows.integer() != 3:
        raise FileError(f"{path} has vertices that are not three-dimensional; export them with three coordinates")
    return _Layout(size, size + (3 if normal else 0) + (4 if colour else 0) + (2 if texture else 0))


def _by_words(rows: Rows, n: int, m: int, layout: _Layout) -> tuple[FloatArray, list[list[int]]]:
    """Read numbers wherever the rows break; colours of faces cannot be distinguished from the next face."""
    words = rows.words(n * layout.whole)
    columns = [[number_of(word) for word in words[axis :: layout.whole]] for axis in range(layout.size)]
    faces = [_face(rows.words(check_corners(rows.count("corners"))), n) for _ in range(m)]
    rows.refuse_rest()
    return np.array(columns, dtype=np.float64).T, faces


def _by_rows(rows: Rows, n: int, m: int, layout: _Layout) -> tuple[FloatArray, list[list[int]]]:
    """Read a row for each vertex and face; further numbers in a row are colours and the like."""
    vertices = []
    width = max(layout.size, rows.row_size)
    for _ in range(n):
        words = rows.row()
        if len(words) != width:
            raise ValueError(f"the vertex has {len(words)} numbers, but {width} are expected")
        vertices.append([number_of(word) for word in words[: layout.size]])
    faces = []
    colours = set()
    for _ in range(m):
        size, *words = rows.row()
        corners = check_corners(integer_of(size))
        colours.add(len(words) - corners)
        if not colours.issubset(COLOURS):
            raise ValueError(f"the face declares {corners} corners, but {len(words)} numbers follow")
        if len(colours - {0}) > 1 or colours == {0, 1}:
            raise ValueError(f"{len(words) - corners} numbers follow the corners of the face, unlike in other rows")
        faces.append(_face(words[:corners], n))
    return np.array(vertices, dtype=np.float64).reshape(n, layout.size), faces


def _face(words: list[str], n: int) -> list[int]:
    face = [integer_of(word) for word in words]
    wrong = next((v for v in face if not 0 <= v < n), None)
    if wrong is not None:
        raise ValueError(f"vertex {wrong} does not exist; there are {n}, counted from 0")
    return face


def off_text(problem: CGCProblem) -> str:
    """Return a mesh as the text of a .off file, which does not hold roles."""
    lines = ["OFF", f"{len(problem.vertices)} {len(problem.faces)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in zip(*problem.vertices.T.tolist())]
    lines += [f"3 {a} {b} {c}" for a, b, c in zip(*problem.faces.T.tolist())]
    return "\n".join(lines) + "\n"
