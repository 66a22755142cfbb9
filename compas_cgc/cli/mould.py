"""``compas-cgc mould``: divide a solved surface into panels and lay them on moulds."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional

from .._atomic_write import published_together
from .._atomic_write import write_text
from ..errors import CGCError
from ..errors import FileError
from ..io.formats import OUTPUTS
from ..io.formats import listed
from .building import JOINTS
from .building import add_joints
from .building import add_task
from .building import read_solved
from .building import settings_of
from .building import with_curves
from .console import Parts
from .console import printer
from .exits import DONE
from .exits import ROUGH

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..fabrication import MouldReport
    from ..model.problem import CGCProblem

__all__ = ["add_arguments", "run"]

_EPILOG = """\
FILE is a solved surface. If a .3dm file contains a result, the result is used. Solve with --measure exact to make regions and moulds
consist of the same triangles; otherwise the report states the gaps between them.

OUTPUT is a .3dm file with the layers CGC Moulds::Moulds, Outlines, Panels on moulds, Panels in place and Labels, or a .step file with the
moulds, the panels on them and the panels in place as named faces. Moulds are exact surfaces in both. An .ifc file (IFC 4) holds the roof
and its panels as plates with class, K, mould radius, area and course. Repeat -o to write several files. A page of pictures is written
beside the first one, with the suffix .pdf. --schedule writes the lengths of sides, diagonals and neighbours of every panel.

If panels would be bent beyond the strength of the material, the report begins with them, and the exit code is 3; the files are written.

examples:
  compas-cgc solve roof.3dm -o solved.3dm --measure exact
  compas-cgc mould solved.3dm -o moulds.3dm --size 1.25 --schedule panels.csv --schedule panels.pdf
  compas-cgc mould solved.3dm -o moulds.3dm --curves Joints --material gfrp --thickness 8 --report moulds.json
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_task(parser, "mould", leave=JOINTS)
    parser.epilog = _EPILOG
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUTPUT", action="append", help=f"{listed(OUTPUTS['mould'])} file to write; repeatable"
    )
    add_joints(parser, required=True)
    parser.add_argument("--no-page", action="store_true", help="do not write the page of pictures")
    parser.add_argument(
        "--schedule",
        action="append",
        default=[],
        metavar="FILE",
        help="write the panel schedule: .csv, or .pdf with one drawing per panel; repeatable",
    )
    parser.add_argument("--report", metavar="JSON", help="write the figures of every panel as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..fabrication.tasks import build
    from ..io.builds import build_suffix
    from ..io.builds import write_mould_files

    outputs = [Path(output) for output in arguments.output]
    for output in outputs:
        build_suffix("mould", output)
    for path in arguments.schedule:
        if Path(path).suffix.lower() not in (".csv", ".pdf"):
            raise FileError(f"the schedule must be a .csv or .pdf file, not {Path(path).name!r}")
    page_path = outputs[0].with_suffix(".pdf")
    if not arguments.no_page and page_path in map(Path, arguments.schedule):
        raise FileError(f"the page of pictures is {page_path}; give the schedule another name, or use --no-page")
    echo = printer(arguments.quiet)
    settings = settings_of(arguments, "mould")
    problem = read_solved(arguments)
    settings = with_curves(settings, arguments)
    parts = Parts(3, quiet=arguments.quiet)
    with parts.part("fitting panels to moulds"):
        report = build("mould", problem, settings)
    echo(str(report))
    with parts.part("drawing the page"):
        page = _drawn(problem, report, arguments)
    source = arguments.input if Path(arguments.input).suffix.lower() == ".3dm" else None
    notes, written = list[str](), list[Path]()
    with published_together(), parts.part(f"writing {', '.join(map(str, outputs))}"):
        for output in outputs:
            notes += [f"{output}: {note}" for note in write_mould_files(output, problem, report, source)]
            written.append(output)
        if page is not None:
            from ..plot import save

            written.append(save(page, page_path))
        written += [_write_schedule(Path(path), problem, report, Path(arguments.input).stem) for path in arguments.schedule]
        if arguments.report:
            written.append(_write_report(arguments, report))
    for note in notes:
        echo(note)
    for path in written:
        echo(f"wrote {path}")
    return ROUGH if report.overstressed else DONE


def _drawn(problem: CGCProblem, report: MouldReport, arguments: argparse.Namespace) -> Optional[Figure]:
    """Return the page of pictures; draw it before any file is written."""
    if arguments.no_page:
        return None
    try:
        from ..plot import moulds_figure

        return moulds_figure(problem, report, f"{Path(arguments.input).stem}: moulds")
    except CGCError as error:
        raise CGCError(f"{error}; or use --no-page to write no page of pictures") from None


def _write_schedule(path: Path, problem: CGCProblem, report: MouldReport, name: str) -> Path:
    from ..fabrication.panel_schedule import panel_sheets
    from ..fabrication.panel_schedule import schedule_text

    sheets = panel_sheets(problem, report)
    if path.suffix.lower() == ".pdf":
        from ..plot.panel_sheets import save_panel_sheets

        return save_panel_sheets(sheets, path, f"{name}, {report.thickness:g} mm {report.material.title}:", problem.drawing.north)
    write_text(path, schedule_text(sheets))
    return path


def _write_report(arguments: argparse.Namespace, report: MouldReport) -> Path:
    from .._version import __version__

    record = {"version": __version__, "input": Path(arguments.input).name, **report.to_dict()}
    write_text(arguments.report, json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    return Path(arguments.report)
