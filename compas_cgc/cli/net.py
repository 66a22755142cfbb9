"""``compas-cgc net``: generate a net of curves on a solved surface."""

from __future__ import annotations

import argparse

from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
The curves are lines of curvature where K > 0, an asymptotic net with equal sides where K < 0, and rulings where K = 0. A .dxf is
in millimetres. Repeat -o to write several files.

examples:
  compas-cgc net saddle_solved.3dm -o laths.3dm --spacing 1.0
  compas-cgc net vault_solved.3dm -o rulings.dxf --through 1.0,2.0,0.5
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, "net")
    add_task(parser, "net")
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "net")
