"""``compas-cgc unroll``: unroll a solved surface to flat pieces on sheets."""

from __future__ import annotations

import argparse

from .building import JOINTS
from .building import add_joints
from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Repeat -o to write several files. The suffix selects the contents:

  .dxf, .svg               sheets with pieces
  .list.csv                cut list
  .plan.dxf, .plan.svg     plan of the surface with the names of the pieces
  .csv                     lengths of all edges
  .3dm                     sheets, and pieces in place
  .zip                     one .dxf per sheet, cut list and plan

Lengths without a unit are in the unit of the drawing. Regions with K = 0 unroll without strain. Other regions are divided into panels
and flattened with the least strain; the strain of a square panel is below the limit if its width is at most sqrt(24 strain / |K|).

examples:
  compas-cgc unroll vault_solved.3dm -o vault.dxf -o vault.list.csv --sheet 3.0x1.5 --margin 0.02
  compas-cgc unroll vault_solved.3dm -o vault.zip --sheet 3.0x1.5 --allowance 0.03
  compas-cgc unroll dome_solved.3dm -o dome.dxf --sheet 3000x1500mm --strain 0.2%
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, "unroll")
    add_task(parser, "unroll", leave=JOINTS)
    add_joints(parser, required=False)
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "unroll")
