"""``compas-cgc unroll``: a solved surface as flat pieces on sheets."""

from __future__ import annotations

import argparse

from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Give -o several times for several files: .dxf and .svg hold the sheets, .list.csv the cut list, .plan.dxf and .plan.svg the roof in
plan with the names of its pieces, .csv all edges with their lengths, .3dm the sheets and the pieces in place, .zip a .dxf for each
sheet, the cut list and the plan. Lengths without a unit are in that of the drawing. Regions of K = 0 keep all lengths; others are
cut into panels and flattened with the least strain: a square panel of width sqrt(24 strain / |K|) stays below a strain.

examples:
  compas-cgc unroll vault_solved.3dm -o vault.dxf -o vault.list.csv --sheet 3.0x1.5 --margin 0.02
  compas-cgc unroll vault_solved.3dm -o vault.zip --sheet 3.0x1.5 --allowance 0.03
  compas-cgc unroll dome_solved.3dm -o dome.dxf --sheet 3000x1500mm --strain 0.2%
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, ".dxf, .svg, .csv, .list.csv, .plan.dxf, .plan.svg, .3dm or .zip")
    add_task(parser, "unroll")
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "unroll")
