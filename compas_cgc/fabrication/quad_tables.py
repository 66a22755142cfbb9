"""Faces and beams of plane quads as tables in millimetres."""

from __future__ import annotations

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from .legend import outside_is_above
from .legend import outside_note
from .materials import metres_per_unit
from .quads import PlaneQuads
from .tables import csv_text

__all__ = ["beam_text", "face_text", "quad_notes"]


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
                f"{mm * quads.planarity[number]:.4f}",
            )
        )
    head = ("face", "region", "nodes", "sides in mm", "diagonals in mm", "area in m2", "planarity in mm")
    return csv_text(head, rows, quad_notes(quads))


def beam_text(quads: PlaneQuads) -> str:
    """Return a table (CSV) with one row per beam: its nodes and their places, length, depth, twist, and the angle between its faces."""
    mm = 1e3 * metres_per_unit(quads.problem.drawing.units)
    lengths = mm * np.linalg.norm(quads.vertices[quads.edges[:, 0]] - quads.vertices[quads.edges[:, 1]], axis=1)
    rows = []
    for number, ((a, b), length, twist, angle) in enumerate(zip(quads.edges.tolist(), lengths, quads.twist, _angles(quads))):
        far = quads.vertices[[a, b]] + quads.depth * quads.axes[[a, b]]
        ends = [f"{value:.1f}" for value in np.round(mm * np.vstack([quads.vertices[[a, b]], far]), 1).ravel() + 0.0]
        folded = "" if np.isnan(angle) else f"{np.degrees(angle):.2f}"
        rows.append((f"B{number}", a, b, f"{length:.1f}", f"{mm * quads.depth:.1f}", f"{mm * twist:.3f}", folded, *ends))
    places = tuple(f"{end} {axis} in mm" for end in ("from", "to", "far from", "far to") for axis in "xyz")
    head = ("beam", "from node", "to node", "length in mm", "depth in mm", "twist in mm", "angle between faces in degrees", *places)
    return csv_text(head, rows, quad_notes(quads))


def _angles(quads: PlaneQuads) -> FloatArray:
    """Return the angles between the normals of the faces along every beam, positive where convex, NaN at the rim (e,) [rad]."""
    owner, normals = {}, []
    for number, face in enumerate(quads.faces):
        points = quads.vertices[face] - quads.vertices[face].mean(axis=0)
        normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
        normals.append(normal / np.linalg.norm(normal))
        owner.update({side: number for side in zip(face, face[1:] + face[:1])})
    found = np.full(len(quads.edges), np.nan)
    for k, (a, b) in enumerate(quads.edges.tolist()):
        left, right = owner.get((a, b)), owner.get((b, a))
        if left is not None and right is not None:
            along = quads.vertices[b] - quads.vertices[a]
            sine = np.cross(normals[left], normals[right]) @ along / np.linalg.norm(along)
            found[k] = np.arctan2(sine, normals[left] @ normals[right])
    return found


def quad_notes(quads: PlaneQuads) -> list[str]:
    """Return the conventions of tables and drawings of plane quads."""
    outwards = float(np.median(np.einsum("ki,ki->k", quads.axes, _node_normals(quads)))) > 0.0
    outside = outside_note(outside_is_above(face_normals(quads.problem.vertices, quads.problem.faces)))
    return [
        "lengths in mm; x, y, z: nodes in the coordinates of the model, x and y in plan, z up, with its origin",
        f"{outside}; faces are seen from outside, their nodes are counterclockwise",
        "sides of a face: from each node to the next, in order; diagonals: from the first node to the third, from the second to the fourth",
        "planarity: largest distance between the diagonals of four consecutive corners",
        "faces end at the axes of the beams: no gap is left for joints, and no thickness of faces or beams is assumed; "
        "no holes or tolerances "
        "are included; material and thickness are the engineer's choice",
        f"beams are plates perpendicular to the faces, on their {'outside' if outwards else 'inside'}; depth: from the nodes; length: "
        "between the nodes; the engineer chooses their thickness",
        "twist: distance between the diagonals of a beam, 0 if it is plane; a twisted beam is drawn with its true sides, bent along the "
        "diagonal; angle between faces: between their normals, positive if convex, empty at the edge of a region; far from, far to: the "
        "other two corners of a beam, at its depth",
        *filter(None, [quads.short_beams()]),
    ]


def _node_normals(quads: PlaneQuads) -> FloatArray:
    """Return the sum of the normals of the faces around every node, by area (k, 3) [L^2]."""
    found = np.zeros_like(quads.vertices)
    for face in quads.faces:
        points = quads.vertices[face] - quads.vertices[face].mean(axis=0)
        found[face] += np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    return found
