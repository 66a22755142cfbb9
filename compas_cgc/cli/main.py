"""Entry point: parse the arguments, run the command, and return an exit code."""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Optional

from .._atomic_write import PartlyPublished
from .._atomic_write import is_full
from .._atomic_write import unwritable
from .._version import __version__
from ..errors import nearest_name
from ..io.formats import READ_SUFFIXES
from .console import compiling
from .exits import INCOMPLETE
from .exits import INTERRUPTED
from .exits import REFUSED
from .parser import Parser
from .signals import end_cleanly_on_signals
from .signals import extensions_loaded_whole
from .signals import signals_in_kernels
from .signals import signals_repeated

__all__ = ["build_parser", "main"]

# Each command is a module in this folder. Only the module of the called command is imported.
COMMANDS = {
    "solve": "solve a mesh file",
    "rationalise": "find panels on few moulds for a freeform design",
    "study": "solve many variants of a drawing",
    "mould": "divide a solved surface into panels and lay them on moulds",
    "check": "list the contents of a file and the problems that prevent a solve",
    "unroll": "unroll a solved surface to flat pieces on sheets",
    "membrane": "compute the membrane forces of a solved surface under a load",
    "net": "generate a net of curves on a solved surface",
    "quads": "cover a solved surface by plane quads",
    "drawings": "draw plan, sections and elevations of a surface to scale",
    "limits": "find the largest curvature that the supports allow",
    "example": "run one of the paper's examples",
    "reproduce": "run all of the paper's examples and tables",
    "bench": "measure the speed on this machine",
    "serve": "run the compute server",
    "backup": "copy the jobs of a server, which may be running",
    "restore": "put a backup in the place of the jobs of a stopped server",
    "warm": "compile all numerical kernels in advance",
    "grasshopper": "build and install the Grasshopper components",
}

EXITS = """\
exit codes: 0 done; 1 not converged to the tolerance; 2 input refused, with the reason; 3 written, but rough, or with panels that would
break; 4 an output other than the surface could not be written; 130 interrupted; 143 terminated
"""


def build_parser(called: Optional[str] = None) -> Parser:
    """Return a parser with the arguments of the called command, and the names and purposes of the others."""
    parser = Parser(
        prog="compas-cgc",
        description="Surfaces of piecewise constant Gaussian curvature.",
        epilog=EXITS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"compas_cgc {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, text in COMMANDS.items():
        own = subparsers.add_parser(name, help=text, formatter_class=argparse.RawDescriptionHelpFormatter)
        if name == called:
            import_module(f".{name}", __package__).add_arguments(own)
    return parser


def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command and return its exit code.

    Parameters
    ----------
    argv
        Arguments. Default: those of the process.
    """
    end_cleanly_on_signals()
    try:
        with signals_repeated(), extensions_loaded_whole():
            return _run(sys.argv[1:] if argv is None else argv)
    except KeyboardInterrupt:
        print("compas-cgc: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of the pipe has closed it; avoid an error message of Python at exit.
        sys.stdout = None
        return 0
    except PartlyPublished as error:
        print(f"compas-cgc: {error}", file=sys.stderr)
        return INCOMPLETE
    except ValueError as error:
        print(f"compas-cgc: {error}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        print(f"compas-cgc: {unwritable(error.filename or 'an output', error) if is_full(error) else error}", file=sys.stderr)
        return REFUSED


def _run(argv: Sequence[str]) -> int:
    """Parse the arguments and run the command."""
    for stream in (sys.stdout, sys.stderr):
        # A console that cannot print K̄ must not end a solve.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    words = [_without_quotes(word) for word in argv]
    if words and words[0] not in COMMANDS and Path(words[0]).suffix.lower() in READ_SUFFIXES:
        print(f"compas-cgc: {words[0]} is a file; put a command before it, such as compas-cgc check {words[0]}", file=sys.stderr)
        return REFUSED
    if not words or words[0] == "help":
        words = [*words[1:2], "--help"]
    if words[0] not in COMMANDS and not words[0].startswith("-"):
        near = nearest_name(words[0], COMMANDS, 0.7)
        hint = f"the commands are {', '.join(COMMANDS)}" if near is None else f"did you mean {near}?"
        print(f"compas-cgc: unknown command {words[0]!r}; {hint}", file=sys.stderr)
        return REFUSED
    parser = build_parser(words[0])
    arguments, unknown = parser.parse_known_args(words)
    if unknown:
        parser.of(words[0]).refuse_unknown(unknown)
    with compiling(quiet=getattr(arguments, "quiet", False)), signals_in_kernels():
        return arguments.run(arguments)


def _without_quotes(word: str) -> str:
    """Return an argument as a shell would pass it: paths copied in Windows keep their quotes, and scripts do not expand ``~``."""
    if len(word) > 1 and word[0] == word[-1] == '"':
        word = word[1:-1]
    return os.path.expanduser(word) if word.startswith("~") else word
