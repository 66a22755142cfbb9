"""Wavefront .obj files: faces in groups by region, creases as lines, supports as points, in full precision."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import FileError
from ..model.problem import CGCProblem
from .cleanup import clean_problem
from .cursor import Cursor
from .reading import ReadProblem

__all__ = ["obj_text", "read_obj"]

_TARGET = re.compile(r"^K=(\S+)$")


def read_obj(path: Path) -> ReadProblem:
    """Read a .obj file.

    Faces can have any number of corners. ``l`` elements are creases, ``p`` elements are supports,
    and a group name such as ``K=0.03`` sets the target of its faces.
    """
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    lines: list[list[int]] = []
    points: list[int] = []
    targets: dict[int, float] = {}
    K = None
    for number, line in Cursor.of_file(path).lines():
        word, *rest = line.split()
        try:
            if word == "v":
                vertices.append([float(x) for x in rest[:3]])
                if len(rest) < 3:
                    raise ValueError("three coordinates are required")
            elif word in ("f", "l", "p"):
                # Indices count from 1, or backwards from the last vertex if negative; v/vt/vn also refers to textures and normals.
                index = [int(part.split("/")[0]) for part in rest]
                index = [i - 1 if i > 0 else len(vertices) + i for i in index]
                if any(not 0 <= i < len(vertices) for i in index):
                    raise ValueError("the vertex does not exist")
                if word == "f":
                    faces.append(index)
                    if K is not None:
                        targets.update((v, K) for v in index)
                elif word == "l":
                    lines.append(index)
                else:
                    points += index
            elif word == "g":
                found = [m.group(1) for m in map(_TARGET.match, rest) if m]
                K = float(found[0]) if found else None
        except ValueError as error:
            raise FileError(f"{path}, line {number}: {line.strip()[:60]!r} cannot be read ({error}); correct it or export again") from None
    places = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    values = np.array([targets.get(v, np.nan) for v in range(len(vertices))])
    return clean_problem(path, places, faces, supports=points, creases=lines, targets=values)


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
