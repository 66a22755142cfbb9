"""Unroll: flat pieces on sheets, and the same pieces in their final position."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.plan import flattened
from ...fabrication import Patterns
from ...fabrication import draw_sheets
from ...fabrication import unroll as unroll_surface
from ...fabrication.piece_list import cut_list_text
from ...io.patterns import write_patterns
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.paths import file_to_write
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner

__all__ = ["UnrollOutputs", "unroll"]


class UnrollOutputs(NamedTuple):
    """Outputs of the component."""

    outlines: Any = None
    folds: Any = None
    rulings: Any = None
    marks: Any = None
    sheets: Any = None
    labels: Optional[list[str]] = None
    places: Any = None
    pieces: Any = None
    report: Optional[str] = None
    allowances: Any = None
    cut_list: Optional[list[str]] = None


_RUNNER = Runner(UnrollOutputs(), "unrolling")


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
    kerf: Optional[float] = None,
    material: Optional[str] = None,
    thickness: Optional[float] = None,
) -> UnrollOutputs:
    """Unroll a solved surface on sheets, and write them if `write` is true."""
    file = file_to_write(component, path, bool(write) and cgc_mesh is not None)
    if cgc_mesh is None:
        ask_for(component, "a solved CGC mesh")
        _RUNNER.reset(component)
        return UnrollOutputs()
    sheet = None if not length and not width else (length or width or 0.0, width or length or 0.0)

    def work(report: Report, last: Last) -> Finished:
        patterns = unroll_surface(
            cgc_mesh,
            sheet,
            strain=strain or None,
            spacing=spacing,
            margin=margin or 0.0,
            allowance=allowance or 0.0,
            whole=bool(whole),
            kerf=kerf or 0.0,
            material=material or "",
            thickness=thickness or 0.0,
        )
        if file is not None:
            write_patterns(file, patterns, per_sheet=bool(per_sheet))
        return _drawn(patterns, file is not None)

    given = (cgc_mesh, sheet, strain, spacing, file, margin, allowance, per_sheet, whole, kerf, material, thickness)
    return _RUNNER.outputs(component, given, work).outputs


def _drawn(patterns: Patterns, written: bool) -> Finished:
    """Return the pieces on sheets and in place."""
    drawing = draw_sheets(patterns, nodes=False)
    lines: dict[str, list] = {}
    for line in drawing.lines:
        points = np.vstack([line.points, line.points[:1]]) if line.closed else line.points
        lines.setdefault(line.layer, []).append(polyline_to_rhino(flattened(points)))
    labels = [text for text in drawing.texts if text.layer == "LABEL"]
    own = patterns.patchwork
    pieces = []
    for number in range(len(patterns.pieces)):
        used, corners = np.unique(own.faces[own.piece == number], return_inverse=True)
        pieces.append(mesh_from_arrays(own.space[used], corners.reshape(-1, 3)))
    out = UnrollOutputs(
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
    return Finished(out, f"{len(patterns.pieces)} pieces on {patterns.sheets} sheets{', written' if written else ''}")
