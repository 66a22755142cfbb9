"""Example definitions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from .nodes import Button
from .nodes import Definition
from .nodes import Group
from .nodes import Hops
from .nodes import Node
from .nodes import Note
from .nodes import Panel
from .nodes import Parameter
from .nodes import Script
from .nodes import Slider
from .nodes import Toggle
from .nodes import ValueList

__all__ = ["EXAMPLES"]

FIGURES = ("K", "error", "H", "k_max", "k_min")


def _headline(title: str, steps: str) -> tuple[Node, ...]:
    return Note("title", title, 28.0), Note("steps", steps)


# Grasshopper runs components without wires in their order: the package is installed before other components import it.
INSTALL = Script("install", "CGC_Install")


def _solving(mesh: str, settings: str = "", key: str = "solve", **wires: str) -> Script:
    if settings:
        wires["settings"] = settings
    return Script(key, "CGC_Solve", {"cgc_mesh": mesh, "run": "run", "reset": "reset", **wires}, hidden=True)


SWITCHES = (Toggle("run", "run"), Button("reset", "reset"))

FIRST_DOME = Definition(
    "first_dome",
    "The first dome",
    "A square fixed at its edge becomes a surface of constant Gaussian curvature; a slider sets the curvature.",
    (
        *_headline("The first dome", "1  Set run to True.   2  Move the slider: the surface follows.   3  Choose what the colours show."),
        Slider("number", "example", 2, 2, 7, 0),
        Slider("K", "curvature K", 1.0, 0.1, 2.0, 2),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("target", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "K"}),
        *SWITCHES,
        _solving("target.cgc_mesh"),
        ValueList("show", "show", FIGURES),
        Script("analyse", "CGC_Analyse", {"cgc_mesh": "solve.cgc_mesh", "show": "show"}),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("legend", "legend", source="analyse.legend", size=(120, 150)),
        Panel("report", "report", source="solve.report", size=(520, 190)),
        Group("ask", "inputs", ("number", "K", "example", "target", "run", "reset")),
    ),
)

NINE_REGIONS = Definition(
    "nine_regions",
    "Nine regions",
    "Example 4 of the paper: a square in nine regions separated by creases, with a different curvature in the centre.",
    (
        *_headline("Nine regions, as in the paper", "1  Set run to True.   2  Move a slider.   3  Bake the regions: one mould for each."),
        Panel("number", "example", "4", size=(60, 40)),
        Slider("around", "K around", 1.0, 0.2, 4.0, 2),
        Slider("centre", "K in the centre", 4.0, 0.2, 6.0, 2),
        Slider("region", "region of the centre", 4, 0, 8, 0),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("all", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "around"}),
        Script("one", "CGC_Target", {"cgc_mesh": "all.cgc_mesh", "K": "centre", "region": "region"}),
        *SWITCHES,
        _solving("one.cgc_mesh"),
        ValueList("show", "show", FIGURES),
        Script("analyse", "CGC_Analyse", {"cgc_mesh": "solve.cgc_mesh", "show": "show"}),
        Script("regions", "CGC_Regions", {"cgc_mesh": "solve.cgc_mesh"}, hidden=True),
        Script("history", "CGC_History", {"result": "solve.result"}),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("report", "report", source="solve.report", size=(520, 230)),
        Panel("targets", "targets by region", source="regions.targets", size=(160, 90)),
        Panel("errors", "largest error by step", source="history.max_error", size=(200, 80)),
        Group("ask", "inputs", ("number", "around", "centre", "region", "example", "all", "one", "run", "reset")),
    ),
)

MOULDS = Definition(
    "moulds",
    "Panels and their moulds",
    "The nine regions, solved with the triangles of their moulds and divided into panels. Every panel is placed on its mould.",
    (
        *_headline("Panels and their moulds", "1  Set run to True.   2  Choose how many panels.   3  Bake panels and moulds."),
        Panel("number", "example", "4", size=(60, 40)),
        Slider("around", "K around", 1.0, 0.2, 4.0, 2),
        Slider("centre", "K in the centre", 2.0, 0.2, 6.0, 2),
        Slider("region", "region of the centre", 4, 0, 8, 0),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("all", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "around"}),
        Script("one", "CGC_Target", {"cgc_mesh": "all.cgc_mesh", "K": "centre", "region": "region"}),
        ValueList("measure", "measure", ("exact", "exact-arc", "defect")),
        Script("settings", "CGC_Settings", {"measure": "measure"}),
        *SWITCHES,
        _solving("one.cgc_mesh", "settings.settings"),
        Slider("count", "panels per region", 4, 1, 25, 0),
        ValueList("material", "material", ("glass", "steel", "gfrp", "timber")),
        Slider("thickness", "thickness in mm", 6.0, 1.0, 40.0, 1),
        Script("mould", "CGC_Mould", {"cgc_mesh": "solve.cgc_mesh", "count": "count", "material": "material", "thickness": "thickness"}),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("names", "panels", source="mould.names", size=(80, 230)),
        Panel("misses", "deviation without bending [mm]", source="mould.misses", size=(160, 230)),
        Panel("report", "report", source="mould.report", size=(520, 230)),
        Group("ask", "inputs", ("number", "around", "centre", "region", "example", "all", "one", "measure", "settings", "run", "reset")),
    ),
)

FLAT_PATTERNS = Definition(
    "flat_patterns",
    "From a roof to cut sheets",
    "The roof of the paper with curved creases, solved for K = 0 and unrolled to pieces on sheets with labels, folds, rulings and marks.",
    (
        *_headline("From a roof to cut sheets", "1  Set run to True.   2  Choose the sheets.   3  Name a .dxf, and set write to True."),
        Panel("number", "example", "7", size=(60, 40)),
        Slider("K", "curvature K", 0.0, -0.02, 0.05, 3),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("target", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "K"}),
        *SWITCHES,
        _solving("target.cgc_mesh"),
        Slider("length", "length of sheets", 3.0, 0.5, 6.0, 2),
        Slider("width", "width of sheets", 1.5, 0.5, 6.0, 2),
        Panel("path", "file", "patterns.dxf", size=(160, 40)),
        Toggle("write", "write"),
        Script(
            "unroll", "CGC_Unroll", {"cgc_mesh": "solve.cgc_mesh", "length": "length", "width": "width", "path": "path", "write": "write"}
        ),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("labels", "pieces", source="unroll.labels", size=(80, 230)),
        Panel("report", "report", source="unroll.report", size=(520, 230)),
        Group("ask", "inputs", ("number", "K", "example", "target", "run", "reset")),
        Group("sheets", "sheets", ("length", "width", "path", "write")),
    ),
)

FORCES = Definition(
    "forces",
    "Forces in a dome",
    "A square dome of constant curvature under pressure and self-weight: crosses along the principal forces, reactions, line loads.",
    (
        *_headline("Forces in a dome", "1  Set run to True.   2  Choose pressure and weight.   3  Bake tension and compression."),
        Slider("number", "example", 2, 2, 7, 0),
        Slider("K", "curvature K", 1.0, 0.1, 2.0, 2),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("target", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "K"}),
        *SWITCHES,
        _solving("target.cgc_mesh"),
        Slider("pressure", "pressure", 1.0, -10.0, 10.0, 2),
        Slider("weight", "weight", 0.0, 0.0, 10.0, 2),
        Script("membrane", "CGC_Membrane", {"cgc_mesh": "solve.cgc_mesh", "pressure": "pressure", "weight": "weight"}),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("loads", "line loads", source="membrane.line_loads", size=(120, 230)),
        Panel("report", "report", source="membrane.report", size=(520, 230)),
        Group("ask", "inputs", ("number", "K", "example", "target", "run", "reset")),
        Group("load", "load", ("pressure", "weight")),
    ),
)

LATHS = Definition(
    "laths",
    "Laths on saddles",
    "The roof with curved creases for a negative K: equally spaced asymptotic curves, along which straight laths can be bent.",
    (
        *_headline("Laths on saddles", "1  Set run to True.   2  Move the sliders.   3  Bake the curves (lines of curvature if K > 0)."),
        Panel("number", "example", "7", size=(60, 40)),
        Slider("K", "curvature K", -0.01, -0.02, 0.05, 3),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("target", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "K"}),
        *SWITCHES,
        _solving("target.cgc_mesh"),
        Slider("spacing", "spacing", 1.0, 0.2, 3.0, 2),
        Parameter("points", "through points", "Point"),
        Script("net", "CGC_Net", {"cgc_mesh": "solve.cgc_mesh", "spacing": "spacing", "through": "points"}),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("sides", "lengths between nodes", source="net.sides", size=(120, 230)),
        Panel("report", "report", source="net.report", size=(520, 150)),
        Group("ask", "inputs", ("number", "K", "example", "target", "run", "reset")),
    ),
)

TWO_STRATEGIES = Definition(
    "two_strategies",
    "Two strategies for creases",
    "The same problem with the strategies S1 (creases move by a factor) and S2 (creases move after a delay) of the paper, side by side.",
    (
        *_headline("S1 and S2 side by side", "Creases move by a factor s (left), or wait for some steps and then move fully (right)."),
        Panel("number", "example", "4", size=(60, 40)),
        Slider("K", "curvature K", 1.0, 0.5, 4.0, 2),
        Slider("s", "S1: factor s", 0.5, 0.0, 1.0, 2),
        Slider("delay", "S2: delay in steps", 5, 1, 20, 0),
        Script("example", "CGC_Example", {"number": "number"}, hidden=True),
        Script("target", "CGC_Target", {"cgc_mesh": "example.cgc_mesh", "K": "K"}),
        Script("first", "CGC_Settings", {"s": "s"}),
        Script("second", "CGC_Settings", {"delay": "delay"}),
        *SWITCHES,
        _solving("target.cgc_mesh", "first.settings", "solve_first"),
        _solving("target.cgc_mesh", "second.settings", "solve_second"),
        Slider("aside", "offset of the second surface", 2.0, 0.0, 5.0, 1),
        Script("analyse_first", "CGC_Analyse", {"cgc_mesh": "solve_first.cgc_mesh"}),
        Script("analyse_second", "CGC_Analyse", {"cgc_mesh": "solve_second.cgc_mesh", "aside": "aside"}),
        Panel("report_first", "S1", source="solve_first.report", size=(520, 230)),
        Panel("report_second", "S2", source="solve_second.report", size=(520, 230)),
        Group("strategies", "strategies", ("s", "delay", "first", "second")),
    ),
)

OWN_MESH = Definition(
    "own_mesh",
    "Your own mesh",
    "A mesh from Rhino with points as supports and curves as creases.",
    (
        *_headline(
            "Your own mesh",
            "1  Right-click Mesh > Set one Mesh; supports and creases are optional.\n"
            "2  Set the radius of a sphere, in model units.   3  Set run to True.",
        ),
        Parameter("mesh", "Mesh", "Mesh"),
        Parameter("points", "supports", "Point"),
        Parameter("curves", "creases", "Curve"),
        Slider("radius", "radius", 10.0, 1.0, 100.0, 1),
        Toggle("flip", "flip"),
        Script("made", "CGC_Mesh", {"mesh": "mesh", "supports": "points", "creases": "curves", "flip": "flip"}),
        Script("target", "CGC_Target", {"cgc_mesh": "made.cgc_mesh", "radius": "radius"}),
        *SWITCHES,
        _solving("target.cgc_mesh"),
        ValueList("show", "show", FIGURES),
        Panel("problems", "problems", source="made.problems", size=(260, 60)),
        Script("analyse", "CGC_Analyse", {"cgc_mesh": "solve.cgc_mesh", "show": "show"}),
        Script("regions", "CGC_Regions", {"cgc_mesh": "solve.cgc_mesh"}, hidden=True),
        Panel("report", "report", source="solve.report", size=(520, 190)),
        Group("draw", "from Rhino", ("mesh", "points", "curves")),
    ),
)


def _obj(title: str, columns: int, rows: int, width: float, depth: float, height: Callable[[float, float], float], ends: str) -> str:
    """Return a roof over a rectangle, supported along its long sides or at its corners, as the text of an .obj file.

    Parameters
    ----------
    height
        Height [L] at a place in the unit square.
    ends
        ``sides`` or ``corners``.
    """
    places = [(i, j) for i in range(columns + 1) for j in range(rows + 1)]
    number = {place: k + 1 for k, place in enumerate(places)}
    lines = [f"# {title}"]
    lines += [f"v {width * i / columns:g} {depth * j / rows:g} {height(i / columns, j / rows):.6g}" for i, j in places]
    for i, j in places:
        if i < columns and j < rows:
            a, b, c, d = (number[i + x, j + y] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
            lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    held = range(columns + 1) if ends == "sides" else (0, columns)
    lines += [f"p {number[i, j]}" for i in held for j in (0, rows)]
    return "\n".join(lines)


VAULT = _obj("A vault on its two long sides", 12, 8, 12.0, 8.0, lambda u, v: 8.0 * v * (1.0 - v), "sides")
FREEFORM = _obj(
    "A freeform roof on its corners",
    *(18, 12, 12.0, 8.0),
    lambda u, v: 6.0 * u * (1.0 - u) + 5.0 * v * (1.0 - v) + 1.5 * u * v * (1.0 - u),
    "corners",
)


MESH_INSIDE = Definition(
    "mesh_inside",
    "A mesh inside the definition",
    "A vault stored in the definition as the text of an .obj file. Replace it by the text of your own file.",
    (
        *_headline(
            "A mesh inside the definition",
            "1  Set run to True.   2  Move K.\n"
            "3  Paste the text of your own .obj file into the panel: v and f lines, p for fixed vertices, l for creases.",
        ),
        Panel("text", "mesh as .obj", VAULT, size=(200, 230), whole=True),
        Script("read", "CGC_Read3dm", {"path": "text"}, hidden=True),
        Slider("K", "curvature K", 0.01, -0.05, 0.05, 3),
        Script("target", "CGC_Target", {"cgc_mesh": "read.cgc_mesh", "K": "K"}),
        *SWITCHES,
        ValueList("show", "show", FIGURES),
        _solving("target.cgc_mesh", show="show"),
        Panel("status", "status", source="solve.status", size=(220, 40)),
        Panel("legend", "legend", source="solve.legend", size=(120, 150)),
        Panel("report", "report", source="solve.report", size=(520, 190)),
        Script("regions", "CGC_Regions", {"cgc_mesh": "solve.cgc_mesh"}, hidden=True),
        Script("bake", "CGC_Bake", {"cgc_mesh": "solve.cgc_mesh", "bake": "press"}),
        Button("press", "bake"),
    ),
)

RATIONALISE = Definition(
    "rationalise",
    "A freeform roof from few moulds",
    "A freeform roof stored in the definition becomes the nearest surface with panels from few moulds.",
    (
        *_headline(
            "A freeform roof from few moulds",
            "1  Set run to True.   2  Choose the width of the panels and the number of moulds.\n"
            "3  Paste the text of your own .obj file into the panel, or connect a Mesh parameter to design.",
        ),
        Panel("text", "design as .obj", FREEFORM, size=(200, 230), whole=True),
        Script("read", "CGC_Read3dm", {"path": "text"}, hidden=True),
        Slider("panel", "width of panels", 2.0, 1.0, 4.0, 1),
        Slider("moulds", "number of moulds", 3, 1, 8, 0),
        Toggle("run", "run"),
        Script("rationalise", "CGC_Rationalise", {"design": "read.cgc_mesh", "panel": "panel", "moulds": "moulds", "run": "run"}),
        Panel("curvatures", "K of the moulds", source="rationalise.curvatures", size=(160, 80)),
        Panel("classes", "mould of each panel", source="rationalise.classes", size=(120, 150)),
        Panel("report", "report", source="rationalise.report", size=(520, 190)),
        Script("bake", "CGC_Bake", {"cgc_mesh": "rationalise.cgc_mesh", "bake": "press"}),
        Button("press", "bake"),
        Group("ask", "inputs", ("text", "read", "panel", "moulds", "run")),
    ),
)

HOPS_DOME = Definition(
    "hops_dome",
    "A dome by Hops",
    "A mesh fixed at its edge becomes a surface of constant Gaussian curvature. Solved on the server; for Rhino 7 and 8, without plug-in.",
    (
        *_headline(
            "A dome by Hops",
            "1  Start the server: compas-cgc serve.   2  Right-click Mesh > Set one Mesh.\n3  Set K: 1/r² for a sphere of radius r.",
        ),
        Parameter("mesh", "Mesh", "Mesh"),
        Slider("K", "curvature K", 0.01, 0.0, 1.0, 4),
        Hops("dome", "cgc/dome", {"Mesh": "mesh", "K": "K"}),
        Panel("info", "info", source="dome.Info", size=(380, 60)),
        Panel("error", "largest error", source="dome.Error", size=(160, 40)),
    ),
    rhino=7,
)

HOPS_REGIONS = Definition(
    "hops_regions",
    "Regions by Hops",
    "A mesh with creases and one curvature per region. Solved on the server; for Rhino 7 and 8, without plug-in.",
    (
        *_headline(
            "Regions by Hops",
            "1  Start the server: compas-cgc serve.   2  Open nine_regions.3dm; set its mesh, supports and creases.\n"
            "3  Set a point in each region, and write one K per line in the same order.",
        ),
        Parameter("mesh", "Mesh", "Mesh"),
        Parameter("supports", "supports", "Point"),
        Parameter("creases", "creases", "Curve"),
        Panel("K", "K by region", "0.01\n0.01\n0.01\n0.01\n0.04\n0.01\n0.01\n0.01\n0.01", size=(80, 170)),
        Parameter("at", "points in regions", "Point"),
        Slider("s", "factor s of creases", 0.8, 0.0, 1.0, 2),
        Hops("solve", "cgc/solve", {"Mesh": "mesh", "Supports": "supports", "Creases": "creases", "K": "K", "At": "at", "S": "s"}),
        Panel("info", "info", source="solve.Info", size=(380, 100)),
        Panel("error", "largest error", source="solve.Error", size=(160, 40)),
        Hops("analyse", "cgc/analyse", {"Mesh": "solve.Mesh"}),
        Panel("report", "report", source="analyse.Info", size=(520, 150)),
    ),
    rhino=7,
)


def _with_install(definition: Definition) -> Definition:
    title, steps, *nodes = definition.nodes
    return replace(definition, nodes=(title, steps, INSTALL, *nodes))


_COMPONENTS = (FIRST_DOME, NINE_REGIONS, MOULDS, FLAT_PATTERNS, FORCES, LATHS, TWO_STRATEGIES, OWN_MESH, MESH_INSIDE, RATIONALISE)
EXAMPLES = (*map(_with_install, _COMPONENTS), HOPS_DOME, HOPS_REGIONS)
