"""Object file format .off: vertices and faces, every digit kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import FileError
from ._text import read_lines
from .asked import Asked
from .meshfile import MeshFile

__all__ = ["off_text", "read_off"]


def read_off(path: Path) -> MeshFile:
    """Read a .off file; colours and normals are passed over."""
    lines = [line for _, line in read_lines(path)]
    if not lines or not lines[0].split()[0].upper().endswith("OFF"):
        raise FileError(f"{path} does not begin with OFF; give an .off file")
    # The counts may follow the word on the same line.
    head = lines[0].split()[1:] or lines[1:2] and lines[1].split()
    body = lines[1:] if lines[0].split()[1:] else lines[2:]
    try:
        n, m = int(head[0]), int(head[1])
        if len(body) < n + m:
            raise ValueError(f"{n} vertices and {m} faces are announced, {len(body)} lines follow")
        vertices = [[float(x) for x in line.split()[:3]] for line in body[:n]]
        faces = []
        for line in body[n : n + m]:
            words = line.split()
            faces.append([int(i) for i in words[1 : int(words[0]) + 1]])
        return MeshFile(np.array(vertices, dtype=np.float64).reshape(n, 3), faces)
    except (IndexError, ValueError) as error:
        raise FileError(f"{path} cannot be read ({error}); export it again") from None


def off_text(mesh: Asked) -> str:
    """Return a mesh as the text of a .off file, which has no place for roles."""
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in zip(*mesh.vertices.T.tolist())]
    lines += [f"3 {a} {b} {c}" for a, b, c in zip(*mesh.faces.T.tolist())]
    return "\n".join(lines) + "\n"
