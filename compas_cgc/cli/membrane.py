"""``compas-cgc membrane``: forces in a solved surface under a load."""

from __future__ import annotations

import argparse

from .arguments import add_supports
from .building import add_outputs
from .building import add_task
from .building import build_and_write

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Give -o several times for several files: .3dm holds maps of N1 and N2, crosses, reactions and line loads; .inp is an input of
CalculiX and Abaqus; .json is the mesh as COMPAS data with its forces. Tension is positive. Forces come in the units of the load
times the file's unit of length.

examples:
  compas-cgc membrane dome_solved.3dm -o dome_forces.3dm --pressure -1.5
  compas-cgc membrane dome_solved.3dm -o dome.inp -o dome.json --weight 2.5
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, ".3dm, .inp or .json")
    add_task(parser, "membrane")
    add_supports(parser)
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    return build_and_write(arguments, "membrane", arguments.supports)
