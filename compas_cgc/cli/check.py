"""``compas-cgc check``: list the contents of a file and the problems that prevent a solve."""

from __future__ import annotations

import argparse
from pathlib import Path

from .arguments import add_input
from .arguments import add_reading
from .arguments import read_input
from .exits import DONE
from .exits import REFUSED

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "Read a file as solve does. List its contents, the changes that solve would make, and the problems that prevent a solve."
    )
    add_input(parser)
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..errors import ProblemError
    from ..io.summary import describe
    from ..meshing import Diagnostic

    try:
        text, diagnostics = describe(read_input(arguments))
    except ProblemError as error:
        text, diagnostics = Path(arguments.input).name, [Diagnostic(problem) for problem in error.problems]
    print(text)
    if not diagnostics:
        print("no problems: the file can be solved")
        return DONE
    print(f"{len(diagnostics)} problem{'s' if len(diagnostics) > 1 else ''}:")
    for diagnostic in diagnostics:
        print(f"- {diagnostic}")
    return REFUSED if any(diagnostic.fatal for diagnostic in diagnostics) else DONE
