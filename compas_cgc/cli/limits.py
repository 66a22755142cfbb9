"""``compas-cgc limits``: find the largest curvature that the supports allow."""

from __future__ import annotations

import argparse
import json

from .arguments import add_input
from .arguments import add_reading
from .arguments import add_supports
from .arguments import read_input
from .console import Parts
from .exits import DONE
from .exits import NOT_CONVERGED

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Find the largest target curvature for which a fair surface exists. All targets are scaled by the same factor."
    add_input(parser)
    parser.add_argument(
        "--target", type=float, metavar="K", help="Gaussian curvature everywhere; only its sign matters (default: the targets of the file)"
    )
    add_supports(parser)
    parser.add_argument("--tolerance", type=float, default=0.01, metavar="X", help="relative accuracy of the limit (default 0.01)")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..errors import CGCError
    from ..solvers.limits import largest_target

    if not 0.0 < arguments.tolerance < 1.0:
        raise CGCError(f"--tolerance must be between 0 and 1, not {arguments.tolerance:g}")
    problem = read_input(arguments).checked()
    if arguments.supports:
        problem = problem.with_supports(arguments.supports)
    if arguments.target is not None:
        problem = problem.with_targets(arguments.target)
    with Parts(1).part("searching for the largest curvature"):
        limit = largest_target(problem, tolerance=arguments.tolerance)
    print(json.dumps(limit.to_dict(), indent=1, ensure_ascii=False) if arguments.json else limit.message)
    return NOT_CONVERGED if limit.status == "none" else DONE
