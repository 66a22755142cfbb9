"""``compas-cgc warm``: the kernels are compiled now, not in the first solve."""

from __future__ import annotations

import argparse
import time

from .exits import DONE

__all__ = ["add_arguments", "run", "warm"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Compile all kernels and store them, so that the first solve starts at once."
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    warm(arguments.quiet)
    return DONE


def warm(quiet: bool = False) -> None:
    """Compile what is not stored yet, and say so."""
    from .._compiled import compile_seconds
    from .._warm_up import warm_up

    started = time.perf_counter()
    warm_up()
    if not quiet:
        spent = compile_seconds()
        what = (
            f"compiled the kernels in {spent:.1f} s"
            if spent
            else f"the kernels were compiled already ({time.perf_counter() - started:.1f} s)"
        )
        print(f"{what}; the first solve starts at once")
