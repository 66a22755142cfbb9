"""``compas-cgc unroll``: a solved surface as flat pieces on sheets."""

from __future__ import annotations

import argparse

from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Give -o several times for several files: .dxf and .svg hold the sheets, .csv all edges with their lengths, .3dm the sheets and
the pieces in place. Regions of K = 0 keep all lengths; others are cut into panels and flattened with the least strain: a square
panel of width sqrt(24 strain / |K|) stays below a strain.

examples:
  compas-cgc unroll vault_solved.3dm -o vault.dxf -o vault.csv --sheet 3.0x1.5
  compas-cgc unroll dome_solved.3dm -o dome.dxf --sheet 3000x1500mm --strain 0.2%
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, ".dxf, .svg, .csv or .3dm")
    add_task(parser, "unroll")
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "unroll")
