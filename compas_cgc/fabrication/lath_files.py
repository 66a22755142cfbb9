"""Laths as a table of stations and as a drawing of straight strips, in millimetres."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray
from .drawing import Drawing
from .drawing import Line
from .drawing import Text
from .laths import Lath
from .laths import LathSchedule
from .tables import csv_text

__all__ = ["draw_laths", "schedule_text"]

ROW = 2.0  # distance of strips in the drawing, relative to their width

_HEAD = (
    "lath",
    "family",
    "region",
    "length in mm",
    "twist in degrees per m",
    "stress in MPa",
    "shear in MPa",
    "splices in mm",
    "node",
    "station in mm",
    "crosses lath",
    "angle in degrees",
    "slot width in mm",
    "slot from",
    "bending radius in mm",
)


def schedule_text(schedule: LathSchedule) -> str:
    """Return the schedule as CSV: one row per node of every lath.

    The angle is the one from the lath of family 0 to that of family 1, counterclockwise seen from outside. Twist is positive for a
    right-handed screw. The bending radius is positive if the lath bends to the left seen from outside, and empty where it is straight.
    """
    return csv_text(_HEAD, (row for lath in schedule.laths for row in _rows(lath, schedule)))


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
        " ".join(f"{mm * at:.1f}" for at in lath.splices),
    )
    rows = []
    places = zip(lath.nodes.tolist(), lath.stations.tolist(), lath.across.tolist(), np.degrees(lath.angles).tolist())
    for (node, station, across, degrees), slot, bend in zip(places, _slots(lath.angles, schedule).tolist(), lath.bending.tolist()):
        radius = "" if abs(bend) < 1e-6 / schedule.unit else f"{mm / bend:.0f}"
        rows.append((*about, node, f"{mm * station:.1f}", across, f"{degrees:.2f}", f"{slot:.1f}", _side(lath), radius))
    return rows


def _slots(angles: FloatArray, schedule: LathSchedule) -> FloatArray:
    """Return the widths (k,) of slots, cut square to the lath, for laths that cross at angles (k,) [rad] [mm]."""
    return schedule.thickness * (1.0 + np.abs(np.cos(angles))) / np.abs(np.sin(angles))


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
        texts.append(Text("LABEL", f"L{lath.number}", np.array([-width, low + 0.5 * width]), 0.4 * width))
    title = (
        f"{len(schedule.laths)} laths of {width:g} x {schedule.thickness:g} mm, {schedule.material.name}; all lengths in mm; the lower "
        "edge lies inside; slots are half the width deep and cut square; at every slot: node / crossing lath; MARK: splice"
    )
    texts.append(Text("SHEET", title, np.array([0.5 * right, 2.0 * width]), 0.25 * width))
    bottom = -ROW * width * (len(schedule.laths) - 1)
    lines = [line._replace(points=line.points - [0.0, bottom]) for line in lines]
    texts = [text._replace(place=text.place - [0.0, bottom]) for text in texts]
    return Drawing(lines, texts, (right, 2.5 * width - bottom), "Millimeters")
