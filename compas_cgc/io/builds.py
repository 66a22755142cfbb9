"""What was built as files: which formats each task has, and one function that writes them all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from typing import Union

from ..fabrication.mould_report import MouldReport
from ..fabrication.tables import csv_text
from ..fabrication.tasks import file_options
from ..model.problem import CGCProblem
from ._files import suffix_among
from ._files import written
from .forces import FORCE_SUFFIXES
from .forces import write_forces
from .nets import NET_SUFFIXES
from .nets import write_net
from .patterns import PATTERN_SUFFIXES
from .patterns import write_patterns

__all__ = ["BUILD_SUFFIXES", "build_suffix", "write_build"]

# By task, the first for Rhino.
BUILD_SUFFIXES: dict[str, tuple[str, ...]] = {
    "mould": (".3dm", ".csv"),
    "unroll": PATTERN_SUFFIXES,
    "membrane": FORCE_SUFFIXES,
    "net": NET_SUFFIXES,
}
_WHAT = {"mould": "moulds", "unroll": "patterns", "membrane": "forces", "net": "curves"}


def build_suffix(task: str, path: Union[str, os.PathLike]) -> str:
    """Return the suffix of a file that a task can be written to, in small letters.

    Raises
    ------
    FileError
        If what it makes is not written to files of that kind.
    """
    return suffix_among(path, BUILD_SUFFIXES[task], _WHAT[task])


def write_build(path: Union[str, os.PathLike], task: str, problem: CGCProblem, report: Any, settings: Mapping[str, Any]) -> list[Path]:
    """Write what a task has made in the format of the suffix, whole or not at all.

    Parameters
    ----------
    path
        Of a suffix in :data:`BUILD_SUFFIXES`.
    task
        Which it is.
    problem
        The surface that it was made of.
    report
        What was made.
    settings
        Options of the task, of which those that change files are taken.

    Returns
    -------
    list of Path
        The files that were written.

    Raises
    ------
    FileError
        If it cannot be written.
    CGCError
        If a package is missing that the format needs.
    """
    suffix = build_suffix(task, path)
    if task == "unroll":
        return write_patterns(path, report, **file_options(task, settings))
    if task == "membrane":
        write_forces(path, report)
    elif task == "net":
        write_net(path, report)
    elif suffix == ".3dm":
        from .rhino.mould_layers import write_moulds

        write_moulds(path, problem, report)
    else:
        with written(path) as temporary:
            temporary.write_bytes(_panel_table(report).encode("utf-8"))
    return [Path(path)]


def _panel_table(report: MouldReport) -> str:
    """Return a row for every panel with its figures, as CSV."""
    rows = [own.to_dict() for own in report.panels]
    return csv_text(list(rows[0]), [list(row.values()) for row in rows])
