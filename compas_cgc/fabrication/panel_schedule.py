"""Panel schedule: sides with their lengths and neighbours, diagonals, rise, mould and K of every panel."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing import boundary_loops
from ..model.counts import counted
from ..model.counts import listed
from ..model.problem import CGCProblem
from .figures import SHORT
from .figures import unit_symbol
from .front_view import all_views
from .front_view import views_of
from .mould_layout import shapes_note
from .mould_layout import side_note
from .mould_report import MouldReport
from .mould_report import PanelFit
from .picture_key import K_MEANING
from .pieces import best_box
from .tables import csv_text

__all__ = ["FLAT_TRIANGLES", "MEAN_PLANE", "PanelSheet", "PanelSide", "model_notes", "panel_sheets", "panel_totals", "schedule_text"]

CORNER = np.radians(30.0)  # least turn of the outline at a corner
EDGE = "edge"  # instead of a neighbour at the edge of the surface

_HEAD = (
    "panel",
    "region",
    "mould",
    "K in 1/m2",
    "mould radius in mm",
    "length in mm",
    "width in mm",
    "rise over mean plane in mm",
    "edges of triangles from smooth surface in mm",
    "area in m2",
    "sides in mm",
    "neighbours",
    "diagonals between corners in mm",
    "bending stress in MPa",
    "stress on 95 % in MPa",
    "part of strength in %",
    "corners in mm",
    "remarks",
)
MEAN_PLANE = "mean plane: through the mean of the mesh vertices of the panel, oriented so that the projected outline has the largest area"
FLAT_TRIANGLES = "lengths, sizes and areas are those of the flat triangles of the model, not of the smooth surface"
NOTES = (
    "lengths in mm, in position, seen from outside, the side to which the normals point; sides are counterclockwise from corner 1",
    K_MEANING,
    "length and width: smallest rectangle around the bent panel in its mean plane, seen along the normal of this plane",
    "rise: distance between the lowest and the highest point of the panel over its mean plane",
    MEAN_PLANE,
    f"{FLAT_TRIANGLES}; edges of the triangles lie up to the given distance from it",
    "sides: along the outline, from each corner to the next; neighbours in the same order; edge: edge of the roof",
    "diagonals: straight distances between corners that are not adjacent, in the order 1-3, 1-4, ..., 2-4, ...",
    "mould radius: 1/sqrt|K|, the radius of a sphere, or of a pseudosphere for K < 0, at the middle of the thickness: the face of a mould "
    "lies half a thickness beside it; the shape of a pseudosphere, or of a spindle, bulge or hyperboloid of least bending, is in the .3dm "
    "or .step file of the moulds",
    "bending stress: largest stress of bending from the mould into position; stress on 95 %: not exceeded on 95 % of the area of the "
    "panel; part of strength: stress on 95 % relative to the characteristic bending strength without safety factor; above 100 % the panel "
    "breaks",
    "panels have the size of the surface at the middle of their thickness and meet edge to edge: no gap is left for joints, and no holes, "
    "fixings or tolerances are included",
    "corners: (x, y, z) from the origin of the model, x and y in plan, z up, from corner 1 to the last",
)


class PanelSide(NamedTuple):
    """Part of the outline between two corners or between two neighbours."""

    points: FloatArray  # (k, 2) in the drawing [mm]
    length: float  # along the outline in position [mm]
    neighbour: str  # name of the panel beyond, "edge" at the edge of the surface


class PanelSheet(NamedTuple):
    """Figures and outline of one panel, seen from outside in its mean plane."""

    fit: PanelFit
    K: float  # of the mould [1/m^2]
    radius: float  # of curvature of the mould, 0 for a plane [mm]
    sides: list[PanelSide]  # counterclockwise
    outline: FloatArray  # (n, 3) in position, from corner 1 [mm]
    corners: FloatArray  # (k, 3) in position [mm]
    heights: FloatArray  # (k,) of the corners over the mean plane, positive to the outside [mm]
    diagonals: list[tuple[int, int, float]]  # corners, from 0, and their distance in position [mm]
    size: tuple[float, float]  # length and width of the smallest rectangle [mm]
    rise: float  # distance between the lowest and the highest point over the mean plane [mm]
    area: float  # [m^2]
    above: bool  # whether the outside, from which it is seen, is above
    strength: float  # characteristic bending strength of the material [MPa]
    view: FloatArray  # (3, 3) axes of the plan or elevation that shows it: to the right, upwards, and to the viewer
    unit: str  # symbol of the unit of the model

    @property
    def used(self) -> float:
        """Stress of bending on 95 % of the area, relative to the strength of the material."""
        return self.fit.stress_95 / self.strength

    @property
    def mould(self) -> str:
        """The mould with its curvature as text."""
        radius = f"{'radius' if self.K > 0.0 else '1/√|K| ='} {self.radius:.1f} mm"
        return f"mould {self.fit.mould}: {f'K = {self.K:.6g} 1/m², {radius}' if self.radius else 'plane'}"

    @property
    def remarks(self) -> list[str]:
        """Sentences on a largest stress without a limit, and on short seams."""
        found = []
        if self.fit.causes and self.fit.stress is not None:
            found.append(
                f"the curvature of the roof is unbounded here, at {' and '.join(self.fit.causes)}: the largest stress grows as the mesh is "
                "refined; judge by the stress on 95 % of the area, and reinforce the panel there or make that part of it in its final shape"
            )
        short = [side for side in self.sides if side.neighbour != EDGE and side.length < 1e3 * SHORT]
        return found + [f"short seam with {side.neighbour}: {side.length:.1f} mm" for side in short]


def panel_sheets(problem: CGCProblem, report: MouldReport) -> list[PanelSheet]:
    """Return the schedule of the panels of a report, in their order."""
    cut = report.panels[0].panel.cut
    vertices, faces = (problem.vertices, problem.faces) if cut is None else (cut.vertices, cut.faces)
    owner = np.full(len(faces), -1)
    for number, fit in enumerate(report.panels):
        owner[fit.panel.faces] = number
    edges = edge_faces(faces)
    n = len(vertices)
    key = np.sort(edges[:, :2], axis=1) @ [n, 1]
    order = np.argsort(key, kind="stable")
    key, sides = key[order], np.where(edges[:, 3:] >= 0, owner[edges[:, 2:]], -1)[order]
    names = [fit.panel.name for fit in report.panels]
    shown, found, unit = owner >= 0, [], unit_symbol(problem.drawing.units)
    views = all_views(problem)
    normals = face_areas(vertices, faces)[:, None] * face_normals(vertices, faces)
    view = views[views_of(views, normals[shown], owner[shown], len(names))]
    for number, fit in enumerate(report.panels):
        loop = max(boundary_loops(faces[fit.panel.faces]), key=len)
        at = np.searchsorted(key, np.sort(np.column_stack([loop, np.roll(loop, -1)]), axis=1) @ [n, 1])
        beyond = np.where(sides[at, 0] == number, sides[at, 1], sides[at, 0])
        own = np.unique(faces[fit.panel.faces])
        beyond = np.where(edges[order][at, 3] < 0, -1, beyond)
        found.append(_sheet(report, fit, vertices[loop], vertices[own], beyond, names, view[number], unit))
    return found


def _sheet(
    report: MouldReport,
    fit: PanelFit,
    outline: FloatArray,
    inside: FloatArray,
    beyond: IntArray,
    names: list[str],
    view: FloatArray,
    unit: str,
) -> PanelSheet:
    """Return the figures of a panel.

    Parameters
    ----------
    report, fit
        The report, and the panel in it.
    outline
        (k, 3) outline in position, counterclockwise seen from outside [L].
    inside
        (p, 3) vertices [L].
    beyond
        (k,) number of the panel beyond every side of the outline, -1 for none.
    names
        Names of all panels.
    view
        (3, 3) axes of the plan or elevation.
    unit
        Symbol of the unit of the model.
    """
    mm = 1e3 * report.unit
    middle = inside.mean(axis=0)
    up = np.cross(outline - middle, np.roll(outline, -1, axis=0) - middle).sum(axis=0)
    up /= np.linalg.norm(up)
    box = best_box(_in_plane(inside - middle, up), (np.inf, np.inf))
    turn = np.column_stack([box.along, [-box.along[1], box.along[0]]]) if box.length >= box.width else np.array([[0.0, -1.0], [1.0, 0.0]])
    flat = mm * (_in_plane(outline - middle, up) @ turn)
    height = (inside - middle) @ up
    start = _corners(flat, beyond)
    sides = []
    for first, last in zip(start.tolist(), np.roll(start, -1).tolist()):
        path = np.arange(first, last + 1 if last > first else last + len(flat) + 1) % len(flat)
        length = mm * float(np.linalg.norm(np.diff(outline[path], axis=0), axis=1).sum())
        sides.append(PanelSide(flat[path], length, EDGE if beyond[first] < 0 else names[beyond[first]]))
    apart = [(i, j) for i in range(len(start)) for j in range(i + 2, len(start)) if (j + 1) % len(start) != i]
    diagonals = [(i, j, mm * float(np.linalg.norm(outline[start[i]] - outline[start[j]]))) for i, j in apart]
    mould = next(own for own in report.moulds if own.number == fit.mould)
    radius = mould.radius_of_curvature
    return PanelSheet(
        fit,
        mould.K / report.unit**2,
        0.0 if radius is None else mm * radius,
        sides,
        mm * np.roll(outline, -start[0], axis=0),
        mm * outline[start],
        mm * (outline[start] - middle) @ up,
        diagonals,
        (mm * max(box.length, box.width), mm * min(box.length, box.width)),
        mm * float(np.ptp(height)),
        report.unit**2 * float(face_areas(fit.vertices, fit.faces).sum()),
        bool(up[2] > 0.0),
        1e-6 * report.material.strength,
        view,
        unit,
    )


def _in_plane(points: FloatArray, up: FloatArray) -> FloatArray:
    """Return points (k, 3) in a plane with a unit normal (k, 2)."""
    along = np.cross([0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [1.0, 0.0, 0.0], up)
    along /= np.linalg.norm(along)
    return np.column_stack([points @ along, points @ np.cross(up, along)])


def _corners(flat: FloatArray, beyond: IntArray) -> IntArray:
    """Return the points of an outline (k, 2) at which it turns or its neighbour changes, at least one."""
    ahead = np.roll(flat, -1, axis=0) - flat
    back = np.roll(ahead, 1, axis=0)
    turn = np.abs(np.arctan2(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0], np.einsum("ij,ij->i", back, ahead)))
    found = np.flatnonzero((turn > CORNER) | (beyond != np.roll(beyond, 1)))
    return found if len(found) else np.zeros(1, np.int64)


def schedule_text(sheets: list[PanelSheet]) -> str:
    """Return the schedule as CSV, one row per panel; sides and neighbours are counterclockwise, seen from outside."""
    return csv_text(_HEAD, map(_row, sheets), [panel_totals(sheets), *NOTES, *model_notes(sheets)])


def model_notes(sheets: Sequence[PanelSheet]) -> list[str]:
    """Return the sentences on names of panels, on the .3dm file of the moulds, and on the faces of moulds."""
    numbered = all(re.fullmatch(rf"{own.fit.panel.region}-\d+", own.fit.panel.name) for own in sheets)
    names = ["panel: the number of its region, from 0, then its number in this region"] if numbered else []
    sides = side_note([own.K for own in sheets])
    return [*names, shapes_note(sheets[0].unit), *([sides] if sides else [])]


def panel_totals(sheets: Sequence[PanelSheet]) -> str:
    """Return the number and area of all panels as text, and those of every mould if there are several."""
    moulds = sorted({own.fit.mould for own in sheets})
    parts = [[own for own in sheets if own.fit.mould == mould] for mould in moulds]
    every, *each = [f"{counted(len(part), 'panel')}, {sum(own.area for own in part):.3f} m²" for part in (sheets, *parts)]
    if len(moulds) == 1:
        return f"total: {every}; {sheets[0].mould}"
    return f"total: {every}; " + listed([f"{part[0].mould} ({text})" for part, text in zip(parts, each)], "see the table")


def _row(own: PanelSheet) -> tuple:
    return (
        own.fit.panel.name,
        own.fit.panel.region,
        own.fit.mould,
        f"{own.K:.6g}",
        f"{own.radius:.1f}" if own.radius else "",
        f"{own.size[0]:.1f}",
        f"{own.size[1]:.1f}",
        f"{own.rise:.1f}",
        f"{own.fit.sag:.1f}",
        f"{own.area:.3f}",
        " ".join(f"{side.length:.1f}" for side in own.sides),
        " ".join(side.neighbour for side in own.sides),
        " ".join(f"{length:.1f}" for _, _, length in own.diagonals),
        "" if own.fit.stress is None else f"{own.fit.stress:.1f}",
        "" if own.fit.stress_95 is None else f"{own.fit.stress_95:.1f}",
        "" if own.fit.stress is None else f"{100.0 * own.used:.0f}",
        " ".join(f"({x:.1f}, {y:.1f}, {z:.1f})" for x, y, z in np.round(own.corners, 1) + 0.0),
        "; ".join(own.remarks),
    )
