"""Options, input and output of the commands that use a solved surface."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Callable
from typing import Optional

from .._atomic_write import published_together
from ..errors import CGCError
from ..fabrication.tasks import TASKS
from ..fabrication.tasks import BuildOption
from ..fabrication.tasks import read_settings
from ..io.formats import OUTPUTS
from ..io.formats import listed
from .arguments import add_input
from .arguments import add_reading
from .arguments import read_input
from .arguments import with_laws
from .arguments import with_targets
from .console import Parts
from .console import printer
from .exits import DONE

if TYPE_CHECKING:
    from ..model.problem import CGCProblem

__all__ = ["JOINTS", "add_joints", "add_outputs", "add_task", "build_and_write", "read_solved", "settings_of", "with_curves"]

JOINTS = ("size", "count", "columns", "rows")  # options of a task that divide regions


def add_task(parser: argparse.ArgumentParser, task: str, leave: Sequence[str] = ()) -> None:
    """Add the input file, the options of a task except those in `leave`, and the arguments for reading."""
    parser.description = TASKS[task].text
    add_input(parser, "a solved")
    for own in TASKS[task].options:
        if own.name not in leave:
            _add(parser, own)
    parser.add_argument(
        "--target",
        action="append",
        default=[],
        metavar="[REGION=]K",
        help="K for which the surface was solved, if the file does not contain it; repeatable",
    )
    parser.add_argument(
        "--law",
        action="append",
        default=[],
        metavar="[REGION=]LAW",
        help="law for which the surface was solved, such as minimal or 'H = 0.1', if the file does not contain it; repeatable",
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    add_reading(parser)


def add_joints(parser: argparse.ArgumentParser, required: bool) -> None:
    """Add the options that divide regions into panels."""
    divided = parser.add_mutually_exclusive_group(required=required)
    divided.add_argument("--size", metavar="L", help="approximate width of the panels, in model units")
    divided.add_argument("--count", metavar="N", help="approximate number of panels per region")
    divided.add_argument("--columns", metavar="L,L,...", help="widths of the panels along x; the last one is repeated")
    divided.add_argument("--curves", metavar="LAYER", help="divide along the curves on a layer of the .3dm file")
    parser.add_argument("--rows", metavar="L,L,...", help="widths of the panels along y, with --columns")


def with_curves(settings: dict[str, Any], arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the settings of a task with the curves of the layer given by ``--curves``.

    Raises
    ------
    CGCError
        If the input is not a .3dm file.
    """
    if arguments.curves is None:
        return settings
    if Path(arguments.input).suffix.lower() != ".3dm":
        raise CGCError("--curves requires a .3dm input file; for other formats use --size, --count or --columns")
    from ..io.rhino.read import read_curves

    return {**settings, "curves": read_curves(arguments.input, arguments.curves)}


def add_outputs(parser: argparse.ArgumentParser, task: str) -> None:
    """Add ``-o``, which is repeatable."""
    parser.add_argument(
        "-o", "--output", required=True, action="append", metavar="OUT", help=f"{listed(OUTPUTS[task])} file to write; repeatable"
    )


def _add(parser: argparse._ActionsContainer, own: BuildOption) -> None:
    help = own.text.replace("%", "%%")
    flag = (own.flag or own.name).replace("_", "-")
    if own.schema == {"type": "boolean"}:
        parser.add_argument(f"--{flag}", dest=own.name, default=None, action=argparse.BooleanOptionalAction, help=help)
    elif own.schema.get("type") == "boolean":
        wanted = not own.schema["default"]
        parser.add_argument(
            f"--{flag}" if wanted else f"--no-{flag}", dest=own.name, default=None, action="store_const", const=wanted, help=_switch(own)
        )
    elif own.many:
        parser.add_argument(f"--{flag}", dest=own.name, action="append", metavar=own.metavar, help=f"{help}; repeatable")
    else:
        parser.add_argument(f"--{flag}", dest=own.name, metavar=own.metavar, help=help)


def _switch(own: BuildOption) -> str:
    return own.text if not own.schema["default"] else f"omit {own.text.replace(' (default: yes)', '')}"


def settings_of(arguments: argparse.Namespace, task: str) -> dict[str, Any]:
    """Return the options of a task.

    Raises
    ------
    CGCError
        If an option is invalid.
    """
    given = {own.name: getattr(arguments, own.name) for own in TASKS[task].options}
    flags = {own.name: f"--{(own.flag or own.name).replace('_', '-')}" for own in TASKS[task].options}
    return read_settings(task, given, flags)


def read_solved(arguments: argparse.Namespace) -> CGCProblem:
    """Return the surface in a file; in a .3dm file with a result, the result.

    Raises
    ------
    CGCError
        If the file cannot be read.
    """
    read = read_input(arguments, result=True)
    echo = printer(arguments.quiet)
    for note in read.notes:
        echo(f"{arguments.input}: {note}")
    return with_laws(with_targets(read.checked(), arguments.target), arguments.law)


def build_and_write(
    arguments: argparse.Namespace, task: str, supports: Optional[str] = None, revised: Optional[Callable[[Any, dict], Any]] = None
) -> int:
    """Read the surface, run the task, print its report and write all outputs; `revised` changes the report before."""
    from ..fabrication.tasks import build
    from ..io.builds import build_suffix
    from ..io.builds import write_build

    for output in arguments.output:
        build_suffix(task, output)
    settings = settings_of(arguments, task)
    if hasattr(arguments, "curves"):
        settings = with_curves(settings, arguments)
    problem = read_solved(arguments)
    if supports:
        problem = problem.with_supports(supports)
    echo = printer(arguments.quiet)
    parts = Parts(1 + len(arguments.output), quiet=arguments.quiet)
    with parts.part(f"computing {task}"):
        report = build(task, problem, settings)
        report = report if revised is None else revised(report, settings)
    echo(str(report))
    written = []
    with published_together():
        for output in arguments.output:
            with parts.part(f"writing {output}"):
                written += write_build(output, task, problem, report, settings)
    echo("\n".join(f"wrote {path}" for path in written))
    return DONE
