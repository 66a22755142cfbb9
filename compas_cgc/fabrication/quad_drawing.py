"""Plane faces and beams of quads as flat outlines at 1:1, in millimetres."""

from __future__ import annotations

import math

import numpy as np

from ..discrete.arrays import FloatArray
from .drawing import LETTER_WIDTH
from .drawing import Drawing
from .drawing import Line
from .drawing import Text
from .drawing import clearance
from .drawing import roomiest
from .legend import key_of_plan
from .legend import with_legend
from .materials import metres_per_unit
from .nesting import nest
from .picture_key import Key
from .picture_key import key_of
from .quad_tables import quad_notes
from .quads import PlaneQuads

__all__ = ["draw_quads", "face_label", "flat_beam", "flat_face", "labels_in_plan"]

ASPECT = 1.5  # of the drawing of all faces
GAP, TEXT, ARROW = 0.1, 0.05, 0.25  # distance of faces, height of texts and length of arrows, relative to the spacing
BEAM_TEXT = 0.15  # largest height of numbers of beams and nodes, relative to the length of the beam
BEAM_ROOM = 0.5  # part of the way from a side to the middle of a face at which the number of the beam is centred at most
MEANINGS = {
    "CUT": "outline of a face or beam between the axes of the nodes; no gap is left for joints",
    "MARK": "arrow in a face along its first side, from its first node to the second; beams: the side that lies along the faces",
    "LABEL": "number of the face or beam; turn the part until its number is upright",
    "SEAM": "beam along the side",
    "NODE": "node at the corner",
    "SHEET": "title",
}


def flat_face(quads: PlaneQuads, face: int) -> FloatArray:
    """Return the corners (k, 2) of a face in its plane, counterclockwise seen from outside, the first side along x [mm]."""
    return _flat(1e3 * metres_per_unit(quads.problem.drawing.units) * quads.vertices[quads.faces[face]])


def flat_beam(quads: PlaneQuads, beam: int) -> FloatArray:
    """Return the corners (4, 2) of a beam laid flat: the side along the faces along x, then the side at its depth [mm].

    A twisted beam is unfolded along its diagonal, so that all sides keep their lengths.
    """
    ends = quads.edges[beam]
    far = quads.vertices[ends] + quads.depth * quads.axes[ends]
    a, b, c, d = 1e3 * metres_per_unit(quads.problem.drawing.units) * np.vstack([quads.vertices[ends], far[::-1]])
    length, diagonal = float(np.linalg.norm(b - a)), float(np.linalg.norm(c - a))
    along = (c - a) @ (b - a) / length
    third = np.array([along, math.sqrt(max(diagonal**2 - along**2, 0.0))])
    towards = third / diagonal
    along = (d - a) @ (c - a) / diagonal
    fourth = along * towards + math.sqrt(max(float((d - a) @ (d - a)) - along**2, 0.0)) * np.array([-towards[1], towards[0]])
    flat = np.array([[0.0, 0.0], [length, 0.0], third, fourth])
    return flat - flat.min(axis=0)


def _flat(points: FloatArray) -> FloatArray:
    """Return points (k, 3) of a nearly plane polygon in its plane, counterclockwise, the first side along x, at positive coordinates."""
    up = np.cross(points - points.mean(axis=0), np.roll(points, -1, axis=0) - points.mean(axis=0)).sum(axis=0)
    up /= np.linalg.norm(up)
    along = points[1] - points[0]
    along = along - up * (along @ up)
    along /= np.linalg.norm(along)
    flat = (points - points[0]) @ np.column_stack([along, np.cross(up, along)])
    return flat - flat.min(axis=0)


def draw_quads(quads: PlaneQuads) -> Drawing:
    """Return the flat outlines of all faces and, above them, of all beams, with numbers, nodes, neighbours and orientation marks [mm].

    Parameters
    ----------
    quads
        Result of :func:`compas_cgc.fabrication.plane_quads`.
    """
    mm = 1e3 * metres_per_unit(quads.problem.drawing.units)
    gap, height = GAP * mm * quads.spacing, TEXT * mm * quads.spacing
    faces = [flat_face(quads, k) for k in range(len(quads.faces))]
    beams = [flat_beam(quads, k) for k in range(len(quads.edges))]
    beam_at = {frozenset(edge): k for k, edge in enumerate(quads.edges.tolist())}
    lines, texts, low, right = list[Line](), list[Text](), 0.0, 0.0
    width = math.sqrt(ASPECT * sum(float(np.prod(np.ptp(face, axis=0) + gap)) for face in faces))
    for kind, outlines in (("faces", faces), ("beams", beams)):
        sizes = [(float(x), float(y)) for x, y in (np.ptp(outline, axis=0) for outline in outlines)]
        width = max(width, *(x for x, _ in sizes))
        places = nest(sizes, (width, math.inf), gap, turn=False)
        top = max(place.y + size[1] for place, size in zip(places, sizes))
        for number, (outline, place) in enumerate(zip(outlines, places)):
            points = outline + [place.x, low + place.y]
            right = max(right, float(points[:, 0].max()))
            lines.append(Line("CUT", points, True))
            middle = points.mean(axis=0)
            if kind == "faces":
                nodes = quads.faces[number]
                beside = [f"B{beam_at[frozenset(ends)]}" for ends in zip(nodes, nodes[1:] + nodes[:1])]
                lines.append(_arrow(points, middle))
                texts += _along(points, middle, beside, nodes, height)
                texts.append(face_label(f"F{number}", points, 2.0 * height))
            else:
                nodes = quads.edges[number].tolist()
                lines.append(Line("MARK", points[:2] + 0.1 * (points[[3, 2]] - points[:2])))
                room = float(np.ptp(points[:, 1]))
                size = min(height, 0.4 * room)
                ends = zip(nodes, (points[0] + points[3], points[1] + points[2]))
                texts += [Text("NODE", str(node), 0.425 * both + 0.15 * middle, 0.5 * size) for node, both in ends]
                length = float(np.linalg.norm(points[1] - points[0]))
                name = f"B{number}"
                texts.append(Text("LABEL", name, middle, min(size, length / (2.0 * LETTER_WIDTH * len(name)))))
        low += top + 10.0 * height
    title = f"{len(faces)} faces and above them {len(beams)} beams of a depth of {mm * quads.depth:.1f} mm, flat at 1:1, in mm"
    texts.append(Text("SHEET", title, np.array([0.5 * right, low - 6.0 * height]), 2.0 * height))
    # Parts lie turned, so that there is no north.
    key = key_of_plan(Key("", None, key_of(quads.problem).words), np.array([0.0, low]), right, 1.5 * height, "Millimeters")
    drawing = Drawing([*lines, *key[0]], [*texts, *key[1]], (right, low), "Millimeters")
    return with_legend(drawing, MEANINGS, quad_notes(quads), 1.5 * height)


