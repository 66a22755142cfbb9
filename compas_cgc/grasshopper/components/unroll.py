"""Unroll: flat pieces on sheets, and the same pieces in their final position."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.plan import flattened
from ...fabrication import draw_sheets
from ...fabrication import unroll as unroll_surface
from ...fabrication.piece_list import cut_list_text
from ...io.patterns import write_patterns
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["UnrollOutputs", "unroll"]


class UnrollOutputs(NamedTuple):
    """Outputs of the component."""

    outlines: Any
    folds: Any
    rulings: Any
    marks: Any
    sheets: Any
    labels: Optional[list[str]]
    places: Any
    pieces: Any
    report: Optional[str]
    allowances: Any
    cut_list: Optional[list[str]]


@reports_errors(UnrollOutputs)
def unroll(
    component: Any,
    cgc_mesh: Any,
    length: Optional[float],
    width: Optional[float],
    strain: Optional[float],
    spacing: Optional[float],
    path: Optional[str],
    write: Optional[bool],
    margin: Optional[float] = None,
    allowance: Optional[float] = None,
    per_sheet: Optional[bool] = None,
    whole: Optional[bool] = None,
) -> UnrollOutputs:
    """Unroll a solved surface on sheets, and write them if `write` is true."""
    if cgc_mesh is None:
        add_warning(component, "connect a solved CGC mesh")
        return UnrollOutputs(*[None] * len(UnrollOutputs._fields))
    sheet = None if not length and not width else (length or width or 0.0, width or length or 0.0)
    patterns = unroll_surface(
        cgc_mesh, sheet, strain=strain or None, spacing=spacing, margin=margin or 0.0, allowance=allowance or 0.0, whole=bool(whole)
    )
    drawing = draw_sheets(patterns, nodes=False)
    lines: dict[str, list] = {}
    for line in drawing.lines:
        points = np.vstack([line.points, line.points[:1]]) if line.closed else line.points
        lines.setdefault(line.layer, []).append(polyline_to_rhino(flattened(points)))
    labels = [text for text in drawing.texts if text.layer == "LABEL"]
    if path and write:
        write_patterns(path.strip(), patterns, per_sheet=bool(per_sheet))
    set_message(component, f"{len(patterns.pieces)} pieces on {patterns.sheets} sheets{', written' if path and write else ''}")
    own = patterns.patchwork
    pieces = []
    for number in range(len(patterns.pieces)):
        used, corners = np.unique(own.faces[own.piece == number], return_inverse=True)
        pieces.append(mesh_from_arrays(own.space[used], corners.reshape(-1, 3)))
    return UnrollOutputs(
        outlines=lines.get("OUTLINE") or lines.get("CUT", []),
        folds=[*lines.get("FOLD_UP", []), *lines.get("FOLD_DOWN", [])],
        rulings=lines.get("RULING", []),
        marks=lines.get("MARK", []),
        sheets=lines.get("SHEET", []),
        labels=[text.text for text in labels],
        places=points_to_rhino(flattened(np.array([text.place for text in labels]))),
        pieces=pieces,
        report=patterns.summary(),
        allowances=lines.get("CUT", []) if "OUTLINE" in lines else [],
        cut_list=cut_list_text(patterns).splitlines(),
    )
