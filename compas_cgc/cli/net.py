"""``compas-cgc net``: curves to build a solved surface along."""

from __future__ import annotations

import argparse
from typing import Union

from ..errors import CGCError
from .arguments import add_reading
from .exits import DONE
from .solved import add_solved
from .solved import read_solved

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Lines of curvature where K > 0, an asymptotic net of equal sides where K < 0, rulings where K = 0. Give -o several times for
several files.

examples:
  compas-cgc net saddle_solved.3dm -o laths.3dm --spacing 1.0
  compas-cgc net vault_solved.3dm -o rulings.dxf --through 1.0,2.0,0.5
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Trace the curves that a surface of constant K in each region is built along."
    parser.epilog = _EPILOG
    parser.add_argument("input", metavar="FILE", help="a solved .3dm, .obj, .ply, .off, .stl or COMPAS .json file")
    parser.add_argument("-o", "--output", required=True, action="append", metavar="OUT", help="a .3dm, .dxf or .json file; several times")
    parser.add_argument("--spacing", type=float, metavar="D", help="distance between curves (default: a twelfth of a region)")
    parser.add_argument("--through", action="append", metavar="X,Y,Z", help="trace curves through points instead, or through 'supports'")
    parser.add_argument("--region", action="append", type=int, metavar="N", help="take this region only; several times")
    add_solved(parser)
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..fabrication import curve_net
    from ..io.nets import net_suffix
    from ..io.nets import write_net

    for output in arguments.output:
        net_suffix(output)
    through = None if arguments.through is None else _points(arguments.through)
    problem = read_solved(arguments)
    net = curve_net(problem, arguments.spacing, through=through, regions=arguments.region, rough=arguments.rough)
    print(net)
    for output in arguments.output:
        write_net(output, net)
        print(f"wrote {output}")
    return DONE


def _points(texts: list[str]) -> Union[str, list[list[float]]]:
    if texts == ["supports"]:
        return "supports"
    try:
        points = [[float(part) for part in text.split(",")] for text in texts]
    except ValueError:
        points = []
    if not points or any(len(point) != 3 for point in points):
        raise CGCError(f"--through must be X,Y,Z such as 1.0,2.0,0.5, or 'supports', not {' '.join(texts)!r}")
    return points
