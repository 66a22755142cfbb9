"""Patterns as files: sheets to cut from, tables, and the pieces in place."""

from __future__ import annotations

import os
from typing import Union

from ..fabrication.drawing import draw_sheets
from ..fabrication.dxf import write_dxf
from ..fabrication.patterns import Patterns
from ..fabrication.svg import write_svg
from ..fabrication.tables import write_edge_table
from ._files import suffix_among
from ._files import written

__all__ = ["PATTERN_SUFFIXES", "pattern_suffix", "write_patterns"]

PATTERN_SUFFIXES = (".dxf", ".svg", ".csv", ".3dm")


def pattern_suffix(path: Union[str, os.PathLike]) -> str:
    """Return the suffix of a file that patterns can be written to, in small letters.

    Raises
    ------
    FileError
        If patterns are not written to files of that kind.
    """
    return suffix_among(path, PATTERN_SUFFIXES, "patterns")


def write_patterns(path: Union[str, os.PathLike], patterns: Patterns, *, nodes: bool = True) -> None:
    """Write patterns in the format of the suffix, whole or not at all.

    Parameters
    ----------
    path
        A .dxf or .svg with all sheets, a .csv with all edges, or a .3dm with the sheets and the pieces in place.
    patterns
        What :func:`compas_cgc.fabrication.unroll` gave.
    nodes
        Whether the nodes along outlines are numbered.

    Raises
    ------
    FileError
        If it cannot be written.
    CGCError
        If a package is missing that the format needs.
    """
    suffix = pattern_suffix(path)
    if suffix == ".3dm":
        from .rhino.patterns import write_pattern_layers

        write_pattern_layers(path, patterns, nodes)
        return
    with written(path) as temporary:
        if suffix == ".csv":
            write_edge_table(temporary, patterns)
        elif suffix == ".svg":
            write_svg(temporary, draw_sheets(patterns, nodes=nodes))
        else:
            write_dxf(temporary, draw_sheets(patterns, nodes=nodes))
