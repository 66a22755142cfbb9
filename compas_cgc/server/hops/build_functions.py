"""Functions of the components for tasks on solved surfaces, run in the workers."""

from __future__ import annotations

import time
from typing import Any
from typing import Callable

import numpy as np

from ...discrete.plan import flattened
from ...fabrication import draw_sheets
from ...fabrication.crosses import crosses
from ...fabrication.membrane_state import forces_at_vertices
from ...fabrication.mould_surface import cap_mesh
from ...fabrication.piece_list import cut_list_text
from ...fabrication.quads.plane_faces import axis_lines
from ...fabrication.tasks import build
from ...model.problem import CGCProblem
from ..api.rhino_mesh import mesh_text
from ..api.rhino_mesh import polyline_text
from ..limits import Limits
from .data_tree import entry
from .inputs import surface_of
from .reply import Reply
from .reply import spent

__all__ = ["BUILD_FUNCTIONS"]

# Options by name of the input; zero and an empty input select the default.
MOULD = {
    "Count": "count",
    "Size": "size",
    "Along": "along",
    "Material": "material",
    "Thickness": "thickness",
    "Tolerance": "tolerance",
    "LeastBending": "least_bending",
}
UNROLL = {
    "Strain": "strain",
    "Spacing": "spacing",
    "Margin": "margin",
    "Allowance": "allowance",
    "Whole": "whole",
    "Kerf": "kerf",
    "Material": "material",
    "Thickness": "thickness",
}
MEMBRANE = {"Pressure": "pressure", "Weight": "weight", "EdgeBeams": "edge_beams"}
QUADS = {"Spacing": "spacing", "Depth": "depth"}
NET = {"Spacing": "spacing", "Through": "through", "Kind": "kind"}


def _settings(inputs: dict, names: dict[str, str]) -> dict[str, Any]:
    return {option: inputs[name] for name, option in names.items() if isinstance(inputs[name], bool) or inputs[name]}


def _built(
    task: str,
    settings_of: Callable[[dict], dict[str, Any]],
    outputs_of: Callable[[CGCProblem, Any], list[dict]],
    inputs: dict,
    context: dict,
    limits: Limits,
    started: float,
) -> Reply:
    problem, notes = surface_of(inputs, context, limits)
    read = time.perf_counter()
    made = build(task, problem, settings_of(inputs))
    done = time.perf_counter()
    info = entry("Info", "Text", ["\n".join([str(made), *notes])])
    values = [*outputs_of(problem, made), info]
    return Reply(200, values, [], list(getattr(made, "remarks", ())), spent(started, read, done))


def _mould(*request: Any) -> Reply:
    def settings(inputs: dict) -> dict[str, Any]:
        found = _settings(inputs, MOULD)
        return {name: value for name, value in found.items() if not (name == "count" and "size" in found)}

    return _built("mould", settings, _mould_outputs, *request)


def _mould_outputs(problem: CGCProblem, report: Any) -> list[dict]:
    panels = [mesh_text(fit.vertices, fit.faces) for fit in report.panels]
    return [
        entry("Panels", "Mesh", panels),
        entry("OnMoulds", "Mesh", [mesh_text(fit.on_mould, fit.faces) for fit in report.panels]),
        entry("Moulds", "Mesh", [mesh_text(*cap_mesh(mould.surface, mould.radius)) for mould in report.moulds]),
        entry("Mould", "Integer", [fit.mould - 1 for fit in report.panels]),
        entry("Names", "Text", [fit.panel.name for fit in report.panels]),
        entry("Misses", "Number", [fit.rigid for fit in report.panels]),
    ]


def _unroll(*request: Any) -> Reply:
    def settings(inputs: dict) -> dict[str, Any]:
        length, width = inputs["Length"], inputs["Width"]
        sheet = {"sheet": (length or width, width or length)} if length or width else {}
        return {**_settings(inputs, UNROLL), **sheet}

    return _built("unroll", settings, _unroll_outputs, *request)


