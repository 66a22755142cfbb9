"""Laths as a table of stations and as a drawing of straight strips, in millimetres."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..model.counts import counted
from .drawing import LETTER_WIDTH
from .drawing import Drawing
from .drawing import Line
from .drawing import Text
from .drawing import clearance
from .drawing import text_box
from .front_view import is_plan
from .front_view import seen_from
from .front_view import view_name
from .laths import Lath
from .laths import LathSchedule
from .legend import curvature_notes
from .legend import key_of_plan
from .legend import outside_note
from .legend import with_legend
from .start_labels import names_at_starts
from .tables import csv_text

__all__ = ["draw_laths", "schedule_text"]

ROW = 2.0  # distance of strips in the drawing, relative to their width
PLAN_GAP = 10.0  # distance of the plan from the strips, relative to their width
NAME_HEIGHT = 0.3  # of the number of a lath on its strip, relative to its width
TITLE_HEIGHT = 0.6  # of the title above the strips, relative to their width
NODE_ROOM = 0.8  # length of the text of a node on a strip, relative to its width
STRAIGHTEDGE = 2.0  # length over which the bow of laths is measured [m]
MIN_BOW = 5e-4  # bow over this length, or over a shorter lath, below which a lath counts as straight: the width of a pencil line [m]
PLAN_TEXT = 0.012  # height of the numbers of laths in the plan, relative to its size
MEANINGS = {
    "CUT": "contour of the strips with their slots, to cut",
    "MARK": "splice",
    "LABEL": "number of the lath; on strips, to engrave: station 0 is left of the upright text; in the plan, a line joins it to station 0",
    "FAMILY_0": "axes of the laths of family 0, in plan",
    "FAMILY_1": "axes of the laths of family 1, in plan",
    "OUTLINE": "edge of the surface, in plan",
    "NODE": "on strips: node / crossing lath, to engrave; in the plan: node",
    "SHEET": "title; not cut",
}

_HEAD = (
    "lath",
    "family",
    "region",
    "length in mm",
    "twist in degrees per m",
    "stress in MPa",
    "shear in MPa",
    "screw",
    "splices in mm",
    "node",
    "station in mm",
    "crosses lath",
    "angle in degrees",
    "slot width in mm",
    "slot from",
    "bending radius in mm",
    "bends to",
    "x in mm",
    "y in mm",
    "z in mm",
)


def schedule_text(schedule: LathSchedule) -> str:
    """Return the schedule as CSV: one row per node and per end of every lath, then the conventions as notes."""
    return csv_text(_HEAD, (row for lath in schedule.laths for row in _rows(lath, schedule)), _notes(schedule))


def _rows(lath: Lath, schedule: LathSchedule) -> list[tuple]:
    mm = 1e3 * schedule.unit
    about = (
        lath.number,
        lath.family,
        lath.region,
        f"{mm * lath.length:.1f}",
        f"{np.degrees(lath.twist) / schedule.unit:.4f}",
        f"{1e-6 * lath.stress:.2f}",
        f"{1e-6 * lath.shear:.2f}",
        "right-handed" if lath.twist > 0.0 else "left-handed",
        " ".join(f"{mm * at:.1f}" for at in lath.splices),
    )
    first, last = (
        (*about, "", f"{mm * station:.1f}", *[""] * 6, *(f"{mm * value:.1f}" for value in end))
        for station, end in ((0.0, lath.path[0]), (lath.length, lath.path[-1]))
    )
    rows = [first]
    reach = min(lath.length * schedule.unit, STRAIGHTEDGE)
    places = zip(lath.nodes.tolist(), lath.stations.tolist(), lath.across.tolist(), np.degrees(lath.angles).tolist())
    bends = zip(lath.bending.tolist(), (mm * lath.points).tolist())
    for (node, station, across, degrees), slot, (bend, point) in zip(places, _slots(lath.angles, schedule).tolist(), bends):
        straight = reach**2 / 8.0 * abs(bend) / schedule.unit < MIN_BOW
        bent = ("", "") if straight else (f"{mm / bend:.0f}", "left" if bend > 0.0 else "right")
        own = (node, f"{mm * station:.1f}", across, f"{degrees:.2f}", f"{slot:.1f}", _side(lath), *bent)
        rows.append((*about, *own, *(f"{value:.1f}" for value in point)))
    return [*rows, last]


def _slots(angles: FloatArray, schedule: LathSchedule) -> FloatArray:
    """Return the widths (k,) of slots, cut square to the lath, for laths that cross at angles (k,) [rad] [mm]."""
    return schedule.thickness * (1.0 + np.abs(np.cos(angles))) / np.abs(np.sin(angles))


def _notes(schedule: LathSchedule) -> list[str]:
    """Return the conventions of the schedule and the drawing."""
    near = [f"L{lath.number} at node {node}" for lath in schedule.laths for node in _near_ends(lath, schedule)]
    ends = (
        [f"nodes closer to an end than the width of the lath, where the piece beyond the slot may break off: {', '.join(near)}"]
        if near
        else []
    )
    alone = [f"L{lath.number} ({1e3 * schedule.unit * lath.length:.0f} mm)" for lath in schedule.laths if not len(lath.nodes)]
    single = [f"laths that cross no other lath, with rows for their ends only: {', '.join(alone)}"] if alone else []
    first, second = (_numbers([lath.number for lath in schedule.laths if lath.family == family]) for family in (0, 1))
    mm, lengths = 1e3 * schedule.unit, [lath.length for lath in schedule.laths]
    splices = (
        f"splices: stations at which stock lengths of at most {mm * schedule.stock:.1f} mm meet end to end, empty where the lath is in one "
        "piece; no overlap or plate is included"
        if schedule.stock
        else f"splices: no stock length was given; all laths are in one piece, the longest of {mm * max(lengths):.1f} mm"
    )
    return [
        "lengths in mm, angles in degrees; x, y, z: points on the axis of the lath, at half its width, in the coordinates of the model, x "
        "and y in plan, z up, with its origin; rows without a node: the two ends of the lath",
        "stations and lengths: along the axis of the lath, at half its width; ends are cut square, at the edge of the surface; edge beams "
        "are not included",
        f"{outside_note(schedule.above)}; the width of the laths lies along the normals",
        "station 0 is the start of a lath, in the drawing its left end and in the plan the end beside its number; left and right: for an "
        "observer outside who looks from station 0 along the lath",
        f"strips: the lower edge is the inner one, the face towards the viewer the right one; {schedule.unit * sum(lengths):.1f} m in all",
        "twist: rotation about the axis per metre, positive for a right-handed screw: the far end is turned clockwise, seen from station 0",
        "bending radius: about the weak axis, positive if the lath bends to the left, negative if to the right, empty where it is "
        f"straight: where the bow is below {1e3 * MIN_BOW:g} mm over {STRAIGHTEDGE:g} m, or over the length of a shorter lath",
        "angle: counterclockwise seen from outside, from the direction of the lath of family 0 to that of family 1, both from station 0 on",
        "slots: half the width deep, cut square, width along the lath, without clearance; family 0 is slotted from the inside, family 1 "
        "from the outside: lay family 1 first, then set family 0 on it; no holes or bolts are included",
        f"family 0: {first}; family 1: {second}",
        *ends,
        *single,
        "stress: bending and stretch of the outer fibres by twisting; shear: by twisting; without loads and safety factors; "
        f"characteristic bending strength of {schedule.material.name}: {1e-6 * schedule.material.strength:g} MPa",
        splices,
    ]


def _near_ends(lath: Lath, schedule: LathSchedule) -> list[int]:
    """Return the nodes of a lath that are closer than its width to one of its ends."""
    away = 1e3 * schedule.unit * np.minimum(lath.stations, lath.length - lath.stations)
    return lath.nodes[away < schedule.width].tolist()


def _numbers(numbers: list[int]) -> str:
    """Return the numbers of laths as text, such as ``L1 to L4, L7``."""
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) != 1) + 1)
    return ", ".join(f"L{run[0]}" if len(run) == 1 else f"L{run[0]} to L{run[-1]}" for run in runs if len(run)) or "none"


def _side(lath: Lath) -> str:
    """Return the side from which a lath is slotted to half its width."""
    return "inside" if lath.family == 0 else "outside"


def _strip(lath: Lath, schedule: LathSchedule) -> FloatArray:
    """Return the outline of a strip with its slots, counterclockwise (k, 2) [mm]."""
    length, width = 1e3 * schedule.unit * lath.length, schedule.width
    at, half = 1e3 * schedule.unit * lath.stations, 0.5 * _slots(lath.angles, schedule)
    x = np.column_stack([at - half, at - half, at + half, at + half]).ravel()
    y = np.tile([0.0, 0.5 * width, 0.5 * width, 0.0], len(at))
    edge = np.column_stack([x, y])
    # A slot at an end is open to it.
    edge[:, 0] = np.clip(edge[:, 0], 0.0, length)
    if _side(lath) == "inside":
        return np.vstack([[0.0, 0.0], edge, [length, 0.0], [length, width], [0.0, width]])
    return np.vstack([[0.0, 0.0], [length, 0.0], [length, width], ([0.0, width] + edge * [1.0, -1.0])[::-1], [0.0, width]])


def draw_laths(schedule: LathSchedule) -> Drawing:
    """Return the straight strips with slots at half their width, numbers of nodes and of crossing laths, and splices [mm]."""
    mm, width = 1e3 * schedule.unit, schedule.width
    lines, texts, right = [], [], 0.0
    for row, lath in enumerate(schedule.laths):
        low = -ROW * width * row
        length = mm * lath.length
        right = max(right, length)
        lines.append(Line("CUT", _strip(lath, schedule) + [0.0, low], True))
        free = low + (0.75 if _side(lath) == "inside" else 0.25) * width
        for node, station, across in zip(lath.nodes.tolist(), lath.stations.tolist(), lath.across.tolist()):
            texts.append(Text("NODE", f"{node} / L{across}", np.array([mm * station, free]), 0.12 * width))
        for splice in lath.splices:
            lines.append(Line("MARK", np.array([[mm * splice, low], [mm * splice, low + width]])))
        texts.append(_name(f"L{lath.number}", mm * np.r_[0.0, lath.stations, length / mm], free, width))
    title = f"{counted(len(schedule.laths), 'lath')} of {width:g} x {schedule.thickness:g} mm, {schedule.material.name}, drawn 1:1"
    texts.append(Text("SHEET", title, np.array([0.5 * right, 2.0 * width]), TITLE_HEIGHT * width))
    low = mm * np.min([(edge @ schedule.view[:2].T).min(axis=0) for edge in schedule.edges], axis=0)
    plan = _plan(schedule, low)
    # The upper ends of strips and plan are level, below the legend, and the lower one of these ends at 0.
    below, across = ROW * width * (len(schedule.laths) - 1), max(right, 40.0 * width)
    top = max(below + 2.5 * width, plan.size[1])
    strips = Drawing(lines, texts, (right, top), "Millimeters").moved([0.0, top - 2.5 * width])
    plan = plan.moved([across + PLAN_GAP * width, top - plan.size[1]])
    corner = f"; its lower left corner lies at x = {low[0]:.1f}, y = {low[1]:.1f} of the model" if is_plan(schedule.view) else ""
    view = view_name(schedule.view, schedule.key.north or (0.0, 1.0))
    notes = [*_notes(schedule), f"the {view} at the right is {seen_from(schedule.view)}{corner}", *curvature_notes(schedule.key)]
    both = strips._replace(lines=[*strips.lines, *plan.lines], texts=[*strips.texts, *plan.texts])
    drawing = with_legend(both, MEANINGS, notes, 0.3 * width, across)
    return drawing._replace(size=(across + PLAN_GAP * width + plan.size[0], drawing.size[1]))


def _name(text: str, stations: FloatArray, y: float, width: float) -> Text:
    """Return the number of a lath on its strip, in the first space between texts of nodes at stations (k,) that has room for it [mm]."""
    room = np.diff(stations) - NODE_ROOM * width
    at = int(np.argmax(room > NAME_HEIGHT * width * LETTER_WIDTH * (len(text) + 1)))
    if room[at] <= NAME_HEIGHT * width * LETTER_WIDTH * (len(text) + 1):
        at = int(np.argmax(room))
    height = min(NAME_HEIGHT * width, max(float(room[at]), 0.1 * width) / (LETTER_WIDTH * (len(text) + 1)))
    return Text("LABEL", text, np.array([0.5 * (stations[at] + stations[at + 1]), y]), height)


def _plan(schedule: LathSchedule, corner: FloatArray) -> Drawing:
    """Return the laths in plan, with their numbers at station 0 and those of nodes; the lower left corner of the edges comes to 0 [mm]."""
    mm = 1e3 * schedule.unit
    height = PLAN_TEXT * mm * float(np.ptp(np.concatenate(schedule.edges), axis=0).max())
    across = schedule.view[:2].T
    paths = [mm * lath.path @ across - corner for lath in schedule.laths]
    names = [f"L{lath.number}" for lath in schedule.laths]
    numbers = _node_numbers(schedule, corner, 0.5 * height)
    boxes = [text_box(own.text, own.place, own.height) for own in numbers]
    layers = [f"FAMILY_{lath.family}" for lath in schedule.laths]
    places = names_at_starts(names, paths, height, boxes, height)
    leaders = [_leader(name, path[0], place, height) for name, path, place in zip(names, paths, places)]
    texts = [Text("LABEL", name, place, height, layer) for name, place, layer in zip(names, places, layers)]
    texts += numbers
    edges = [mm * edge @ across - corner for edge in schedule.edges]
    lines = [*(Line("OUTLINE", edge, True) for edge in edges), *(Line(layer, path) for layer, path in zip(layers, paths)), *leaders]
    right, top = np.max(np.concatenate(edges), axis=0).tolist()
    key = key_of_plan(schedule.key, np.array([0.0, top + 4.0 * height]), right, height, "Millimeters", schedule.view)
    return Drawing([*lines, *key[0]], [*texts, *key[1]], (right, top + 8.0 * height), "Millimeters")


def _leader(name: str, start: FloatArray, place: FloatArray, height: float) -> Line:
    """Return the leader from the start of a lath in plan to its number, which shows to which of several nearby starts it belongs [mm]."""
    length = max(float(np.linalg.norm(place - start)), np.finfo(float).tiny)
    direction = (place - start) / length
    return Line("LABEL", np.array([start, start + max(0.0, length - clearance(name, height, direction)) * direction]))


def _node_numbers(schedule: LathSchedule, origin: FloatArray, height: float) -> list[Text]:
    """Return the numbers of nodes in plan, each between its laths where their angle is widest, clear of both, moved by -origin [mm]."""
    mm = 1e3 * schedule.unit
    places: dict[int, FloatArray] = {}
    normals: dict[int, list[FloatArray]] = {}
    for lath in schedule.laths:
        path, points = lath.path @ schedule.view[:2].T, lath.points @ schedule.view[:2].T
        tangents = np.gradient(path, axis=0)[cKDTree(path).query(points)[1]]
        for node, place, (x, y) in zip(lath.nodes.tolist(), mm * points - origin, tangents.tolist()):
            places[node] = place
            own = normals.setdefault(node, [])
            # A lath along the line of sight is a point.
            if x or y:
                own.append(np.array([-y, x]) / np.hypot(x, y))
    texts = []
    for node, place in places.items():
        own = normals[node] or [np.array([0.0, 1.0])]
        first, second = own[0], own[-1]
        # The widest angle of two lines lies about the sum of their normals if these point to the same side, to the right or upwards.
        direction = first + second if first @ second > 0.0 else first - second
        direction = direction / np.linalg.norm(direction) * (1.0 if tuple(direction) > (0.0, 0.0) else -1.0)
        away = max(clearance(str(node), height, normal) / abs(float(normal @ direction)) for normal in own)
        texts.append(Text("NODE", str(node), place + away * direction, height))
    return texts
