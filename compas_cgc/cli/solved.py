"""Reading solved surfaces, for the commands that build from them."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from .arguments import reading
from .arguments import with_targets

if TYPE_CHECKING:
    from ..model.problem import CGCProblem

__all__ = ["add_solved", "read_solved"]


def add_solved(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for what is asked of a solved surface."""
    parser.add_argument(
        "--target",
        action="append",
        default=[],
        metavar="[REGION=]K",
        help="K that the surface has been solved for, where the file does not say",
    )
    parser.add_argument("--rough", action="store_true", help="take a surface that check calls rough all the same")


def read_solved(arguments: argparse.Namespace) -> CGCProblem:
    """Return the surface of a file; of a .3dm with a result, the result.

    Raises
    ------
    CGCError
        If it cannot be read.
    """
    from ..io import read_problem

    read = read_problem(arguments.input, **reading(arguments), result=True)
    for note in read.notes:
        print(f"{arguments.input}: {note}")
    return with_targets(read.checked(), arguments.target)
