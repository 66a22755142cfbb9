"""``compas-cgc solve``: solve a file."""

from __future__ import annotations

import argparse
import json
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Callable
from typing import Optional
from typing import cast

from .._atomic_write import PartlyPublished
from .._atomic_write import further_outputs
from .._atomic_write import published_together
from ..errors import FileError
from ..errors import MeshError
from ..io.formats import FORMATS
from .arguments import add_input
from .arguments import add_options
from .arguments import add_reading
from .arguments import add_supports
from .arguments import read_input
from .arguments import settings_of
from .arguments import with_laws
from .arguments import with_targets
from .console import Parts
from .console import ProgressBar
from .console import interruptible
from .console import printer
from .elsewhere import save_elsewhere
from .elsewhere import unfinished
from .exits import DONE
from .exits import INCOMPLETE
from .exits import INTERRUPTED
from .exits import NOT_CONVERGED
from .exits import REFUSED
from .exits import ROUGH
from .goals import add_goals
from .goals import goals_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..analysis import SurfaceReport
    from ..datastructures import SolveResult
    from ..model.problem import CGCProblem
    from ..model.result import SolveState
    from ..solvers import Settings

__all__ = ["add_arguments", "run"]

PICTURE_WIDTH = 1000  # pixels; the time of shading grows with the area

MESH_SUFFIX = ".obj"  # of a mesh whose smooth surfaces are refused
UNFINISHED = ("step_limit", "stalled", "cancelled")  # statuses whose surface is worth keeping
PICTURES = ("regions", "K", "zebra")

