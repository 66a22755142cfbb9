"""Wavefront .obj files: faces in groups by region, creases as lines, supports as points, in full precision."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Optional

import numpy as np

from ..errors import FileError
from ..meshing.cleanup import Omission
from ..model.problem import CGCProblem
from .cleanup import clean_problem
from .cursor import Cursor
from .reading import ReadProblem
from .rows import check_corners
from .rows import integer_of
from .rows import number_of

__all__ = ["obj_text", "read_obj"]

_TARGET = re.compile(r"\bK\s*=\s*(\S+)")
# Free-form geometry, which needs the surface and not its control points.
_FREE_FORM = ("curv", "curv2", "surf")


def read_obj(path: Path, tolerance: float = 0.0) -> ReadProblem:
    """Read a .obj file, its statements in any order.

    Faces can have any number of corners. ``l`` elements are creases, ``p`` elements are supports,
    and a group named ``K=0.03`` sets the target of its faces.

    Parameters
    ----------
    path
        The file.
    tolerance
        Distance within which vertices are welded [L].
    """
    vertices: list[list[float]] = []
    elements: list[tuple[int, str, str, list[int], Optional[float]]] = []
    notes: list[str] = []
    K = None
    for number, line in Cursor.of_file(path).lines():
        word, *rest = line.split()
        try:
            if word == "v":
                if len(rest) < 3:
                    raise ValueError("three coordinates are required")
                # A weight or a colour can follow the coordinates.
                vertices.append([number_of(x) for x in rest][:3])
            elif word in ("f", "l", "p"):
                if word == "f":
                    check_corners(len(rest))
                # Indices count from 1, or back from the last vertex before; v/vt/vn names textures and normals too.
                index = [integer_of(part.split("/")[0]) for part in rest]
                if 0 in index:
                    raise ValueError("vertices count from 1")
                elements.append((number, line, word, [i - 1 if i > 0 else len(vertices) + i for i in index], K))
            elif word == "g":
                found = _TARGET.search(line)
                K = number_of(found[1]) if found else None
            elif word in _FREE_FORM and not notes:
                notes.append(Omission(f"free-form geometry ({word}) was left out; mesh it before the export"))
            elif word[0] in "+-.0123456789":
                raise ValueError("a statement begins with a word such as v or f")
        except ValueError as error:
            raise _unreadable(path, number, line, str(error)) from None
    wrong = next((own for own in elements if any(not 0 <= v < len(vertices) for v in own[3])), None)
    if wrong is not None:
        raise _unreadable(path, wrong[0], wrong[1], f"the vertex does not exist; there are {len(vertices)}")
    values = np.full(len(vertices), np.nan)
    for _, _, word, index, target in elements:
        if word == "f" and target is not None:
            values[index] = target
    faces, lines, points = ([index for _, _, word, index, _ in elements if word == kind] for kind in "flp")
    places = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    supports = [v for index in points for v in index]
    return clean_problem(path, places, faces, supports=supports, creases=lines, targets=values, notes=notes, tolerance=tolerance)


def _unreadable(path: Path, number: int, line: str, reason: str) -> FileError:
    return FileError(f"{path}, line {number}: {line.strip()[:60]!r} cannot be read ({reason}); correct it or export again")


def obj_text(problem: CGCProblem) -> str:
    """Return a mesh as the text of a .obj file."""
    targets = problem.region_targets()
    lines = ["# compas_cgc: l = creases, p = supports, K = target Gaussian curvature", f"o {' '.join(problem.drawing.name.split())}"]
    lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in zip(*problem.vertices.T.tolist())]
    last = None
    for a, b, c, region in zip(*(problem.faces.T + 1).tolist(), problem.regions().tolist()):
        if region != last:
            lines.append(f"g region_{region}" + ("" if targets[region] is None else f" K={targets[region]!r}"))
            last = region
        lines.append(f"f {a} {b} {c}")
    lines += ["l " + " ".join(str(v + 1) for v in path) for path in problem.crease_paths()]
    supports = [str(v + 1) for v in problem.supports.tolist()]
    lines += ["p " + " ".join(supports[i : i + 20]) for i in range(0, len(supports), 20)]
    return "\n".join(lines) + "\n"
