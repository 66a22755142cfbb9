"""``compas-cgc membrane``: compute the membrane forces of a solved surface under a load."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import TYPE_CHECKING
from typing import Any

from .arguments import add_supports
from .building import add_outputs
from .building import add_task
from .building import build_and_write

if TYPE_CHECKING:
    from ..fabrication import MembraneState

__all__ = ["add_arguments", "run"]

_EPILOG = """\
Repeat -o to write several files. A .3dm file contains maps of the principal forces N1 and N2, crosses in their directions, reactions
and line loads. An .inp file is an input of CalculiX and Abaqus with one step per load case; --results reads the results of CalculiX
for this file; the .inp file must be in the same folder. A .json file is the mesh as COMPAS data with its forces. Tension is positive. The
unit of the forces is the unit of the load times the length unit of the file.

examples:
  compas-cgc membrane dome_solved.3dm -o dome_forces.3dm --pressure -1.5
  compas-cgc membrane dome_solved.3dm -o dome.inp -o dome.json --weight 2.5 --snow 0.8 --wind 0.5,0
  ccx dome
  compas-cgc membrane dome_solved.3dm -o elements.3dm --weight 2.5 --results dome.frd
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_outputs(parser, "membrane")
    add_task(parser, "membrane")
    add_supports(parser)
    parser.add_argument(
        "--results", metavar="FRD", help="show N1 and N2 that CalculiX computed from the .inp file, instead of those of equilibrium"
    )
    parser.add_argument("--case", type=int, default=1, metavar="N", help="number of the load case in the results (default: 1)")
    parser.epilog = _EPILOG
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..fabrication.materials import metres_per_unit
    from ..io.frd import with_results

    def revised(state: MembraneState, settings: Mapping[str, Any]) -> MembraneState:
        if not arguments.results:
            return state
        # Without the option, the .inp file beside the results states it.
        given = settings.get("thickness")
        thickness = None if given is None else 1e-3 * given / metres_per_unit(state.problem.drawing.units)
        return with_results(state, arguments.results, thickness, arguments.case)

    return build_and_write(arguments, "membrane", arguments.supports, revised)
