"""Faces and beams of plane quads as tables in millimetres."""

from __future__ import annotations

import numpy as np

from .materials import metres_per_unit
from .quads import PlaneQuads
from .tables import csv_text

__all__ = ["beam_text", "face_text"]


def face_text(quads: PlaneQuads) -> str:
    """Return a table (CSV) with one row per face: nodes and lengths of its sides in order, diagonals of quads, area and planarity."""
    mm = 1e3 * metres_per_unit(quads.problem.drawing.units)
    rows = []
    for number, face in enumerate(quads.faces):
        points = mm * quads.vertices[face]
        sides = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
        diagonals = np.linalg.norm(points[2:] - points[:2], axis=1) if len(face) == 4 else []
        area = 0.5 * np.linalg.norm(np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0))
        rows.append(
            (
                f"F{number}",
                int(quads.region[number]),
                " ".join(map(str, face)),
                " ".join(f"{own:.1f}" for own in sides),
                " ".join(f"{own:.1f}" for own in diagonals),
                f"{1e-6 * area:.4f}",
                f"{mm * quads.planarity[number]:.3g}",
            )
        )
    head = ("face", "region", "nodes", "sides in mm", "diagonals in mm", "area in m2", "planarity in mm")
    return csv_text(head, rows)


def beam_text(quads: PlaneQuads) -> str:
    """Return a table (CSV) with one row per beam: its nodes, length between them, and twist over its depth."""
    mm = 1e3 * metres_per_unit(quads.problem.drawing.units)
    lengths = mm * np.linalg.norm(quads.vertices[quads.edges[:, 0]] - quads.vertices[quads.edges[:, 1]], axis=1)
    rows = [
        (f"B{number}", a, b, f"{length:.1f}", f"{mm * quads.depth:.1f}", f"{mm * twist:.3g}")
        for number, ((a, b), length, twist) in enumerate(zip(quads.edges.tolist(), lengths, quads.twist))
    ]
    return csv_text(("beam", "from node", "to node", "length in mm", "depth in mm", "twist in mm"), rows)