def face_label(name: str, points: FloatArray, height: float) -> Text:
    """Return the name of a face with corners (k, 2) at the place with most room, at most of a height."""
    share = np.array([[i, j, k] for i in range(1, 8) for j in range(1, 8) for k in range(1, 8) if i + j + k == 9]) / 9.0
    fan = np.array([points[[0, k, k + 1]] for k in range(1, len(points) - 1)])
    place, room = roomiest(np.einsum("sc,fcj->fsj", share, fan).reshape(-1, 2), [points], name)
    return Text("LABEL", name, place, min(height, 0.6 * room))


def labels_in_plan(quads: PlaneQuads, places: FloatArray, height: float) -> tuple[list[Text], list[Text]]:
    """Return the names of all beams, each beside its middle inside a face, and of all nodes, each in its widest corner of a face.

    So beams and nodes of two regions that meet at a crease have their names on their own sides of it.

    Parameters
    ----------
    quads
        The faces and beams.
    places
        (k, 2) nodes in plan [L].
    height
        Largest height of a text [L].
    """
    beams, nodes, widest = dict[frozenset[int], Text](), dict[int, Text](), dict[int, float]()
    number = {frozenset(edge): k for k, edge in enumerate(quads.edges.tolist())}
    for face in quads.faces:
        outline, middle = places[face], places[face].mean(axis=0)
        along = np.roll(outline, -1, axis=0) - outline
        lengths = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
        along = along / lengths[:, None]
        turned = np.sum(outline[:, 0] * np.roll(outline[:, 1], -1) - outline[:, 1] * np.roll(outline[:, 0], -1)) < 0.0
        inward = along @ np.array([[0.0, 1.0], [-1.0, 0.0]]) * (-1.0 if turned else 1.0)
        for k, (a, b) in enumerate(zip(face, face[1:] + face[:1])):
            side = frozenset((a, b))
            name, room = f"B{number[side]}", float((middle - places[a]) @ inward[k])
            size = min(height, BEAM_TEXT * float(lengths[k]), BEAM_ROOM * room / clearance(name, 1.0, inward[k]))
            if side not in beams or size > beams[side].height:
                beams[side] = Text("LABEL", name, 0.5 * (places[a] + places[b]) + clearance(name, size, inward[k]) * inward[k], size)
            between = inward[k] + inward[k - 1]
            # The sine of half of the angle at the corner, 1 where the outline is straight.
            half = 0.5 * float(np.linalg.norm(between))
            if half > widest.get(a, 0.0):
                size = min(0.8 * height, BEAM_TEXT * float(min(lengths[k], lengths[k - 1])))
                widest[a] = half
                nodes[a] = Text("NODE", str(a), places[a] + size * (LETTER_WIDTH * len(str(a)) + 1.0) / (4.0 * half**2) * between, size)
    return [beams[frozenset(edge)] for edge in quads.edges.tolist()], [nodes[k] for k in range(len(places))]


def _arrow(points: FloatArray, middle: FloatArray) -> Line:
    """Return an arrow inside a face along its first side."""
    a, b = points[:2] + 0.15 * (middle - points[:2])
    start, end = a + (0.5 - ARROW) * (b - a), a + (0.5 + ARROW) * (b - a)
    back, aside = 0.15 * (start - end), 0.15 * (end - start) @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    return Line("MARK", np.array([start, end, end + back + 0.5 * aside, end + back - 0.5 * aside, end]))


def _along(points: FloatArray, middle: FloatArray, beside: list[str], nodes: list[int], height: float) -> list[Text]:
    """Return the beams along the sides of a face, and the nodes at its corners, inside the outline."""
    texts = []
    ahead = np.roll(points, -1, axis=0)
    for k, (a, b) in enumerate(zip(points, ahead)):
        length = float(np.linalg.norm(b - a))
        along = (b - a) / max(length, np.finfo(float).tiny)
        inward = np.array([-along[1], along[0]])
        size = min(height, 0.2 * length)
        # Beyond the arrow along the first side.
        extra = 0.15 * abs(float((middle - a) @ inward)) if k == 0 else 0.0
        place = 0.5 * (a + b) + (clearance(beside[k], 0.7 * size, inward) + extra) * inward
        texts.append(Text("SEAM", beside[k], place, 0.7 * size))
        texts.append(Text("NODE", str(nodes[k]), a + 0.12 * (middle - a), 0.5 * size))
    return texts
