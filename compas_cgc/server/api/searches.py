"""Tasks of the server that solve: the largest curvature of a drawing, and a freeform design on few moulds."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Callable
from typing import NamedTuple
from typing import Union

from ...errors import CGCError
from ...execution.worker import report
from ...execution.worker import stop_wanted
from ...fabrication import option_values as values
from ...fabrication.plain_data import plain
from ...fabrication.tasks import BuildOption
from ...model.problem import CGCProblem
from ...rationalisation.costs import KINDS
from ...rationalisation.costs import costs_of

if TYPE_CHECKING:
    from ...rationalisation.design import GivenDesign

__all__ = ["MAX_PLACES", "SEARCHES", "Found", "Search"]

MAX_PLACES = 1000  # largest number of places with weights

SEAMS = ("grid", "curvature", "geodesics", "levels", "faces")
SUPPORTS = ("corners", "boundary", "none")
_LENGTH = {"type": "number", "exclusiveMinimum": 0, "maximum": values.LARGEST}
_PAIR = {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number", "minimum": 0}}
_PLACE = {"type": "array", "minItems": 5, "maxItems": 5, "items": {"type": "number"}}
_CURVE = {"type": "array", "minItems": 2, "items": {"type": "array", "minItems": 3, "maxItems": 3, "items": {"type": "number"}}}


class Found(NamedTuple):
    """Result of a search."""

    message: str
    data: dict  # ready for JSON
    files: Mapping[str, bytes] = {}  # by format
    notes: Sequence[str] = ()  # on the drawing or design


class Search(NamedTuple):
    """Task on a drawing or a design that has not been solved."""

    name: str
    text: str
    options: tuple[BuildOption, ...]
    formats: tuple[str, ...]  # besides arrays
    run: Callable[[Any, Mapping[str, Any]], Found]  # of a CGCProblem, or of a design
    of_designs: bool = False  # whether files are read as designs


def _share(value: object, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < 1.0:
        raise CGCError(f"{name} must be between 0 and 1, not {value!r:.60}")
    return float(value)


def _one_of(names: tuple[str, ...]) -> Callable[[object, str], str]:
    def read(value: object, name: str) -> str:
        if value not in names:
            raise CGCError(f"{name} must be one of {', '.join(names)}, not {value!r:.60}")
        return str(value)

    return read


def _seams(value: object, name: str) -> Union[str, list[list[list[float]]]]:
    """Return the name of a layout of seams, or points along curves."""
    if isinstance(value, str):
        return _one_of(SEAMS)(value, name)
    lines = [values.points(line, f"every curve of {name}") for line in value] if isinstance(value, (list, tuple)) else []
    if not lines or any(isinstance(line, str) or len(line) < 2 for line in lines):
        raise CGCError(f"{name} must be one of {', '.join(SEAMS)}, or curves of two points (x, y, z) or more, not {value!r:.60}")
    return [line for line in lines if not isinstance(line, str)]


def _radii(value: object, name: str) -> list[float]:
    """Return radii of moulds; null is flat."""
    if not isinstance(value, (list, tuple)) or not value:
        raise CGCError(f"{name} must be a list of radii of moulds, with null for a flat one, not {value!r:.60}")
    return [math.inf if own is None else values.number(own, f"every radius of {name}") for own in value]


def _locked(value: object, name: str) -> dict[int, int]:
    """Return moulds of panels by the numbers of the panels, which are texts in JSON."""
    if not isinstance(value, Mapping):
        raise CGCError(f"{name} must be an object of panels and their moulds, such as {{'12': 0}}, not {value!r:.60}")
    return {values.whole(panel, f"every panel of {name}"): values.whole(mould, f"every mould of {name}") for panel, mould in value.items()}


def _costs(value: object, name: str) -> dict[str, list[float]]:
    """Return pairs of costs, of a mould and of a panel, by kinds of moulds."""
    if not isinstance(value, Mapping):
        raise CGCError(f"{name} must be an object of kinds of moulds, such as {{'sphere': [8000, 450]}}, not {value!r:.60}")
    found = {str(kind): _row(own, f"the costs of {kind}", 2) for kind, own in value.items()}
    costs_of(found)  # before the job is accepted
    return found


def _weights(value: object, name: str) -> list[list[float]]:
    """Return rows of places, radii and factors."""
    if not isinstance(value, (list, tuple)):
        raise CGCError(f"{name} must be a list of rows x, y, z, radius, factor, not {value!r:.60}")
    if len(value) > MAX_PLACES:
        raise CGCError(f"{name} has {len(value)} rows; give at most {MAX_PLACES}")
    return [_row(own, f"every row of {name}", 5) for own in value]


def _row(value: object, name: str, length: int) -> list[float]:
    if not isinstance(value, (list, tuple)) or len(value) != length:
        raise CGCError(f"{name} must be a list of {length} numbers, not {value!r:.60}")
    return [values.number(own, name) for own in value]


def _limits(problem: CGCProblem, settings: Mapping[str, Any]) -> Found:
    from ...solvers.limits import largest_target

    limit = largest_target(problem, **settings)
    return Found(limit.message, {**limit.to_dict(), "text": limit.message})


def _rationalised(design: Union[CGCProblem, GivenDesign], settings: Mapping[str, Any]) -> Found:
    from ...rationalisation import rationalise
    from ...rationalisation.files import write_rationalised
    from ...rationalisation.run import Progress

    def watch(state: Progress) -> bool:
        report({"task": "rationalise", "stage": "assign", "step": state.done, "steps": state.rounds, "distance": state.distance})
        return stop_wanted()

    given = {"moulds": None if "within" in settings else 4, **settings}
    if "radii" in given:
        if "moulds" in settings:
            raise CGCError("moulds is a number of moulds and radii are those of moulds that exist; give one of them")
        given["moulds"] = given.pop("radii")
    found = rationalise(design, callback=watch, **given)
    arrays = {
        "vertices": found.result.vertices,
        "faces": found.result.problem.faces,
        "panel_of_face": found.panels,
        "distances": found.distance.signed,  # at vertices [L]
        "seams": found.panelling.seams,
        "supports": found.result.problem.supports,
    }
    record = plain(found.to_dict())
    data = {**record, **{name: array.tolist() for name, array in arrays.items()}, "text": found.summary}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "panels.3dm"
        write_rationalised(path, found, record)
        return Found(found.summary.splitlines()[0], data, {"3dm": path.read_bytes()}, found.design.notes)


SEARCHES: dict[str, Search] = {
    own.name: own
    for own in (
        Search(
            "limits",
            "Scale all targets by a common factor and report the largest factor for which a fair surface exists.",
            (
                BuildOption(
                    "tolerance",
                    "relative accuracy of the reported limit",
                    _share,
                    {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1, "default": 0.01},
                ),
            ),
            (),
            _limits,
        ),
        Search(
            "rationalise",
            "Find the surface with panels from few moulds that is nearest to a freeform design.",
            (
                BuildOption(
                    "moulds",
                    "number of moulds (default: 4, or with within, the fewest for this distance)",
                    values.whole,
                    {"type": "integer", "minimum": 1, "maximum": 64},
                ),
                BuildOption(
                    "radii",
                    "radii of existing moulds instead of their number: positive for spheres, negative for saddles, null for flat",
                    _radii,
                    {"type": "array", "minItems": 1, "items": {"type": ["number", "null"]}},
                ),
                BuildOption(
                    "locked",
                    "panels that keep a mould, as a position in radii, by their numbers",
                    _locked,
                    {"type": "object", "additionalProperties": {"type": "integer", "minimum": 0}},
                ),
                BuildOption("panel", "width of the panels (default: a twelfth of the longer side)", values.number, _LENGTH),
                BuildOption("within", "largest distance from the design", values.number, _LENGTH),
                BuildOption(
                    "tolerance",
                    "largest distance of the smooth surface fitted to a mesh (default: that of the file, or a ten-thousandth of the size)",
                    values.number,
                    _LENGTH,
                ),
                BuildOption(
                    "costs",
                    "costs of a mould and of a panel made on it, for each kind of mould; with within, the cheapest surface is found",
                    _costs,
                    {"type": "object", "required": list(KINDS), "additionalProperties": False, "properties": dict.fromkeys(KINDS, _PAIR)},
                ),
                BuildOption(
                    "weights",
                    "places where distances count more or less, as rows x, y, z, radius, factor",
                    _weights,
                    {"type": "array", "maxItems": MAX_PLACES, "items": _PLACE},
                ),
                BuildOption(
                    "flat", "whether one mould is flat (default: whichever is nearer to the design)", values.truth, {"type": "boolean"}
                ),
                BuildOption(
                    "seams",
                    "grid along the plan, curvature or geodesics (lines one panel apart), levels of K for few regions, faces of a quad "
                    "mesh, or points along curves on the design (default: grid)",
                    _seams,
                    {"anyOf": [{"enum": list(SEAMS)}, {"type": "array", "minItems": 1, "items": _CURVE}], "default": SEAMS[0]},
                ),
                BuildOption(
                    "supports",
                    "what is held (default: the supports of the drawing, or the corners)",
                    _one_of(SUPPORTS),
                    {"enum": list(SUPPORTS)},
                ),
                BuildOption(
                    "edges",
                    "edges of the mesh along the side of a panel (default: 4 or more)",
                    values.whole,
                    {"type": "integer", "minimum": 2, "maximum": 20},
                ),
            ),
            ("3dm",),
            _rationalised,
            of_designs=True,
        ),
    )
}
