"""Fabrication results as plain data for JSON."""

from __future__ import annotations

import math
from typing import Any
from typing import Callable

import numpy as np

from ..meshing import boundary_loops
from ..model.problem import CGCProblem
from .crosses import crosses
from .curves import CurveNet
from .drawing import LAYERS
from .membrane_state import MembraneState
from .membrane_state import forces_at_vertices
from .mould_report import MouldReport
from .mould_surface import cap_mesh
from .patterns import Patterns
from .quads import PlaneQuads
from .sheet_drawing import draw_sheets
from .views import ViewSheet
from .views.marks import LAYERS as VIEW_LAYERS

__all__ = ["build_data", "plain"]

LINE_KINDS = ("support", "crease", "free edge")


def _mould(problem: CGCProblem, report: MouldReport) -> dict[str, Any]:
    """Return moulds as meshes, and panels as meshes and outlines in position and on their moulds, with figures."""
    told = report.to_dict()
    for own, mould in zip(told["moulds"], report.moulds):
        vertices, faces = cap_mesh(mould.surface, mould.radius)
        own.update(vertices=vertices.tolist(), triangles=faces.tolist())
    for own, fit in zip(told["panels"], report.panels):
        place = fit.vertices
        loops = boundary_loops(fit.faces)
        own.update(
            vertices=place.tolist(),
            triangles=fit.faces.tolist(),
            outlines=[place[loop].tolist() for loop in loops],
            on_mould=fit.on_mould.tolist(),
            outlines_on_mould=[fit.on_mould[loop].tolist() for loop in loops],
            label_at=place.mean(axis=0).tolist(),
        )
    return {**told, "text": str(report)}


def _patterns(problem: CGCProblem, patterns: Patterns) -> dict[str, Any]:
    """Return sheets as lines and texts by layer, pieces with outlines and figures, seams, and the pieces in position as a mesh."""
    drawing = draw_sheets(patterns)
    own = patterns.patchwork
    labels = [piece.label for piece in patterns.pieces]
    return {
        "sheet": patterns.sheet,
        "sheets": patterns.sheets,
        "units": drawing.units,
        "size": drawing.size,
        "area": patterns.area,
        "area_in_space": patterns.area_in_space,
        "seam_mismatch": patterns.seam_mismatch,
        "largest_strain": patterns.largest_strain,
        "pieces": [
            {
                "label": piece.label,
                "region": piece.region,
                "sheet": piece.sheet,
                "area": piece.area,
                "area_in_space": piece.area_in_space,
                "strain": piece.strain,
                "outlines": [loop.points.tolist() for loop in piece.loops],
                "nodes": [own.names[loop.nodes].tolist() for loop in piece.loops],
            }
            for piece in patterns.pieces
        ],
        "layers": {name: "#{:02x}{:02x}{:02x}".format(*colour) for name, colour in LAYERS.items()},
        "lines": [{"layer": line.layer, "points": line.points.tolist(), "closed": line.closed} for line in drawing.lines],
        "texts": [{"layer": each.layer, "text": each.text, "at": each.place.tolist(), "height": each.height} for each in drawing.texts],
        "seams": [
            {
                "number": seam.number,
                "kind": seam.kind,
                "pieces": [labels[piece] for piece in seam.pieces],
                "lengths": list(seam.lengths),
                "length_in_space": seam.length,
                "points": own.space[seam.nodes].tolist(),
            }
            for seam in patterns.seams
        ],
        "regions": [each._asdict() for each in patterns.unrollings],
        "straightness": {str(region): each._asdict() for region, each in patterns.straightness.items()},
        "in_place": {
            "vertices": own.space.tolist(),
            "triangles": own.faces.tolist(),
            "piece": own.piece.tolist(),
            "strain": np.abs(patterns.strains).max(axis=1).tolist(),
        },
        "text": patterns.summary(),
    }


