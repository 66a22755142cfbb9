"""``compas-cgc membrane``: forces in a solved surface under a load."""

from __future__ import annotations

import argparse

from .arguments import add_reading
from .exits import DONE
from .solved import add_solved
from .solved import read_solved

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
    parser.description = (
        "Find the membrane forces of a surface of constant K in each region, and edge forces in exact balance with the load."
    )
    parser.epilog = _EPILOG
    parser.add_argument("input", metavar="FILE", help="a solved .3dm, .obj, .ply, .off, .stl or COMPAS .json file")
    parser.add_argument("-o", "--output", required=True, action="append", metavar="OUT", help="a .3dm, .inp or .json file; several times")
    parser.add_argument(
        "--pressure", type=float, default=0.0, metavar="P", help="load along the normals for each area, outwards where positive"
    )
    parser.add_argument("--weight", type=float, default=0.0, metavar="G", help="load downwards for each area of the surface")
    parser.add_argument("--no-edge-beams", action="store_true", help="leave free edges unloaded, where that is possible")
    parser.add_argument("--supports", choices=("boundary", "corners"), help="fix the whole open edge or its corners, not the file's points")
    add_solved(parser)
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..fabrication import membrane
    from ..io.forces import force_suffix
    from ..io.forces import write_forces

    for output in arguments.output:
        force_suffix(output)
    problem = read_solved(arguments)
    if arguments.supports:
        problem = problem.with_supports(arguments.supports)
    state = membrane(problem, arguments.pressure, arguments.weight, edge_beams=not arguments.no_edge_beams, rough=arguments.rough)
    print(state)
    for output in arguments.output:
        write_forces(output, state)
        print(f"wrote {output}")
    return DONE
