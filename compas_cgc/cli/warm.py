"""``compas-cgc warm``: compile all numerical kernels in advance."""

from __future__ import annotations

import argparse
import time

from .exits import DONE

__all__ = ["add_arguments", "run", "warm"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Compile and store all numerical kernels, so that the first solve does not have to."
    parser.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    warm(arguments.quiet)
    return DONE


def warm(quiet: bool = False) -> None:
    """Compile all kernels that are not stored yet, and print the time."""
    from .._compiled import compile_seconds
    from .._warm_up import warm_up

    started = time.perf_counter()
    warm_up(builds=True)
    if not quiet:
        spent = compile_seconds()
        what = (
            f"compiled the kernels in {spent:.1f} s"
            if spent
            else f"the kernels are already compiled ({time.perf_counter() - started:.1f} s)"
        )
        print(what)
