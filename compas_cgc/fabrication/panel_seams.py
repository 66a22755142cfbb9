"""Seams between panels: which panels meet, and along what length."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices
from ..model.problem import CGCProblem

if TYPE_CHECKING:
    from .panelling import Panel

__all__ = ["PanelSeam", "panel_seams", "seam_lengths"]


class PanelSeam(NamedTuple):
    """Line along which two panels meet."""

    panels: tuple[str, str]  # their names
    length: float  # [L]


def panel_seams(problem: CGCProblem, panels: Sequence[Panel]) -> list[PanelSeam]:
    """Return the seams between panels of one division; panels that only touch at a point have none."""
    cut = panels[0].cut
    vertices, faces = (problem.vertices, problem.faces) if cut is None else (cut.vertices, cut.faces)
    piece = np.full(len(faces), -1)
    for number, panel in enumerate(panels):
        if (panel.cut is None) == (cut is None):
            piece[panel.faces] = number
    pairs, lengths = seam_lengths(vertices, faces, piece)
    names = [panel.name for panel in panels]
    return [PanelSeam((names[a], names[b]), length) for (a, b), length in zip(pairs.tolist(), lengths.tolist()) if a >= 0]


def seam_lengths(vertices: Vertices, faces: Faces, piece: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the pairs of pieces that share edges (s, 2), and the length that they share (s,) [L]."""
    edges = edge_faces(faces)
    edges = edges[edges[:, 3] >= 0]
    pairs = np.sort(piece[edges[:, 2:]], axis=1)
    apart = pairs[:, 0] != pairs[:, 1]
    lengths = np.linalg.norm(vertices[edges[apart, 0]] - vertices[edges[apart, 1]], axis=1)
    found, which = np.unique(pairs[apart], axis=0, return_inverse=True)
    return found.astype(np.int64), np.bincount(which.ravel(), lengths, len(found)).astype(np.float64)