_EPILOG = """\
A .3dm file contains supports as points and creases as curves. If a file contains no supports, use --supports.

The first word of the result is the verdict: fair (smooth) or rough. A rough surface is written too, and the exit code is 3. A surface
that does not reach the tolerance is written to NAME.unfinished.SUFFIX beside OUTPUT, and so are its report and its picture; the files of
an earlier solve are not replaced.

examples:
  compas-cgc solve roof.3dm -o roof_solved.3dm --target 0.03
  compas-cgc solve roof.3dm -o roof_solved.3dm --target 0.01 --target 4=0.04 --s 0.5
  compas-cgc solve plan.obj -o dome.obj --supports boundary --target 0.1
  compas-cgc solve roof.3dm -o roof_solved.3dm --target 0.01 --law 1=minimal --law "2=H = 0.05"
  compas-cgc solve roof.3dm -o roof_solved.3dm --picture roof.png --picture-of zebra
  compas-cgc solve roof.3dm -o roof_solved.3dm --rise 4 --above 2.5@gate --unknown all
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Compute the surface that has the target Gaussian curvature in each region, and write it to a file."
    parser.epilog = _EPILOG
    add_input(parser)
    parser.add_argument("-o", "--output", required=True, metavar="OUTPUT", help="file to write, in any of these formats")
    parser.add_argument(
        "--target",
        action="append",
        default=[],
        metavar="[REGION=]K",
        help="target Gaussian curvature in 1 / (model unit)², everywhere or in a region; repeatable",
    )
    parser.add_argument(
        "--law",
        action="append",
        default=[],
        metavar="[REGION=]LAW",
        help="law of the mean curvature H and the Gaussian curvature K, everywhere or in a region: minimal, 'H = 0.1' or "
        "'2 H + 0.5 K = 0.3'; H > 0 bulges to the side of the normals; repeatable",
    )
    add_supports(parser)
    parser.add_argument("--flip", action="store_true", help="reverse the normals, so that the surface rises to the other side")
    parser.add_argument("--report", metavar="FILE", help="write the report as JSON")
    parser.add_argument("--picture", metavar="FILE", help="draw the surface as .png, .svg or .pdf; needs the extra 'plot'")
    parser.add_argument(
        "--picture-of",
        choices=PICTURES,
        default="regions",
        help="show regions, K in colours, or the reflection of zebra stripes",
    )
    parser.add_argument("--nurbs", action="store_true", help="fit a NURBS surface to each region, on the layer CGC::NURBS of a .3dm file")
    parser.add_argument("-q", "--quiet", action="store_true", help="print errors only")
    add_goals(parser)
    add_options(parser)
    add_reading(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..analysis import analyse
    from ..io import known_suffix
    from ..model.result import FAILED

    # Detect an invalid output before the solve.
    if known_suffix(arguments.output) != ".3dm" and arguments.nurbs:
        raise FileError(f"--nurbs requires a .3dm output file, not {arguments.output}")
    echo = printer(arguments.quiet)
    draw = _picture(arguments)
    settings = settings_of(arguments)
    read = read_input(arguments)
    for note in read.notes:
        echo(f"{arguments.input}: {note}")
    problem = _with_arguments(read.checked(), arguments)
    result = _solve(problem, arguments, settings)
    for remark in result.remarks:
        echo(f"note: {remark}")
    parts = Parts(4, quiet=arguments.quiet)
    with parts.part("measuring the surface"):
        analysis = analyse(result, problem)
    echo(_summary(result, analysis))
    change = None
    if arguments.sensitivity and result.converged:
        from ..solvers.sensitivity import sensitivity

        with parts.part("computing the sensitivity"):
            change = sensitivity(result)
        for sentence in change.sentences():
            echo(sentence)
    incomplete: Optional[PartlyPublished] = None
    code = DONE
    lines: list[str] = []
    try:
        # The surface comes first: if it cannot be written, no other output is.
        with published_together():
            code, lines, surface = _write_surface(arguments, result, analysis, parts)
            if draw is not None and result.status not in FAILED:
                with parts.part("drawing the picture"), further_outputs():
                    lines.append(f"wrote {draw(result)}")
            if arguments.report:
                with further_outputs():
                    more = {} if change is None else {"sensitivity": change.to_dict()}
                    _write_report(arguments, result, analysis, {"surface": surface and surface.name, **more})
    except PartlyPublished as error:
        incomplete = error
    except FileError as error:
        return _save_elsewhere(arguments, result, analysis, error)
    for line in lines:
        echo(line)
    if incomplete is not None:
        print(f"compas-cgc: {incomplete}", file=sys.stderr)
    return INCOMPLETE if incomplete is not None and code in (DONE, ROUGH) else code


def _picture(arguments: argparse.Namespace) -> Optional[Callable[[SolveResult], Path]]:
    """Return a function that draws the requested picture; report an invalid file name before the solve."""
    if not arguments.picture:
        return None
    from .._figures import check_picture

    check_picture(arguments.picture)
    return partial(_draw, Path(arguments.picture), arguments.picture_of)


def _draw(picture: Path, of: str, result: SolveResult) -> Path:
    """Draw a result and return the path of the picture."""
    from ..plot import draw_zebra
    from ..plot import key_of
    from ..plot import save
    from ..plot import studio

    path = _named(picture, result)
    problem = result.problem
    shape = (problem.vertices, problem.faces, problem.roles, problem.creases)
    key = key_of(problem)
    if of == "zebra":
        return save(cast("Figure", draw_zebra(*shape, key=key).figure), path)
    return save(studio(*shape, curvature=result.curvature if of == "K" else None, width=PICTURE_WIDTH, key=key), path)


def _with_arguments(problem: CGCProblem, arguments: argparse.Namespace) -> CGCProblem:
    """Return the problem with the supports, targets and goals of the arguments."""
    if arguments.supports:
        problem = problem.with_supports(arguments.supports)
    if arguments.flip:
        problem = problem.flipped()
    problem = with_laws(with_targets(problem, arguments.target), arguments.law)
    return problem.with_goals(goals_of(arguments, dict(problem.drawing.places), problem.drawing.units))


def _solve(problem: CGCProblem, arguments: argparse.Namespace, settings: Optional[Settings]) -> SolveResult:
    """Solve with progress on the terminal; Ctrl-C stops at the next step."""
    from ..solvers.run import solve

    bar = ProgressBar()
    with interruptible() as cancelled:

        def callback(state: SolveState) -> bool:
            if not arguments.quiet:
                bar(state)
            return cancelled.is_set()

        try:
            return solve(problem, method=arguments.method, settings=settings, callback=callback)
        finally:
            bar.close()


def _summary(result: SolveResult, analysis: SurfaceReport) -> str:
    problem = result.problem
    counts = f"{len(problem.vertices)} vertices, {len(problem.faces)} faces, {len(problem.supports)} supports"
    creases = len(problem.crease_paths())
    figures = str(analysis).split("\n", 1)[1]
    return f"{result.summary}\n{counts}, {creases} creases\n{result.ending} ({result.seconds:.2f} s)\n{figures}"


def _write_report(arguments: argparse.Namespace, result: SolveResult, analysis: SurfaceReport, more: dict) -> None:
    from .._atomic_write import replacing
    from .._version import __version__

    path = _named(Path(arguments.report), result)
    report = {"version": __version__, "input": Path(arguments.input).name, **result.to_dict(), **analysis.to_dict(), **more}
    with replacing(path) as temporary:
        temporary.write_bytes((json.dumps(report, indent=1, ensure_ascii=False) + "\n").encode("utf-8"))


def _write_surface(
    arguments: argparse.Namespace, result: SolveResult, analysis: SurfaceReport, parts: Parts
) -> tuple[int, list[str], Optional[Path]]:
    """Write the surface; return the exit code, what to print when it is in its place, and the file, None without a surface.

    An unfinished surface gets a name of its own.
    """
    from ..io import write

    output = Path(arguments.output)
    if result.converged:
        with parts.part(f"writing {output}"):
            try:
                notes = write(output, result, source=arguments.input, analysis=analysis, nurbs=arguments.nurbs)
            except MeshError as error:
                print(f"compas-cgc: {error}", file=sys.stderr)
                mesh = output.with_suffix(MESH_SUFFIX)
                write(mesh, result)
                return INCOMPLETE, [f"wrote the mesh to {mesh} instead of {output}"], mesh
        if not analysis.verdict.fair:
            print(f"compas-cgc: K meets its target, but the surface is {analysis.verdict}", file=sys.stderr)
        return (DONE if analysis.verdict.fair else ROUGH), [*notes, f"wrote {output}"], output
    print(f"compas-cgc: {result.message}", file=sys.stderr)
    unfinished = _named(_mesh_file(output), result) if result.status in UNFINISHED else None
    if unfinished is not None:
        write(unfinished, result, source=arguments.input, analysis=analysis)
        print(f"compas-cgc: wrote the unfinished surface to {unfinished}; {output} is unchanged", file=sys.stderr)
    return (INTERRUPTED if result.status == "cancelled" else NOT_CONVERGED), [], unfinished


def _named(path: Path, result: SolveResult) -> Path:
    """Return the path of an output, with a name of its own if the solve is unfinished, so that no output mixes with those of another."""
    return path if result.converged else unfinished(path)


def _mesh_file(output: Path) -> Path:
    """Return the path of an output with the format of a mesh instead of one of smooth surfaces."""
    return output.with_suffix(MESH_SUFFIX) if FORMATS[output.suffix.lower()].surfaces else output


def _save_elsewhere(arguments: argparse.Namespace, result: SolveResult, analysis: SurfaceReport, error: FileError) -> int:
    """Save a surface that cannot be written to its place, and return the exit code."""
    from ..io import write

    print(f"compas-cgc: {error}", file=sys.stderr)
    if not (result.converged or result.status in UNFINISHED):
        return NOT_CONVERGED
    output = Path(arguments.output)
    output = output if result.converged else _named(_mesh_file(output), result)
    save_elsewhere(output.name, lambda path: write(path, result, source=arguments.input, analysis=analysis))
    return REFUSED