def _membrane(problem: CGCProblem, state: MembraneState) -> dict[str, Any]:
    """Return N1 and N2 at vertices and faces, crosses as lines, reactions, and line loads around regions."""
    drawn = crosses(state)
    own = state.problem
    N = forces_at_vertices(state)
    held = np.flatnonzero((state.reactions != 0.0).any(axis=1))
    loads = state.edge_loads
    return {
        "pressure": state.pressure,
        "weight": state.weight,
        "vertices": own.vertices.tolist(),
        "triangles": own.faces.tolist(),
        "N1": N[:, 0].tolist(),
        "N2": N[:, 1].tolist(),
        "face_forces": state.forces.tolist(),
        "crosses": {"lines": drawn.lines.tolist(), "forces": drawn.forces.tolist(), "faces": drawn.faces.tolist()},
        "reactions": {
            "at": own.vertices[held].tolist(),
            "vertices": own.names.vertices[held].tolist(),
            "forces": state.reactions[held].tolist(),
            "length_per_force": drawn.reaction_scale,
        },
        "line_loads": {
            "lines": own.vertices[loads.edges].tolist(),
            "kind": [LINE_KINDS[kind] for kind in loads.kind.tolist()],
            "loads": loads.load.tolist(),
        },
        "out_of_balance": state.out_of_balance,
        "correction": state.correction,
        "imbalance": state.imbalance,
        "remarks": list(state.remarks),
        "text": state.summary(),
    }


def _net(problem: CGCProblem, net: CurveNet) -> dict[str, Any]:
    """Return curves as polylines with figures, and the nodes and sides of the net."""
    names = ("region", "kind", "family", "length", "straightness")
    return {
        "spacing": net.spacing,
        "curves": [{**{name: getattr(own, name) for name in names}, "points": own.points.tolist()} for own in net.curves],
        "nodes": net.nodes.tolist(),
        "sides": net.sides.tolist(),
        "lengths": net.lengths.tolist(),
        "notes": list(net.notes),
        "report": net.summary(),
        "text": net.summary(),
    }


def _quads(problem: CGCProblem, quads: PlaneQuads) -> dict[str, Any]:
    """Return corners, faces and beams with figures."""
    return {
        "spacing": quads.spacing,
        "depth": quads.depth,
        "vertices": quads.vertices.tolist(),
        "faces": quads.faces,
        "region": quads.region.tolist(),
        "rim": quads.rim.tolist(),
        "planarity": quads.planarity.tolist(),
        "off": quads.off.tolist(),
        "beams": quads.edges.tolist(),
        "axes": quads.axes.tolist(),
        "twist": quads.twist.tolist(),
        "offset_error": quads.offset_error.tolist(),
        "irregular": quads.irregular.tolist(),
        "dead_ends": quads.dead_ends,
        "notes": list(quads.notes),
        "text": quads.summary(),
    }


def _drawings(problem: CGCProblem, drawn: ViewSheet) -> dict[str, Any]:
    """Return a sheet as lines and texts by layer in millimetres, and the contour lines and sections in space."""
    return {
        "sheet": drawn.sheet,
        "size": drawn.size,
        "scale": drawn.scale,
        "units": drawn.units,
        "interval": drawn.interval,
        "views": drawn.views,
        "layers": {name: "#{:02x}{:02x}{:02x}".format(*style.colour) for name, style in VIEW_LAYERS.items()},
        "lines": [{"layer": line.layer, "points": line.points.tolist(), "closed": line.closed} for line in drawn.lines],
        "texts": [
            {"layer": layer, "text": text, "at": place.tolist(), "height": height, "angle": angle}
            for layer, text, place, height, angle in drawn.labels
        ],
        "contours": [{"height": height, "points": points.tolist()} for height, points in drawn.contours],
        "sections": [{"letter": letter, "points": points.tolist()} for letter, points in drawn.cuts],
        "text": drawn.summary(),
    }


def plain(value: Any) -> Any:
    """Return a value with None for non-finite numbers and Python numbers for NumPy ones."""
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    return None if isinstance(value, float) and not math.isfinite(value) else value


_BY_TASK: dict[str, Callable[[CGCProblem, Any], dict[str, Any]]] = {
    "mould": _mould,
    "unroll": _patterns,
    "membrane": _membrane,
    "net": _net,
    "quads": _quads,
    "drawings": _drawings,
}


def build_data(task: str, problem: CGCProblem, report: Any) -> dict[str, Any]:
    """Return the result of :func:`compas_cgc.fabrication.tasks.build` as plain data for JSON.

    Parameters
    ----------
    task
        One of :data:`compas_cgc.fabrication.tasks.TASKS`.
    problem
        The surface.
    report
        Result of the task.
    """
    return plain(_BY_TASK[task](problem.without_dummies(), report))