def _unroll_outputs(problem: CGCProblem, patterns: Any) -> list[dict]:
    drawing = draw_sheets(patterns, nodes=False)
    lines: dict[str, list[str]] = {}
    for line in drawing.lines:
        points = np.vstack([line.points, line.points[:1]]) if line.closed else line.points
        lines.setdefault(line.layer, []).append(polyline_text(flattened(points)))
    labels = [text for text in drawing.texts if text.layer == "LABEL"]
    own = patterns.patchwork
    pieces = []
    for number in range(len(patterns.pieces)):
        used, corners = np.unique(own.faces[own.piece == number], return_inverse=True)
        pieces.append(mesh_text(own.space[used], corners.reshape(-1, 3)))
    return [
        entry("Outlines", "Curve", lines.get("OUTLINE") or lines.get("CUT", [])),
        entry("Folds", "Curve", [*lines.get("FOLD_UP", []), *lines.get("FOLD_DOWN", [])]),
        entry("Rulings", "Curve", lines.get("RULING", [])),
        entry("Marks", "Curve", lines.get("MARK", [])),
        entry("Sheets", "Curve", lines.get("SHEET", [])),
        entry("Labels", "Text", [text.text for text in labels]),
        entry("Places", "Point", flattened(np.array([text.place for text in labels])).tolist()),
        entry("Pieces", "Mesh", pieces),
        entry("Strains", "Number", [piece.strain for piece in patterns.pieces]),
        entry("Allowances", "Curve", lines.get("CUT", []) if "OUTLINE" in lines else []),
        entry("Sheet", "Integer", [piece.sheet for piece in patterns.pieces]),
        # Hops strips quotation marks from the ends of a text, which would join a quoted note with the next row.
        entry("CutList", "Text", [f"{row} " if row.endswith('"') else row for row in cut_list_text(patterns).splitlines()]),
    ]


def _membrane(*request: Any) -> Reply:
    def settings(inputs: dict) -> dict[str, Any]:
        return _settings(inputs, MEMBRANE)

    return _built("membrane", settings, _membrane_outputs, *request)


def _membrane_outputs(problem: CGCProblem, state: Any) -> list[dict]:
    at_vertices = forces_at_vertices(state)
    limit = float(np.percentile(np.abs(at_vertices), 98)) or 1.0
    drawn = crosses(state)
    lines, forces = drawn.lines.reshape(-1, 2, 3), drawn.forces.T.ravel()
    loaded = np.abs(state.reactions).max(axis=1) > 0
    places = state.problem.vertices[loaded]
    tips = places + drawn.reaction_scale * state.reactions[loaded]
    return [
        entry("Mesh", "Mesh", [mesh_text(state.problem.vertices, state.problem.faces, at_vertices[:, 0], limit)]),
        entry("N1", "Number", at_vertices[:, 0].tolist()),
        entry("N2", "Number", at_vertices[:, 1].tolist()),
        entry("Tension", "Curve", [polyline_text(line) for line in lines[forces > 0]]),
        entry("Compression", "Curve", [polyline_text(line) for line in lines[forces <= 0]]),
        entry("Reactions", "Curve", [polyline_text(np.array(ends)) for ends in zip(places, tips)]),
        entry("LineLoads", "Number", np.linalg.norm(state.edge_loads.load, axis=1).tolist()),
    ]


def _net(*request: Any) -> Reply:
    def settings(inputs: dict) -> dict[str, Any]:
        return _settings(inputs, NET)

    return _built("net", settings, _net_outputs, *request)


def _net_outputs(problem: CGCProblem, net: Any) -> list[dict]:
    first, second = ([polyline_text(own.points) for own in net.curves if own.family == family] for family in (0, 1))
    return [
        entry("First", "Curve", first),
        entry("Second", "Curve", second),
        entry("Nodes", "Point", net.nodes.tolist()),
        entry("Sides", "Number", net.lengths.tolist()),
    ]


def _quads(*request: Any) -> Reply:
    def settings(inputs: dict) -> dict[str, Any]:
        return _settings(inputs, QUADS)

    return _built("quads", settings, _quad_outputs, *request)


def _quad_outputs(problem: CGCProblem, quads: Any) -> list[dict]:
    outlines = [quads.vertices[[*face, face[0]]] for face in quads.faces]
    return [
        entry("Faces", "Curve", [polyline_text(points) for points in outlines]),
        entry("Beams", "Curve", [polyline_text(ends) for ends in quads.vertices[quads.edges]]),
        entry("Nodes", "Point", quads.vertices.tolist()),
        entry("Axes", "Curve", [polyline_text(ends) for ends in axis_lines(quads)]),
        entry("Irregular", "Point", quads.vertices[quads.irregular].tolist()),
        entry("Planarity", "Number", quads.planarity.tolist()),
        entry("Twist", "Number", quads.twist.tolist()),
    ]


BUILD_FUNCTIONS: dict[str, Callable[[dict, dict, Limits, float], Reply]] = {
    "cgc/mould": _mould,
    "cgc/unroll": _unroll,
    "cgc/membrane": _membrane,
    "cgc/net": _net,
    "cgc/quads": _quads,
}
