"""``compas-cgc membrane``: compute the membrane forces of a solved surface under a load."""

from __future__ import annotations

import argparse

from .arguments import add_supports
from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Repeat -o to write several files. A .3dm file contains maps of the principal forces N1 and N2, crosses in their directions, reactions
and line loads. An .inp file is an input of CalculiX and Abaqus. A .json file is the mesh as COMPAS data with its forces. Tension is
positive. The unit of the forces is the unit of the load times the length unit of the file.

examples:
  compas-cgc membrane dome_solved.3dm -o dome_forces.3dm --pressure -1.5
  compas-cgc membrane dome_solved.3dm -o dome.inp -o dome.json --weight 2.5
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, "membrane")
    add_task(parser, "membrane")
    add_supports(parser)
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "membrane", arguments.supports)
