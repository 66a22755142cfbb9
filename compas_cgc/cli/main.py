"""Parse, call, report: errors as one sentence, the exit code for scripts."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Optional

from .._version import __version__
from . import bench
from . import check
from . import example
from . import grasshopper
from . import reproduce
from . import serve
from . import solve
from .exits import INTERRUPTED
from .exits import REFUSED

__all__ = ["main"]

COMMANDS = (solve, check, example, reproduce, bench, serve, grasshopper)

EXITS = """\
exit codes: 0 done; 1 solved, but not to the tolerance; 2 refused, with a sentence that says why; 130 interrupted
"""


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = argparse.ArgumentParser(
        prog="compas-cgc",
        description="Surfaces of piecewise constant Gaussian curvature.",
        epilog=EXITS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"compas_cgc {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add_parser(subparsers)
    return parser


def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command and return its exit code.

    Parameters
    ----------
    argv
        Arguments. Default: those of the process.
    """
    for stream in (sys.stdout, sys.stderr):
        # A console that cannot show K̄ must not end a solve.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    arguments = build_parser().parse_args(argv)
    try:
        return arguments.run(arguments)
    except KeyboardInterrupt:
        print("compas-cgc: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of a pipe has seen enough; keep Python from complaining at exit.
        sys.stdout = None
        return 0
    except (ValueError, OSError) as error:
        print(f"compas-cgc: {error}", file=sys.stderr)
        return REFUSED
