"""Patterns as files: cutting sheets, tables, plan, and pieces in their final position."""

from __future__ import annotations

import io
import os
import zipfile
from contextlib import ExitStack
from pathlib import Path
from typing import Union

from .._atomic_write import replacing
from ..errors import CGCError
from ..fabrication.assembly import draw_plan
from ..fabrication.drawing import Drawing
from ..fabrication.dxf import dxf_text
from ..fabrication.option_values import DRAWING_UNITS
from ..fabrication.patterns import Patterns
from ..fabrication.piece_list import cut_list_text
from ..fabrication.sheet_drawing import draw_sheets
from ..fabrication.svg import svg_text
from ..fabrication.tables import edge_table_text
from ._files import suffix_among
from .formats import OUTPUTS

__all__ = ["write_patterns"]

_TEXT = {".dxf": dxf_text, ".svg": svg_text}
_ARCHIVE_DATE = (1980, 1, 1, 0, 0, 0)  # constant, so that the same patterns give the same archive


def write_patterns(
    path: Union[str, os.PathLike], patterns: Patterns, *, nodes: bool = True, per_sheet: bool = False, units: str = "mm"
) -> list[Path]:
    """Write patterns in the format of the suffix, atomically.

    Parameters
    ----------
    path
        A .dxf or .svg with all sheets, a .csv with all edges, a .list.csv with one row per piece, a .plan.dxf or .plan.svg with
        the surface in plan, a .3dm with sheets and positioned pieces, or a .zip with a .dxf per sheet, the list and the plan.
    patterns
        Patterns from :func:`compas_cgc.fabrication.unroll`.
    nodes
        Whether to number the nodes along outlines.
    per_sheet
        Whether to write one .dxf or .svg per sheet, numbered from 1 before the suffix.
    units
        Units of .dxf and .svg: ``mm``, ``cm``, ``m``, ``in``, ``ft``, or ``drawing`` for those of the surface.

    Returns
    -------
    list of Path
        The written files.

    Raises
    ------
    FileError
        If a file cannot be written.
    CGCError
        If a package that the format requires is missing.
    """
    suffix, path = suffix_among(path, OUTPUTS["unroll"], "patterns"), Path(path)
    if suffix == ".3dm":
        from .rhino.patterns import write_pattern_layers

        write_pattern_layers(path, patterns, nodes)
        return [path]
    # Draw everything before creating folders or files.
    if per_sheet and suffix in _TEXT:
        contents = {path.with_name(name): text for name, text in _by_sheet(path.stem, suffix, patterns, nodes, units).items()}
    else:
        contents = {path: _content(path, suffix, patterns, nodes, units)}
    with ExitStack() as files:
        for name, content in contents.items():
            files.enter_context(replacing(name)).write_bytes(content)
    return list(contents)


def _content(path: Path, suffix: str, patterns: Patterns, nodes: bool, units: str) -> bytes:
    if suffix == ".zip":
        stem = path.stem
        packed = {
            **_by_sheet(stem, ".dxf", patterns, nodes, units),
            **{f"{stem}{own}": _content(path, own, patterns, nodes, units) for own in (".list.csv", ".plan.dxf")},
        }
        return _archive(packed)
    if suffix.endswith(".csv"):
        return (cut_list_text if suffix == ".list.csv" else edge_table_text)(patterns).encode("utf-8")
    drawing = draw_plan(patterns) if suffix.startswith(".plan") else draw_sheets(patterns, nodes=nodes)
    return _TEXT[Path(suffix).suffix or suffix](_within(drawing, units)).encode("utf-8")


def _by_sheet(stem: str, suffix: str, patterns: Patterns, nodes: bool, units: str) -> dict[str, bytes]:
    digits = len(str(patterns.sheets))
    drawn = (draw_sheets(patterns, nodes=nodes, sheet=sheet) for sheet in range(patterns.sheets))
    return {
        f"{stem}-{number:0{digits}d}{suffix}": _TEXT[suffix](_within(drawing, units)).encode("utf-8")
        for number, drawing in enumerate(drawn, 1)
    }


def _within(drawing: Drawing, units: str) -> Drawing:
    if units != "drawing" and units not in DRAWING_UNITS:
        raise CGCError(f"files can be in {', '.join(DRAWING_UNITS)} or drawing units, not in {units!r:.60}")
    return drawing if units == "drawing" else drawing.within(DRAWING_UNITS[units])


def _archive(files: dict[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, _ARCHIVE_DATE), content, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
