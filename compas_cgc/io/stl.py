"""Stereolithography .stl: triangles without shared vertices; text files have full precision."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..errors import FileError
from ..meshing.cleanup import Omission
from ..model.problem import CGCProblem
from .cleanup import clean_problem
from .cursor import Cursor
from .reading import ReadProblem
from .rows import number_of

__all__ = ["read_stl", "stl_text"]

_STATEMENT = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)(?=\s+(?:vertex|endloop|endfacet)\b)|\b(?:end)?facet\b", re.IGNORECASE)
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: Path, tolerance: float = 0.0) -> ReadProblem:
    """Read a .stl file, binary or text; corners at the same place become one vertex.

    Parameters
    ----------
    path
        The file.
    tolerance
        Distance within which vertices are welded [L].
    """
    data = Cursor.of_file(path).data
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    rest = len(data) - 84 - 50 * count
    # Headers of binary files may begin with "solid", and text files with comments; the count of a binary file holds zeros.
    is_text = b"facet" in data[:1024].lower() and b"\0" not in data[:1024]
    notes: tuple[str, ...] = ()
    if rest == 0 or (count > 0 and rest > 0 and rest % _RECORD.itemsize and not is_text):
        with np.errstate(invalid="ignore"):  # signalling NaN
            corners = np.frombuffer(data, dtype=_RECORD, count=count, offset=84)["corners"].reshape(-1, 3).astype(np.float64)
        notes = (Omission(f"{rest} bytes after the last of the {count} triangles were ignored"),) if rest else ()
    elif is_text:
        corners = _text_corners(path, data)
    elif count > 0:
        raise FileError(f"{path} declares {count} triangles but holds {(len(data) - 84) // _RECORD.itemsize}; export it again")
    else:
        raise FileError(f"{path} is not a complete .stl file; export it again")
    faces = np.arange(len(corners)).reshape(-1, 3).tolist()
    return clean_problem(path, corners, faces, notes=notes, tolerance=tolerance, single=not is_text or rest == 0)


def _text_corners(path: Path, data: bytes) -> FloatArray:
    """Return the corners (3 m, 3) of the facets, each of which holds three vertices."""
    corners: list[list[float]] = []
    facets, is_open = 0, False
    try:
        for found in _STATEMENT.finditer(data):
            if found[1] is not None:
                corners.append([number_of(word.decode("latin-1")) for word in found.groups()])
                continue
            if is_open == (found[0][:1] in b"fF") or len(corners) != 3 * facets + 3 * is_open:
                break
            facets, is_open = facets + is_open, not is_open
        else:
            if not is_open and len(corners) == 3 * facets:
                return np.array(corners, dtype=np.float64).reshape(-1, 3)
    except ValueError as error:
        raise FileError(f"{path}, facet {facets + 1}: {error}; export it again") from None
    raise FileError(f"{path}: facet {facets + 1} does not have three vertices between facet and endfacet; export it again")


def stl_text(problem: CGCProblem) -> str:
    """Return a mesh as the text of a .stl file, which does not hold roles."""
    name = "_".join(problem.drawing.name.split())
    points = [f"vertex {x!r} {y!r} {z!r}" for x, y, z in zip(*problem.vertices.T.tolist())]
    normals = face_normals(problem.vertices, problem.faces)
    lines = [f"solid {name}"]
    for a, b, c, x, y, z in zip(*problem.faces.T.tolist(), *normals.T.tolist()):
        corners = f"{points[a]}\n{points[b]}\n{points[c]}"
        lines.append(f"facet normal {x!r} {y!r} {z!r}\nouter loop\n{corners}\nendloop\nendfacet")
    lines.append(f"endsolid {name}")
    return "\n".join(lines) + "\n"
