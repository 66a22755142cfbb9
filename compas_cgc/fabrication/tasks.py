"""Table of the fabrication tasks and their options, which all doors read."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence
from typing import Any
from typing import Callable
from typing import NamedTuple
from typing import Optional

from ..errors import CGCError
from ..model.problem import PosesProblem
from ..model.units import within
from . import option_values as values
from .materials import MATERIALS

__all__ = ["TASKS", "BuildOption", "Task", "build", "file_options", "read_options", "read_settings"]


class BuildOption(NamedTuple):
    """An option of a task."""

    name: str
    text: str  # help text, without a full stop
    read: Callable[[object, str], Any]  # value and name for messages -> parsed value; raises CGCError
    schema: dict  # JSON schema without a description
    metavar: str = ""  # on the command line; empty for a switch
    flag: str = ""  # on the command line, if it differs from the name
    many: bool = False  # repeatable on the command line
    file: bool = False  # affects the written file only


class Task(NamedTuple):
    """Fabrication task on a solved surface."""

    name: str
    text: str
    options: tuple[BuildOption, ...]
    run: Callable[[PosesProblem, dict[str, Any]], Any]


DIVIDES = {"size", "count", "columns", "rows", "curves"}  # options that define joints
_NUMBER = {"type": "number", "minimum": -values.LARGEST, "maximum": values.LARGEST}
_TEXT = {"type": "string", "maxLength": 200}
_LENGTH = {"type": "number", "minimum": 0, "maximum": values.LARGEST}
_PLAN_VECTOR = {
    "oneOf": [
        {"type": "string", "pattern": r"^[-+0-9.eE]+ *, *[-+0-9.eE]+$"},
        {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
    ]
}
_PLAN_LINE = {
    "oneOf": [
        {"type": "string", "pattern": r"^ *[-+0-9.eE]+( *, *[-+0-9.eE]+){3} *$"},
        {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
    ]
}
_REGIONS = BuildOption(
    "regions",
    "use these regions only",
    values.region_numbers,
    {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 1},
    "N",
    "region",
    many=True,
)
_ROUGH = BuildOption("rough", "accept a surface with the verdict rough", values.truth, {"type": "boolean", "default": False})


def _mould(surface: PosesProblem, settings: dict[str, Any]) -> Any:
    from .moulding import moulds
    from .panelling import panels

    how = _joints(settings)
    if not DIVIDES & set(how):
        how["count"] = 1
    return moulds(surface, panels(surface, how.pop("size", None), **how), **settings)


def _joints(settings: dict[str, Any]) -> dict[str, Any]:
    """Take the options of :func:`panels` out of settings."""
    return {name: settings.pop(name) for name in (*DIVIDES, "along", "shortest") if name in settings}


def _unroll(surface: PosesProblem, settings: dict[str, Any]) -> Any:
    from .panelling import panels
    from .unrolling import unroll

    size = settings.pop("sheet", None)
    units = surface.to_problem().drawing.units
    if DIVIDES & set(settings):
        shortest = {name: settings[name] for name in ("shortest",) if name in settings}
        how = {**_joints(settings), **shortest}
        settings = {**settings, **shortest, "panels": panels(surface, how.pop("size", None), **how)}
    elif "along" in settings:
        raise CGCError("the direction of a grid needs its size: give size, count, columns or rows too, or omit along")
    sizes = size and [own.within(units) if isinstance(own, values.Sheet) else own for own in size]
    return unroll(surface, sizes, **settings)


def _membrane(surface: PosesProblem, settings: dict[str, Any]) -> Any:
    from .equilibrium import membrane

    return membrane(surface, **settings)


def _net(surface: PosesProblem, settings: dict[str, Any]) -> Any:
    from .curves import curve_net

    return curve_net(surface, **settings)


def _quads(surface: PosesProblem, settings: dict[str, Any]) -> Any:
    from .quads import plane_quads

    return plane_quads(surface, **settings)


def _drawings(surface: PosesProblem, settings: dict[str, Any]) -> Any:
    from .views import draw_views

    return draw_views(surface, **settings)


_WIDTHS = {
    "oneOf": [
        {"type": "string"},
        {**_LENGTH, "exclusiveMinimum": 0},
        {"type": "array", "items": {**_LENGTH, "exclusiveMinimum": 0}, "minItems": 1},
    ]
}
_SHEET = {
    "oneOf": [
        {"type": "string", "pattern": r"^[0-9.]+ *[x×X] *[0-9.]+ *(mm|cm|m|in|ft)?( *, *[0-9.]+ *[x×X] *[0-9.]+ *(mm|cm|m|in|ft)?)*$"},
        {"type": "array", "items": {**_LENGTH, "exclusiveMinimum": 0}, "minItems": 2, "maxItems": 2},
    ]
}
_JOINTS = (
    BuildOption("size", "approximate width of the panels, in model units", values.length, {**_LENGTH, "exclusiveMinimum": 0}, "L"),
    BuildOption(
        "count",
        "approximate number of panels per region, instead of a size",
        values.whole,
        {"type": "integer", "minimum": 1, "maximum": 1_000_000},
        "N",
    ),
    BuildOption(
        "columns", "widths of the panels along x, such as 1.2 or 0.8,1.2; the last one is repeated", values.widths, _WIDTHS, "L,L,..."
    ),
    BuildOption("rows", "widths of the panels along y, like columns", values.widths, _WIDTHS, "L,L,..."),
    BuildOption(
        "along",
        "grid of the panels: along the plan or the lines of curvature (default: plan)",
        values.text,
        {"enum": list(values.ALONG), "default": "plan"},
        "|".join(values.ALONG),
    ),
    BuildOption(
        "shortest",
        "shortest length of a seam in mm; joints are moved to avoid shorter seams, and the report names those that remain (default: 100)",
        values.millimetres,
        {**_LENGTH, "default": 100.0},
        "MM",
    ),
)


TASKS: dict[str, Task] = {
    own.name: own
    for own in (
        Task(
            "mould",
            "Divide a solved surface into panels and report their moulds and fit.",
            (
                *_JOINTS,
                BuildOption(
                    "material",
                    "material of the panels (default: glass)",
                    values.text,
                    {"enum": list(MATERIALS), "default": "glass"},
                    "|".join(MATERIALS),
                ),
                BuildOption(
                    "thickness",
                    "thickness of the panels in mm (default: 6)",
                    values.millimetres,
                    {**_LENGTH, "exclusiveMinimum": 0, "default": 6.0},
                    "MM",
                ),
                BuildOption(
                    "tolerance",
                    "largest gap in mm for which panels with different K share a mould (default: 0)",
                    values.millimetres,
                    {**_LENGTH, "default": 0.0},
                    "MM",
                ),
                BuildOption(
                    "least_bending",
                    "choose moulds among spindles, bulges and hyperboloids too, so that panels bend least (default: no)",
                    values.truth,
                    {"type": "boolean", "default": False},
                ),
                _ROUGH,
            ),
            _mould,
        ),
        Task(
            "unroll",
            "Unroll a solved surface to flat pieces on sheets, with labels, folds, rulings and seam marks.",
            (
                BuildOption(
                    "sheet",
                    "length and width of the sheets, such as 3.0x1.5 or 3000x1500mm, or several, separated by commas (default: unlimited)",
                    values.sheets,
                    {"oneOf": [_SHEET, {"type": "array", "items": _SHEET, "minItems": 1}]},
                    "LxW",
                ),
                BuildOption(
                    "strain",
                    "largest strain of flattened pieces, such as 0.002 or 0.2%",
                    values.strain,
                    {"oneOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string", "pattern": "^[0-9.]+ *%?$"}]},
                    "E",
                ),
                BuildOption(
                    "seams",
                    "path of vertices to cut along, instead of automatic seams",
                    values.paths,
                    {"type": "array", "items": {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 2}},
                    "V,V,...",
                    "seam",
                    many=True,
                ),
                _REGIONS,
                BuildOption(
                    "spacing",
                    "distance between pieces on a sheet; 0 places them edge to edge (default: 1 % of the sheet width)",
                    values.length,
                    _LENGTH,
                    "D",
                ),
                BuildOption(
                    "margin", "free margin along the edges of a sheet (default 0)", values.length, {**_LENGTH, "default": 0.0}, "D"
                ),
                BuildOption(
                    "allowance",
                    "width of a strip around each piece for welding or sewing (default 0)",
                    values.length,
                    {**_LENGTH, "default": 0.0},
                    "D",
                ),
                BuildOption(
                    "kerf",
                    "width that the tool removes; cut lines are drawn in the middle of it (default 0: the machine corrects the path)",
                    values.length,
                    {**_LENGTH, "default": 0.0},
                    "D",
                ),
                *_JOINTS,
                BuildOption(
                    "grain",
                    "direction in plan along the length of the sheets, such as 1,0 (default: any)",
                    values.plan_vector,
                    _PLAN_VECTOR,
                    "X,Y",
                ),
                BuildOption(
                    "shapes",
                    "nest true shapes instead of rectangles, with the package spyrrow; results may differ between runs",
                    values.truth,
                    {"type": "boolean", "default": False},
                ),
                BuildOption("material", "material of the sheets, which is written on them and in the cut list", values.text, _TEXT, "NAME"),
                BuildOption(
                    "thickness",
                    "thickness of the sheets in mm, which is written on them and in the cut list",
                    values.millimetres,
                    _LENGTH,
                    "MM",
                ),
                BuildOption("rulings", "distance between drawn rulings; 0 draws none", values.length, _LENGTH, "D"),
                BuildOption(
                    "whole",
                    "keep every part between creases and seams in one piece, and refuse parts larger than a sheet "
                    "(default: yes if seams are given)",
                    values.truth,
                    {"type": "boolean"},
                ),
                BuildOption(
                    "nodes",
                    "node numbers along outlines (default: yes)",
                    values.truth,
                    {"type": "boolean", "default": True},
                    file=True,
                ),
                BuildOption(
                    "units",
                    "units of .dxf and .svg files (default: mm)",
                    values.text,
                    {"enum": [*values.DRAWING_UNITS, "drawing"], "default": "mm"},
                    "|".join([*values.DRAWING_UNITS, "drawing"]),
                    file=True,
                ),
                BuildOption(
                    "per_sheet",
                    "write one .dxf or .svg file per sheet, with the sheet number before the suffix (default: one file)",
                    values.truth,
                    {"type": "boolean", "default": False},
                    file=True,
                ),
                _ROUGH,
            ),
            _unroll,
        ),
        Task(
            "membrane",
            "Compute membrane forces, and edge forces in exact balance with the load, of a surface with constant K in each region.",
            (
                BuildOption(
                    "pressure",
                    "load per area along the normals; positive is outwards",
                    values.number,
                    {**_NUMBER, "default": 0.0},
                    "P",
                ),
                BuildOption("weight", "downward load per area of the surface", values.number, {**_NUMBER, "default": 0.0}, "G"),
                BuildOption(
                    "snow", "load per area in plan, a load case of .inp files", values.number, {**_LENGTH, "default": 0.0}, "S", file=True
                ),
                BuildOption(
                    "wind",
                    "wind pressure as a vector in plan, a load case of .inp files",
                    values.plan_vector,
                    _PLAN_VECTOR,
                    "X,Y",
                    file=True,
                ),
                BuildOption(
                    "thickness",
                    "thickness of the membrane in .inp files in mm (default: 10)",
                    values.millimetres,
                    {**_LENGTH, "exclusiveMinimum": 0, "default": 10.0},
                    "MM",
                    file=True,
                ),
                BuildOption(
                    "beam",
                    "side of the square beams along creases and free edges in .inp files in mm (default: 200)",
                    values.millimetres,
                    {**_LENGTH, "exclusiveMinimum": 0, "default": 200.0},
                    "MM",
                    file=True,
                ),
                BuildOption(
                    "modulus",
                    "Young's modulus in .inp files, in the unit of the load (default: 1e9, a placeholder)",
                    values.number,
                    {**_LENGTH, "exclusiveMinimum": 0, "default": 1e9},
                    "E",
                    file=True,
                ),
                BuildOption(
                    "edge_beams",
                    "beams along free edges; without them these edges carry no load (default: yes)",
                    values.truth,
                    {"type": "boolean", "default": True},
                ),
                BuildOption(
                    "close",
                    "correction of the edge forces on irregular meshes, by sliding vertices along the surface (default: yes)",
                    values.truth,
                    {"type": "boolean", "default": True},
                ),
                _ROUGH,
            ),
            _membrane,
        ),
        Task(
            "net",
            "Generate a net of curves on a surface with constant K or another law in each region.",
            (
                BuildOption(
                    "spacing",
                    "distance between curves (default: 1/12 of the region size)",
                    values.length,
                    {**_LENGTH, "exclusiveMinimum": 0},
                    "D",
                ),
                BuildOption(
                    "through",
                    "trace curves through these points, or through the supports ('supports')",
                    values.points,
                    {
                        "oneOf": [
                            {"enum": ["supports"]},
                            {"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}},
                        ]
                    },
                    "X,Y,Z",
                    many=True,
                ),
                BuildOption(
                    "kind",
                    "curvature or asymptotic curves in all regions (default: by K and laws; asymptotic where K < 0, rulings where K = 0)",
                    values.text,
                    {"enum": list(values.NET_KINDS)},
                    "|".join(values.NET_KINDS),
                ),
                BuildOption(
                    "stop",
                    "smallest distance between lines of curvature, relative to the spacing; lines end there (default 0.5; 0: no limit)",
                    values.number,
                    {"type": "number", "minimum": 0, "exclusiveMaximum": 1, "default": 0.5},
                    "PART",
                ),
                _REGIONS,
                _ROUGH,
                BuildOption(
                    "width",
                    "upright width of laths in mm, for .laths files (default: 80)",
                    values.millimetres,
                    {**_LENGTH, "exclusiveMinimum": 0, "default": 80.0},
                    "MM",
                    file=True,
                ),
                BuildOption(
                    "thickness",
                    "thickness of laths in mm, for .laths files (default: 8)",
                    values.millimetres,
                    {**_LENGTH, "exclusiveMinimum": 0, "default": 8.0},
                    "MM",
                    file=True,
                ),
                BuildOption(
                    "material",
                    "material of laths, for .laths files (default: timber)",
                    values.text,
                    {"enum": list(MATERIALS), "default": "timber"},
                    "|".join(MATERIALS),
                    file=True,
                ),
                BuildOption(
                    "stock",
                    "length of the stock; longer laths get splices (default: unlimited), for .laths files",
                    values.length,
                    {**_LENGTH, "default": 0.0},
                    "L",
                    file=True,
                ),
            ),
            _net,
        ),
        Task(
            "quads",
            "Cover regions with K > 0 or constant H by plane quads along lines of curvature, with beams along their sides.",
            (
                BuildOption(
                    "spacing",
                    "distance between lines (default: 1/12 of the size of the smallest region)",
                    values.length,
                    {**_LENGTH, "exclusiveMinimum": 0},
                    "D",
                ),
                BuildOption(
                    "depth",
                    "depth of the beams (default: 0.1 of the spacing)",
                    values.length,
                    {**_LENGTH, "exclusiveMinimum": 0},
                    "D",
                ),
                _REGIONS,
                _ROUGH,
            ),
            _quads,
        ),
        Task(
            "drawings",
            "Draw the plan, sections and elevations of a surface to scale.",
            (
                BuildOption(
                    "scale",
                    "denominator of the scale, such as 100 for 1:100 (default: the largest standard scale that fits)",
                    values.whole,
                    {"type": "integer", "minimum": 1, "maximum": 1_000_000},
                    "N",
                ),
                BuildOption(
                    "sheet",
                    "size of the sheet (default: A3, or the smallest for a given scale)",
                    values.text,
                    {"enum": list(values.PAPERS)},
                    "|".join(values.PAPERS),
                ),
                BuildOption(
                    "contours",
                    "height between contour lines (default: about ten lines)",
                    values.length,
                    {**_LENGTH, "exclusiveMinimum": 0},
                    "D",
                ),
                BuildOption(
                    "sections",
                    "section along a line in plan, seen towards its left (default: two through the middle)",
                    values.plan_lines,
                    {"oneOf": [_PLAN_LINE, {"type": "array", "items": _PLAN_LINE, "minItems": 1}]},
                    "X,Y,X,Y",
                    "section",
                    many=True,
                ),
                BuildOption(
                    "north", "direction of north in plan (default: that of the file, or 0,1)", values.plan_vector, _PLAN_VECTOR, "X,Y"
                ),
                BuildOption(
                    "title", "title of the sheet (default: name of the surface)", values.text, {"type": "string", "maxLength": 200}, "TEXT"
                ),
            ),
            _drawings,
        ),
    )
}


def read_settings(task: str, given: Mapping[str, object], called: Optional[Mapping[str, str]] = None) -> dict[str, Any]:
    """Return the parsed options of a task for :func:`build`; None values are left out.

    Parameters
    ----------
    task
        One of :data:`TASKS`.
    given
        Values by name, from JSON or as text.
    called
        Names of the options in messages. Default: their names in quotes.

    Raises
    ------
    CGCError
        If an option is unknown or its value is invalid.
    """
    return read_options(TASKS[task].options, given, called)


def read_options(table: Sequence[BuildOption], given: Mapping[str, object], called: Optional[Mapping[str, str]] = None) -> dict[str, Any]:
    """Return the parsed values of options by name; None values are left out.

    Parameters
    ----------
    table
        The options.
    given, called
        As in :func:`read_settings`.

    Raises
    ------
    CGCError
        If an option is unknown or its value is invalid.
    """
    options = {own.name: own for own in table}
    unknown = [name for name in given if name not in options]
    if unknown:
        raise CGCError(f"there is no option {unknown[0]!r:.60}; options are {', '.join(options)}")
    called = called or {name: f"'{name}'" for name in options}
    return {name: options[name].read(value, called[name]) for name, value in given.items() if value is not None}


def build(task: str, surface: PosesProblem, settings: Mapping[str, Any]) -> Any:
    """Run a fabrication task on a solved surface.

    Parameters
    ----------
    task
        One of :data:`TASKS`.
    surface
        A result, mesh or problem.
    settings
        Result of :func:`read_settings`, or arguments of the task's function.

    Returns
    -------
    MouldReport, Patterns, MembraneState, CurveNet, PlaneQuads or ViewSheet

    Raises
    ------
    CGCError
        If an option is invalid or the task fails.
    """
    units = surface.to_problem().drawing.units
    files = file_options(task, settings, units)
    return TASKS[task].run(surface, {name: within(value, units) for name, value in settings.items() if name not in files})


def file_options(task: str, settings: Mapping[str, Any], units: Optional[str]) -> dict[str, Any]:
    """Return the options of a task that affect only the written file, with lengths in the units of a drawing.

    Parameters
    ----------
    task
        One of :data:`TASKS`.
    settings
        Result of :func:`read_settings`.
    units
        Units of the drawing, such as ``Meters``.
    """
    return {own.name: within(settings[own.name], units) for own in TASKS[task].options if own.file and own.name in settings}
