"""``compas-cgc rationalise``: from a freeform design to panels on a handful of moulds."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional
from typing import Union

from .._atomic_write import PartlyPublished
from .._atomic_write import further_outputs
from .._atomic_write import published_together
from ..errors import CGCError
from ..errors import FileError
from .console import bar
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

if TYPE_CHECKING:
    from ..rationalisation import Rationalised
    from ..rationalisation.design import Design
    from ..rationalisation.mould_sweep import Sweep
    from ..rationalisation.run import Progress
    from ..rationalisation.seams import SeamsInput

__all__ = ["add_arguments", "run"]

_EPILOG = """\
DESIGN is a mesh file, or a .3dm file with a NURBS surface, polysurface, SubD or mesh. If the file contains several of these, put the
design on a layer Design. Points or curves on a layer Supports are held.

OUT is a .3dm file with the solved surface and the layers CGC Rationalised::Moulds, Seams and Distance. Every panel is a region of this
surface: compas-cgc mould OUT -o moulds.3dm --count 1 lays the panels onto their moulds. With --nurbs, the file also contains each panel as
a four-sided patch; the sides of adjacent patches coincide. If OUT is a .step file, it contains the panels as trimmed faces of one shell.

exit codes: 0 done; 1 the distance of --within is exceeded, or the surface did not converge; 3 the surface is rough; 4 the report or the
sweep could not be written

examples:
  compas-cgc rationalise roof.3dm -o panels.3dm --panel 2.5 --moulds 4
  compas-cgc rationalise roof.3dm -o panels.3dm --panel 2.5 --within 30mm --report panels.json
  compas-cgc rationalise roof.3dm -o panels.3dm --panel 2.5 --radii 12 30 -25 inf
  compas-cgc rationalise roof.3dm -o again.3dm --panel 2.5 --keep panels.json --locked 12 13
  compas-cgc rationalise roof.3dm -o cheap.3dm --within 30mm --cost flat 0 200 --cost sphere 8000 450 --cost saddle 12000 600
