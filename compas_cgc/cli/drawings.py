"""``compas-cgc drawings``: draw the plan, sections and elevations of a surface to scale."""

from __future__ import annotations

import argparse

from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
The drawing is one sheet: a plan with contour lines, sections, and elevations from four sides. A .pdf or .svg has the size of the sheet; a
.dxf has the units and size of the surface. Repeat -o to write several files.

examples:
  compas-cgc drawings roof_solved.3dm -o roof.pdf -o roof.dxf
  compas-cgc drawings roof_solved.3dm -o roof.pdf --scale 50 --sheet A2 --section 0,2,8,2 --section 4,0,4,4 --contours 0.25 --north 0.3,1
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, "drawings")
    add_task(parser, "drawings")
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "drawings")
