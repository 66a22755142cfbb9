"""Object file format .off: vertices and faces in full precision."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import FileError
from ..model.problem import CGCProblem
from .cleanup import clean_problem
from .cursor import Cursor
from .reading import ReadProblem

__all__ = ["off_text", "read_off"]


def read_off(path: Path) -> ReadProblem:
    """Read a .off file; colours and normals are ignored."""
    cursor = Cursor.of_file(path)
    lines = [line for _, line in cursor.lines()]
    if not lines or not lines[0].split()[0].upper().endswith("OFF"):
        raise FileError(f"{path} does not begin with OFF; give an .off file")
    # The counts may follow the keyword OFF on the same line.
    head = lines[0].split()[1:] or lines[1:2] and lines[1].split()
    body = lines[1:] if lines[0].split()[1:] else lines[2:]
    try:
        n, m = cursor.count(int(head[0]), 1, "vertices"), cursor.count(int(head[1]), 1, "faces")
        if len(body) < n + m:
            raise ValueError(f"it declares {n} vertices and {m} faces, but only {len(body)} lines follow")
        vertices = [[float(x) for x in line.split()[:3]] for line in body[:n]]
        faces = []
        for line in body[n : n + m]:
            size, *words = line.split()
            faces.append([int(i) for i in words[: cursor.count(int(size), 1, "corners")]])
        places = np.array(vertices, dtype=np.float64).reshape(n, 3)
    except (IndexError, ValueError) as error:
        raise FileError(f"{path} cannot be read ({error}); export it again") from None
    return clean_problem(path, places, faces)


def off_text(problem: CGCProblem) -> str:
    """Return a mesh as the text of a .off file, which does not hold roles."""
    lines = ["OFF", f"{len(problem.vertices)} {len(problem.faces)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in zip(*problem.vertices.T.tolist())]
    lines += [f"3 {a} {b} {c}" for a, b, c in zip(*problem.faces.T.tolist())]
    return "\n".join(lines) + "\n"
