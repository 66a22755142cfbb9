"""``compas-cgc unroll``: a solved surface as flat pieces on sheets."""

from __future__ import annotations

import argparse
import math
import re
from typing import Optional

from ..errors import CGCError
from .arguments import add_reading
from .exits import DONE
from .solved import add_solved
from .solved import read_solved

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
    parser.description = "Lay a solved surface out as flat pieces within sheets, with labels, folds, rulings and marks along seams."
    parser.epilog = _EPILOG
    parser.add_argument("input", metavar="FILE", help="a solved .3dm, .obj, .ply, .off, .stl or COMPAS .json file")
    parser.add_argument(
        "-o", "--output", required=True, action="append", metavar="OUT", help="a .dxf, .svg, .csv or .3dm file; several times"
    )
    parser.add_argument(
        "--sheet", metavar="LxW", help="length and width of the sheets, such as 3.0x1.5 or 3000x1500mm (default: no end of it)"
    )
    parser.add_argument("--strain", metavar="E", help="largest strain of flattened pieces, such as 0.002 or 0.2%%")
    parser.add_argument(
        "--seam", action="append", metavar="V,V,...", help="a path of vertices to cut along, in place of those that are found"
    )
    parser.add_argument("--region", action="append", type=int, metavar="N", help="take this region only; several times")
    parser.add_argument("--spacing", type=float, default=0.0, metavar="D", help="distance between pieces on a sheet (default 0)")
    parser.add_argument("--rulings", type=float, metavar="D", help="distance between the rulings drawn, 0 for none")
    parser.add_argument("--no-nodes", action="store_true", help="leave out the numbers of nodes")
    add_solved(parser)
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..fabrication import unroll
    from ..io.patterns import pattern_suffix
    from ..io.patterns import write_patterns

    for output in arguments.output:
        pattern_suffix(output)
    problem = read_solved(arguments)
    patterns = unroll(
        problem,
        None if arguments.sheet is None else sheet_size(arguments.sheet, problem.drawing.units),
        strain=None if arguments.strain is None else strain(arguments.strain),
        seams=None if arguments.seam is None else [_path(text) for text in arguments.seam],
        regions=arguments.region,
        spacing=arguments.spacing,
        rulings=arguments.rulings,
        rough=arguments.rough,
    )
    print(patterns)
    for output in arguments.output:
        write_patterns(output, patterns, nodes=not arguments.no_nodes)
        print(f"wrote {output}")
    return DONE


_METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
_UNITS = {"Millimeters": 1e-3, "Centimeters": 1e-2, "Meters": 1.0, "Kilometers": 1e3, "Inches": 0.0254, "Feet": 0.3048, "Yards": 0.9144}


def sheet_size(text: str, units: Optional[str]) -> tuple[float, float]:
    """Return length and width of a sheet such as ``3.0x1.5`` or ``3000x1500mm`` in the units of a drawing [L].

    Raises
    ------
    CGCError
        If it is no such thing.
    """
    found = re.fullmatch(r"\s*([0-9.]+)\s*[x×X]\s*([0-9.]+)\s*(mm|cm|m|in|ft)?\s*", text)
    try:
        length, width = (float(part) for part in found.groups()[:2]) if found else (math.nan, math.nan)
    except ValueError:
        length = width = math.nan
    if not found or math.isnan(length):
        raise CGCError(f"--sheet must be LENGTHxWIDTH, such as 3.0x1.5 or 3000x1500mm, not {text!r}")
    if found.group(3) is None:
        return length, width
    scale = _METRES[found.group(3)] / _UNITS.get(units or "Meters", 1.0)
    return length * scale, width * scale


def strain(text: str) -> float:
    """Return a strain such as ``0.002`` or ``0.2%``.

    Raises
    ------
    CGCError
        If it is none.
    """
    number, percent, rest = text.partition("%")
    try:
        value = float(number) * (0.01 if percent else 1.0)
    except ValueError:
        value = math.nan
    if rest.strip() or math.isnan(value):
        raise CGCError(f"--strain must be a number such as 0.002 or 0.2%, not {text!r}")
    return value


def _path(text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise CGCError(f"--seam must be the numbers of vertices, such as 4,12,20, not {text!r}") from None
