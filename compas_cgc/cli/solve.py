"""``compas-cgc solve``: the main job on a file."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional

from ..errors import CGCError
from .exits import DONE
from .exits import INTERRUPTED
from .exits import NOT_CONVERGED
from .inputs import add_reading
from .inputs import reading
from .interrupt import interruptible
from .progress import ProgressBar

if TYPE_CHECKING:
    from ..analysis import SurfaceReport
    from ..datastructures import CGCMesh
    from ..model.result import SolveResult
    from ..model.result import SolveState
    from ..solvers.registry import Settings

EPILOG = """\
A .3dm file brings its supports as points and its creases as curves along mesh edges. The other formats hold a mesh only
(COMPAS .json everything): name the supports with --supports.

A surface that does not reach the tolerance is written beside OUTPUT as NAME.unfinished.SUFFIX; OUTPUT itself is only ever
replaced by a surface that does.

examples:
  compas-cgc solve roof.3dm -o roof_solved.3dm --target 0.03
  compas-cgc solve roof.3dm -o roof_solved.3dm --target 0.01 --target 4=0.04 --s 0.5
  compas-cgc solve plan.obj -o dome.obj --supports boundary --target 0.1
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command and its arguments."""
    parser = subparsers.add_parser(
        "solve",
        help="solve a mesh file",
        description="Read a mesh, give it the Gaussian curvature asked for in each region, and write it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("input", metavar="INPUT", help="a .3dm, .obj, .ply, .off, .stl or COMPAS .json file")
    parser.add_argument("-o", "--output", required=True, metavar="OUTPUT", help="the file to write, of any of these formats")
    parser.add_argument(
        "--target",
        action="append",
        default=[],
        metavar="[REGION=]K",
        help="Gaussian curvature in 1 / (model unit)², everywhere or in a region; may be given several times",
    )
    parser.add_argument("--supports", choices=("boundary", "corners"), help="fix the whole open edge or its corners, not the file's points")
    parser.add_argument("--flip", action="store_true", help="let the surface rise to the other side")
    parser.add_argument("--method", default="auto", help="auto (default), flow, newton or projection")
    strategy = parser.add_mutually_exclusive_group()
    strategy.add_argument("--s", type=float, metavar="S", help="by the flow, creases following by this factor, 0 to 1 (strategy S1)")
    strategy.add_argument("--delay", type=int, metavar="STEPS", help="by the flow, creases waiting for this many steps (strategy S2)")
    parser.add_argument("--steps", type=int, metavar="N", help="most steps of the method named with --method")
    parser.add_argument("--tolerance", type=float, metavar="T", help="tolerance of the method named with --method")
    parser.add_argument("--report", metavar="FILE", help="write what was done and reached as JSON")
    add_reading(parser)
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..analysis import analyse
    from ..io import read_mesh
    from ..io import write_mesh
    from ..io.rhino import constraints_of
    from ..solvers.solve import solve

    say = (lambda text: None) if arguments.quiet else print
    output = Path(arguments.output)
    settings = _settings(arguments)
    mesh, notes = read_mesh(arguments.input, **reading(arguments))
    for note in notes:
        say(f"{arguments.input}: {note}")
    if arguments.supports:
        mesh.set_supports(arguments.supports)
    if arguments.flip:
        mesh.flip()
    _set_targets(mesh, arguments.target)
    for problem in mesh.check():
        if not problem.fatal:
            say(f"note: {problem}")

    bar = ProgressBar()
    with interruptible() as wish:

        def callback(state: SolveState) -> bool:
            if not arguments.quiet:
                bar(state)
            return wish.is_set()

        try:
            result = solve(mesh, arguments.method, settings, callback, constraints_of(mesh))
        finally:
            bar.close()
    analysis = analyse(result.mesh, mesh)
    say(_summary(mesh, result, analysis))
    if arguments.report:
        from .._atomic_write import write_text

        write_text(arguments.report, json.dumps(_report(arguments, settings, result, analysis), indent=1, ensure_ascii=False) + "\n")
    kept = dict(result=result, source=arguments.input, settings=None if settings is None else settings.to_dict(), analysis=analysis)
    if result.converged:
        write_mesh(output, result.mesh, **kept)
        say(f"wrote {output}")
        return DONE
    print(f"compas-cgc: {result.message}", file=sys.stderr)
    if result.status in ("step_limit", "stalled", "cancelled"):
        unfinished = output.with_name(f"{output.stem}.unfinished{output.suffix}")
        write_mesh(unfinished, result.mesh, **kept)
        print(f"compas-cgc: the unfinished surface is in {unfinished}; {output} was not written", file=sys.stderr)
    return INTERRUPTED if result.status == "cancelled" else NOT_CONVERGED


def _settings(arguments: argparse.Namespace) -> Optional[Settings]:
    """Return the settings that the options make, or None where they leave all open."""
    from ..solvers.flow import FlowSettings
    from ..solvers.registry import SETTINGS

    chosen = {name: getattr(arguments, name) for name in ("s", "steps", "tolerance") if getattr(arguments, name) is not None}
    if arguments.delay is not None:
        chosen.update(e=arguments.delay, s=1.0)
    if not chosen:
        return None
    if arguments.method == "auto" and "s" not in chosen:
        raise CGCError("--steps and --tolerance belong to a method; name it with --method flow, newton or projection")
    kind = SETTINGS.get(arguments.method, FlowSettings)
    if "s" in chosen and kind is not FlowSettings:
        raise CGCError(f"--s and --delay are strategies of the flow, not of {arguments.method}; leave them out, or use --method flow")
    return replace(kind(), **chosen)


def _set_targets(mesh: CGCMesh, texts: Sequence[str]) -> None:
    """Set the targets of ``K`` and ``REGION=K``, those of regions last."""
    for text in sorted(texts, key=lambda text: "=" in text):
        region, equals, number = text.rpartition("=")
        try:
            K = float(number)
            where = int(region) if equals else None
        except ValueError:
            raise CGCError(f"--target must be a number or REGION=NUMBER, such as 0.03 or 4=0.03, not {text!r}") from None
        mesh.set_target(K, region=where)


def _summary(mesh: CGCMesh, result: SolveResult, analysis: SurfaceReport) -> str:
    roles = mesh.vertices_role()
    return "\n".join(
        [
            f"{len(roles)} vertices, {mesh.number_of_faces()} faces, {roles.count('fixed')} supports, {len(mesh.creases())} creases",
            f"{result.message} ({result.seconds:.2f} s)",
            str(analysis),
        ]
    )


def _report(arguments: argparse.Namespace, settings: Optional[Settings], result: SolveResult, analysis: SurfaceReport) -> dict:
    from .._version import __version__

    return {
        "version": __version__,
        "input": Path(arguments.input).name,
        "method": result.method,
        "settings": None if settings is None else settings.to_dict(),
        "status": result.status,
        "message": result.message,
        "steps": result.iterations,
        "seconds": result.seconds,
        **analysis.to_dict(),
        "history": result.history.to_dict(),
    }
