"""Builds as files: the formats of each task, and one function that writes all of them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from typing import Union

from .._atomic_write import replacing
from ..fabrication.mould_report import MouldReport
from ..fabrication.tables import csv_text
from ..fabrication.tasks import file_options
from ..model.problem import CGCProblem
from ._files import suffix_among
from .forces import write_forces
from .formats import OUTPUTS
from .nets import write_net
from .patterns import write_patterns
from .quads import write_quads
from .views import write_views

__all__ = ["build_suffix", "write_build", "write_mould_files"]

_WHAT = {"mould": "moulds", "unroll": "patterns", "membrane": "forces", "net": "curves", "quads": "plane quads", "drawings": "drawings"}


def build_suffix(task: str, path: Union[str, os.PathLike]) -> str:
    """Return the suffix of an output file of a task, in lower case.

    Raises
    ------
    FileError
        If the task has no output in this format.
    """
    return suffix_among(path, OUTPUTS[task], _WHAT[task])


def write_build(path: Union[str, os.PathLike], task: str, problem: CGCProblem, report: Any, settings: Mapping[str, Any]) -> list[Path]:
    """Write the output of a task in the format of the suffix, atomically.

    Parameters
    ----------
    path
        Output file, with a suffix in :data:`compas_cgc.io.formats.OUTPUTS`.
    task
        Name of the task.
    problem
        The solved surface.
    report
        Result of the task.
    settings
        Options of the task; only those that affect files are used.

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
    build_suffix(task, path)
    files = file_options(task, settings, problem.drawing.units)
    if task == "unroll":
        return write_patterns(path, report, **files)
    if task == "membrane":
        write_forces(path, report, **files)
    elif task == "net":
        write_net(path, report, **files)
    elif task == "quads":
        write_quads(path, report)
    elif task == "drawings":
        write_views(path, report)
    else:
        write_mould_files(path, problem, report)
    return [Path(path)]


def write_mould_files(
    path: Union[str, os.PathLike], problem: CGCProblem, report: MouldReport, source: Union[str, os.PathLike, None] = None
) -> list[str]:
    """Write moulds in the format of the suffix, atomically, and return notes on what the file does not hold.

    Parameters
    ----------
    path
        The file: .3dm, .step, .ifc or .csv.
    problem
        The solved surface.
    report
        Its moulds.
    source
        A .3dm file whose contents are kept in a .3dm file.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    suffix, notes = build_suffix("mould", path), list[str]()
    if suffix == ".3dm":
        from .rhino.mould_layers import write_moulds

        write_moulds(path, problem, report, source=source)
        return notes
    if suffix == ".csv":
        content = _panel_table(report).encode("utf-8")
    elif suffix == ".ifc":
        from .ifc import ifc_bytes

        content = ifc_bytes(problem, report)
    else:
        from .mould_step import mould_step_bytes

        content, notes = mould_step_bytes(problem, report)
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    return notes


def _panel_table(report: MouldReport) -> str:
    """Return a CSV table with one row per panel."""
    rows = [own.to_dict() for own in report.panels]
    return csv_text(list(rows[0]), [list(row.values()) for row in rows])
