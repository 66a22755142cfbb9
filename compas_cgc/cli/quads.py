"""``compas-cgc quads``: cover a solved surface by plane quads."""

from __future__ import annotations

import argparse

from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
The quads follow lines of curvature; no line ends inside. Repeat -o to write several files. The suffix selects the contents:

  .3dm                     faces, beams and numbers in place, in the unit of the drawing
  .dxf                     the same in millimetres
  .flat.dxf, .flat.svg     outlines of all faces and beams, flat at 1:1 in millimetres
  .csv, .beams.csv         one row per face, one row per beam, in millimetres

examples:
  compas-cgc quads cushion_solved.3dm -o quads.3dm --spacing 0.8
  compas-cgc quads cushion_solved.3dm -o roof.flat.dxf -o faces.csv -o frame.beams.csv --depth 0.12
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, "quads")
    add_task(parser, "quads")
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "quads")