"""

NAMED = ("grid", "curvature", "geodesics", "levels", "faces")  # seams that need no curves


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = "Find the surface with panels from few moulds that is nearest to a freeform design."
    parser.epilog = _EPILOG
    parser.add_argument("input", metavar="DESIGN", help="a .3dm, .step, .obj, .ply, .off, .stl or COMPAS .json file")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="the file to write, a .3dm for panels, seams and distances")
    parser.add_argument("--panel", metavar="L", help="width of the panels, such as 2.5 or 2500mm (default: a twelfth of the longer side)")
    parser.add_argument(
        "--seams",
        metavar="WHERE",
        help="grid, curvature or geodesics (lines one panel apart), levels (of K, for few regions), faces (of a quad mesh), a layer of "
        "DESIGN, or a .3dm with curves "
        "(default: the layer Seams, or grid)",
    )
    moulds = parser.add_mutually_exclusive_group()
    moulds.add_argument(
        "--moulds", type=int, metavar="N", help="number of moulds (default: 4; with --within, the fewest for this distance)"
    )
    moulds.add_argument(
        "--radii", nargs="+", metavar="R", help="radii of existing moulds, such as 12 or 12000mm: spheres > 0, saddles < 0, inf for flat"
    )
    moulds.add_argument("--keep", metavar="JSON", help="the report of an earlier run, whose moulds are kept")
    parser.add_argument(
        "--locked", type=int, nargs="+", metavar="N", help="numbers of panels that keep the mould they have in the report given by --keep"
    )
    parser.add_argument("--within", metavar="D", help="largest distance from the design, such as 0.03 or 30mm")
    parser.add_argument(
        "--flat",
        action=argparse.BooleanOptionalAction,
        help="whether one of the moulds is flat (default: the choice with the smaller distance)",
    )
    parser.add_argument("--supports", choices=("corners", "boundary", "none"), help="what is held (default: that of the file, or corners)")
    parser.add_argument("--edges", type=int, metavar="N", help="edges of the mesh along the side of a panel (default: 4 or more)")
    parser.add_argument("--tolerance", metavar="D", help="largest distance of a smooth surface fitted to a mesh (default: the file's)")
    parser.add_argument(
        "--cost",
        action="append",
        nargs=3,
        metavar=("KIND", "MOULD", "PANEL"),
        help="cost of a mould of this kind and of a panel made on it; give it for flat, sphere and saddle; with --within, the cheapest "
        "surface is found",
    )
    parser.add_argument(
        "--weight",
        action="append",
        nargs=5,
        metavar=("X", "Y", "Z", "RADIUS", "FACTOR"),
        help="count distances within a radius of a point FACTOR times, such as 8 0 2.5 3m 4; can be repeated",
    )
    parser.add_argument("--report", metavar="JSON", help="write moulds, distances, folds, and the accuracy of smooth surfaces as JSON")
    parser.add_argument("--sweep", type=int, nargs="*", metavar="N", help="write distances for these numbers of moulds to OUT.csv and .png")
    parser.add_argument("--nurbs", action="store_true", help="fit a NURBS surface to each panel, on the layer CGC::NURBS of a .3dm file")
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from ..io import known_suffix
    from ..rationalisation import rationalise
    from ..rationalisation.design import given_design

    if known_suffix(arguments.output) != ".3dm" and arguments.nurbs:
        raise FileError(f"--nurbs requires a .3dm output file, not {arguments.output}")
    echo = printer(arguments.quiet)
    own = arguments.seams
    layer = own if own not in (None, *NAMED) and Path(own).suffix.lower() != ".3dm" else None
    given = given_design(arguments.input, seams=layer)
    units = given.drawing.units
    options = _options(arguments, units)
    radii, locked = _kept(arguments, units)
    moulds: Union[int, Sequence[float], None] = radii or arguments.moulds
    if moulds is None and options["within"] is None:
        moulds = 4
    line = _Line(arguments.quiet)
    with interruptible() as cancelled:

        def watch(state: Progress) -> bool:
            line(state)
            return cancelled.is_set()

        try:
            found = rationalise(
                given,
                moulds=moulds,
                tolerance=_length(arguments.tolerance, units, "--tolerance"),
                locked=locked,
                **options,
                callback=watch,
            )
        finally:
            line.close()
    for note in found.design.notes:
        echo(f"{arguments.input}: {note}")
    echo(found.summary)
    incomplete: Optional[PartlyPublished] = None
    lines: list[str] = []
    interrupted = found.cancelled
    try:
        interrupted |= _write(arguments, found, options, lines)
    except PartlyPublished as error:
        incomplete = error
    except FileError as error:
        print(f"compas-cgc: {error}", file=sys.stderr)
        save_elsewhere(_named(arguments.output, found).name, lambda path: _write_surface(path, arguments, found))
        return REFUSED
    for text in lines:
        echo(text)
    code = INTERRUPTED if interrupted else _code(found)
    if incomplete is not None:
        print(f"compas-cgc: {incomplete}", file=sys.stderr)
    return INCOMPLETE if incomplete is not None and code in (DONE, ROUGH) else code


def _code(found: Rationalised) -> int:
    if not found.kept:
        return NOT_CONVERGED
    return DONE if found.result.verdict is None or found.result.verdict.fair else ROUGH


def _options(arguments: argparse.Namespace, units: Optional[str]) -> dict[str, Any]:
    """Return the options that the surface and its sweep share."""
    return {
        "panel": _length(arguments.panel, units, "--panel"),
        "seams": _seams(arguments.seams),
        "within": _length(arguments.within, units, "--within"),
        "flat": arguments.flat,
        "supports": arguments.supports,
        "edges": arguments.edges,
        "costs": _costs(arguments.cost),
        "weights": [_weight(row, units) for row in arguments.weight or ()],
    }


def _weight(row: Sequence[str], units: Optional[str]) -> list[float]:
    """Return the place, radius and factor of a weight."""
    *lengths, factor = row
    try:
        return [*(signed_length(text, units, "--weight") for text in lengths), float(factor)]
    except ValueError:
        raise CGCError(f"--weight needs a factor without a unit as its last number, not {factor!r:.60}") from None


def _costs(given: Optional[list[list[str]]]) -> Optional[dict[str, tuple[float, float]]]:
    """Return the costs of moulds and panels by kind."""
    if given is None:
        return None
    if len({kind for kind, _, _ in given}) < len(given):
        raise CGCError("--cost is given twice for one kind of mould; give it once each for flat, sphere and saddle")
    try:
        return {kind: (float(mould), float(panel)) for kind, mould, panel in given}
    except ValueError:
        raise CGCError("--cost needs a kind of mould and two numbers, such as --cost sphere 8000 450") from None


def _seams(where: Optional[str]) -> SeamsInput:
    """Return the seams of the argument; those on a layer of the design are read with it."""
    if where in NAMED:
        return where
    if where is None or Path(where).suffix.lower() != ".3dm":
        return None
    from ..io.rhino.designs import read_all_curves

    return [line.tolist() for line in read_all_curves(where)]


def _kept(arguments: argparse.Namespace, units: Optional[str]) -> tuple[list[float], Optional[dict[int, int]]]:
    """Return the radii of existing moulds, and the moulds of locked panels, both of an earlier report where one is given."""
    if arguments.keep is None:
        if arguments.locked is not None:
            raise CGCError("--locked needs --keep JSON, the report of the run in which these panels have their moulds")
        radii = arguments.radii or ()
        return [math.inf if text.casefold() == "inf" else signed_length(text, units, "--radii") for text in radii], None
    try:
        record = json.loads(Path(arguments.keep).read_text(encoding="utf-8"))
        radii = [math.inf if own is None else float(own) for own in record["radii"]]
        classes = [int(own) for own in record["classes"]]
    except (OSError, ValueError, TypeError, KeyError):
        raise FileError(f"{arguments.keep} is no report of compas-cgc rationalise; write one with --report JSON") from None
    wrong = [own for own in arguments.locked or () if not 0 <= own < len(classes)]
    if wrong:
        raise CGCError(f"{arguments.keep} has panels 0 to {len(classes) - 1}, not {', '.join(map(str, wrong))}; see --locked")
    return radii, {own: classes[own] for own in arguments.locked or ()}


def signed_length(text: str, units: Optional[str], name: str) -> float:
    """Return a length in the units of a drawing, from a number with or without a unit.

    Raises
    ------
    CGCError
        If it is not understood.
    """
    from ..model.units import length_of
    from ..model.units import within

    return within(length_of(text, name), units)


def length(text: str, units: Optional[str], name: str) -> float:
    """Return a length above zero in the units of a drawing, from a number with or without a unit.

    Raises
    ------
    CGCError
        If it is not understood.
    """
    value = signed_length(text, units, name)
    if not value > 0.0:
        raise CGCError(f"{name} must be a length above zero, such as 0.03 or 30mm, not {text!r}")
    return value


def _length(text: Optional[str], units: Optional[str], name: str) -> Optional[float]:
    return None if text is None else length(text, units, name)


def _write(arguments: argparse.Namespace, found: Rationalised, options: dict[str, Any], lines: list[str]) -> bool:
    """Write the surface, the report and the sweep, add notes on them to `lines`, and return whether the sweep was interrupted.

    Raises
    ------
    PartlyPublished
        If the report or the sweep cannot be written; the surface is.
    """
    from .._atomic_write import write_text

    output, interrupted = _named(arguments.output, found), False
    with published_together():
        notes = _write_surface(output, arguments, found)
        lines += [*(f"{output}: {note}" for note in notes), f"wrote {output}"]
        if arguments.report:
            from ..fabrication.shell.fit import AccuracyNote

            record = {
                **_record(arguments, found),
                "files": notes,
                "surfaces": [own.figures for own in notes if isinstance(own, AccuracyNote)],
            }
            with further_outputs():
                report = _named(arguments.report, found)
                write_text(report, json.dumps(record, indent=1, ensure_ascii=False) + "\n")
                lines.append(f"wrote {report}")
        if arguments.sweep is not None and not found.cancelled:
            with further_outputs():
                swept = _sweep(arguments, found.design, options)
                interrupted = swept.results[-1].cancelled
                lines += [str(swept), *(f"wrote {path}" for path in _write_sweep(output, swept))]
    return interrupted


def _named(path: str, found: Rationalised) -> Path:
    """Return the path of an output, with a name of its own if the search was interrupted."""
    return unfinished(Path(path)) if found.cancelled else Path(path)


def _write_surface(path: Path, arguments: argparse.Namespace, found: Rationalised) -> list[str]:
    """Write the surface, with its panels to a .3dm file, and return notes on smooth surfaces."""
    from ..io import write

    if path.suffix.lower() != ".3dm":
        return write(path, found.result)
    from ..rationalisation.files import write_rationalised

    source = arguments.input if Path(arguments.input).suffix.lower() == ".3dm" else None
    return write_rationalised(path, found, _record(arguments, found), source, arguments.nurbs)


def _record(arguments: argparse.Namespace, found: Rationalised) -> dict[str, Any]:
    from .._version import __version__

    return {"version": __version__, "input": Path(arguments.input).name, **found.to_dict()}


def _sweep(arguments: argparse.Namespace, design: Design, options: dict[str, Any]) -> Sweep:
    """Return the rationalisations of a design with several numbers of moulds; Ctrl-C ends it with those that are done."""
    from ..rationalisation import sweep
    from ..rationalisation.mould_sweep import MOULDS

    with interruptible() as cancelled:
        return sweep(design, arguments.sweep or MOULDS, callback=lambda state: cancelled.is_set(), **options)


def _write_sweep(output: Path, swept: Sweep) -> list[Path]:
    """Write a table and a picture of the distances beside an output."""
    from .._atomic_write import write_text
    from ..plot import save

    rows = swept.rows()
    table = "\n".join([",".join(rows[0]), *(",".join(str(value) for value in row.values()) for row in rows)]) + "\n"
    write_text(output.with_suffix(".csv"), table)
    return [output.with_suffix(".csv"), save(swept.figure(), output.with_suffix(".png"))]


class _Line:
    """Progress on one line of a terminal."""

    def __init__(self, quiet: bool):
        self.quiet = quiet or not sys.stderr.isatty()
        self.width = 0

    def __call__(self, state: Progress) -> None:
        """Show a state."""
        if self.quiet:
            return
        text = f"{bar(state.done / max(state.rounds, 1))} round {state.done} of at most {state.rounds}, distance {state.distance:.3g}"
        sys.stderr.write("\r" + text.ljust(self.width))
        sys.stderr.flush()
        self.width = len(text)

    def close(self) -> None:
        """Take the line away again."""
        if self.width:
            sys.stderr.write("\r" + " " * self.width + "\r")
            sys.stderr.flush()
            self.width = 0
