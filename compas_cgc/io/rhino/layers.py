"""Layers: their roles, custom layer names, and the selection of objects by layer or type."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import fields
from pathlib import Path
from typing import NamedTuple
from typing import Optional
from typing import Union

from ...errors import FileError
from ...errors import names_what_was_meant
from ...meshing.cleanup import Omission
from ...model.counts import counted
from .archive import Item
from .user_text import dot_law
from .user_text import user_law

__all__ = [
    "CURVES",
    "DRAWN",
    "FORCES",
    "MOULDS",
    "NURBS",
    "PATTERNS",
    "QUADS",
    "RATIONALISED",
    "RESULT",
    "LayerNames",
    "Selection",
    "drawing_or_result",
    "layer_names",
    "select",
]

RESULT, RATIONALISED, NURBS = "CGC Result", "CGC Rationalised", "CGC::NURBS"
CURVES, FORCES, MOULDS, PATTERNS, QUADS = "CGC Curves", "CGC Membrane", "CGC Moulds", "CGC Patterns", "CGC Quads"
DRAWN = "Drawn"  # sublayer with the drawing that a mesh was found for
_WRITTEN = (RESULT, RATIONALISED, NURBS, CURVES, FORCES, MOULDS, PATTERNS, QUADS, f"CGC::{DRAWN}")
_SURFACES = ("Brep", "Extrusion", "SubD", "Surface", "NurbsSurface", "RevSurface", "PlaneSurface", "SumSurface")
_POINTS = ("point", "point cloud")


@names_what_was_meant()
@dataclass(frozen=True)
class LayerNames:
    """Names of the layers to read, including their sublayers; case is ignored.

    Parameters
    ----------
    mesh
        Meshes, which are joined to one.
    supports
        Points and point clouds at fixed vertices; curves along fixed vertices.
    creases
        Curves along which the surface may fold.
    targets
        Text dots, or points with user text, such as ``K=0.03`` or ``H=0.1`` in a region.
    constraints
        Curves on which the vertices along them must stay, or remain fixed with user text ``keep``;
        points that set the height of the vertex below or above them.
    goals
        Points and curves with user text such as ``rise`` or ``clearance``; closed curves with a name define places.

    Examples
    --------
    >>> from compas_cgc.io.rhino import layer_names
    >>> layer_names().mesh
    ('CGC::Mesh',)
    """

    mesh: tuple[str, ...] = ("CGC::Mesh",)
    supports: tuple[str, ...] = ("CGC::Supports",)
    creases: tuple[str, ...] = ("CGC::Creases",)
    targets: tuple[str, ...] = ("CGC::Targets",)
    constraints: tuple[str, ...] = ("CGC::Constraints",)
    goals: tuple[str, ...] = ("CGC::Goals",)

    def role(self, layer: str) -> Optional[str]:
        """Return the role of a layer (full path): a field of this class, ``"result"`` for those that are written, or None."""
        for field in fields(self):
            if any(_within(layer, name) for name in getattr(self, field.name)):
                return field.name
        return "result" if any(_within(layer, name) for name in _WRITTEN) else None


@names_what_was_meant()
def layer_names(path: Union[str, os.PathLike, None] = None, given: Optional[Mapping[str, object]] = None) -> LayerNames:
    """Return the layer names for a file: the defaults, updated by a TOML file beside it and by `given`.

    The TOML file has the name of the .3dm with the suffix ``.toml`` and a table such as::

        [layers]
        mesh = "Roof::Shell"
        supports = ["Columns", "Walls"]

    Parameters
    ----------
    path
        The .3dm file.
    given
        Names by role, as in the TOML table; they override the TOML file.

    Returns
    -------
    LayerNames
        Names of layers by role.

    Raises
    ------
    FileError
        If the TOML file cannot be read, or has unknown roles or invalid layer names.

    Examples
    --------
    >>> layer_names(given={"mesh": "Shell"}).mesh
    ('Shell',)
    """
    merged: dict[str, tuple[str, ...]] = {}
    beside = Path(path).with_suffix(".toml") if path is not None else None
    if beside is not None and beside.is_file():
        merged.update(_tuples(_toml(beside).get("layers", {}), str(beside)))
    merged.update(_tuples(given or {}, "the layer names"))
    return LayerNames(**merged)


def _within(layer: str, name: str) -> bool:
    layer, name = layer.casefold(), name.casefold()
    return layer == name or layer.startswith(name + "::")


def _toml(path: Path) -> dict:
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise FileError(f"{path} cannot be read as TOML: {error}") from None


def _tuples(names: object, source: str) -> dict[str, tuple[str, ...]]:
    roles = [field.name for field in fields(LayerNames)]
    if not isinstance(names, Mapping):
        raise FileError(f'{source}: [layers] must be a table such as mesh = "Roof"')
    result = {}
    for role, value in names.items():
        if role not in roles:
            raise FileError(f"{source}: unknown role {role!r} of a layer; use {', '.join(roles)}")
        values = [value] if isinstance(value, str) else value
        if not isinstance(values, (list, tuple)) or not all(isinstance(name, str) and name for name in values):
            raise FileError(f"{source}: {role} must be the name of a layer or a list of names, not {value!r}")
        result[role] = tuple(values)
    return result


class Selection(NamedTuple):
    """Objects of a file by role."""

    mesh: list[Item]
    supports: list[Item]
    creases: list[Item]
    targets: list[Item]
    constraints: list[Item]
    goals: list[Item]
    outlines: list[Item]  # boundary and holes of a mesh to be generated
    regions: list[Item]  # regions of an earlier result, with its targets
    notes: list[str]
    drawn: list[Item] = []  # the drawing that the mesh was found for


def select(items: list[Item], names: LayerNames, result: bool = False) -> Selection:
    """Select objects by their layers, or by type if no layer with a role is used.

    Objects of an earlier result are used only if there is no other mesh, or if `result` is true.
    """
    role = {item.id: names.role(item.layer) for item in items}
    regions = [item for item in items if item.layer == f"{RESULT}::Regions" and item.kind == "mesh"]
    given, earlier, notes = drawing_or_result(items, names, result)
    if earlier:
        wanted = ("Mesh", "Supports", "Creases", "Constraints", "Goals")
        mesh, supports, creases, constraints, goals = ([item for item in given if item.layer == f"{RESULT}::{part}"] for part in wanted)
        return Selection(mesh, supports, creases, [], constraints, goals, [], regions, notes, _drawn(items, RESULT))
    selected = _by_layer(given, role, regions, names) if any(role[item.id] for item in given) else _by_kind(given, regions)
    return selected._replace(notes=[*notes, *selected.notes], drawn=_drawn(items, "CGC"))


def _drawn(items: list[Item], parent: str) -> list[Item]:
    return [item for item in items if item.layer == f"{parent}::{DRAWN}" and item.kind == "mesh"]


def drawing_or_result(items: list[Item], names: LayerNames, result: bool = False) -> tuple[list[Item], bool, list[str]]:
    """Return the objects of a drawing or of an earlier result, whether they are the result, and a note on it if there is one.

    The result is used only if nothing else has faces, or if `result` is true.
    """
    earlier = [item for item in items if names.role(item.layer) == "result"]
    given = [item for item in items if names.role(item.layer) != "result"]
    drawn = any(item.kind == "mesh" or item.kind in _SURFACES for item in given)
    solved = any(item.layer == f"{RESULT}::Mesh" for item in earlier)
    if not solved:
        return given, False, []
    if not drawn:
        return earlier, True, ["the file holds only an earlier result, which is used as the input"]
    if result:
        return earlier, True, ["the result in the file is used instead of its drawing"]
    return given, False, [Omission("the drawing in the file is used, not its result")]


def _by_layer(given: list[Item], role: dict, regions: list[Item], names: LayerNames) -> Selection:
    wanted = {
        "mesh": ("mesh", *_SURFACES),
        "supports": (*_POINTS, "curve"),
        "creases": ("curve",),
        "targets": ("text dot", "point"),
        "constraints": ("curve", *_POINTS),
        "goals": ("curve", "text dot", *_POINTS),
    }
    chosen = {part: [item for item in given if role[item.id] == part and item.kind in kinds] for part, kinds in wanted.items()}
    outlines = [item for item in given if role[item.id] == "mesh" and item.kind == "curve"]
    meshed = {item.id for item in outlines} if not chosen["mesh"] else set()
    notes = [
        f"{item.label} was ignored: its layer is for {', '.join(wanted[role[item.id]])}"
        for item in given
        if role[item.id] and item.kind not in wanted[role[item.id]] and item.id not in meshed
    ]
    others = [item for item in given if role[item.id] is None]
    if not (chosen["mesh"] or outlines):
        chosen["mesh"], more = _first_mesh(others, names.mesh[0])
        notes += more
    taken = {item.id for part in chosen.values() for item in part}
    kinds = Counter(item.kind for item in others if item.id not in taken and item.kind in ("mesh", "curve", *_POINTS))
    if kinds:
        listed = ", ".join(counted(count, kind) for kind, count in sorted(kinds.items()))
        notes.append(f"objects on layers without a role were ignored: {listed}")
    return Selection(**chosen, outlines=outlines, regions=regions, notes=notes)


def _by_kind(given: list[Item], regions: list[Item]) -> Selection:
    shown = [item for item in given if not item.hidden]
    notes = [f"{len(given) - len(shown)} hidden objects were ignored"] if len(shown) < len(given) else []
    mesh, more = _first_mesh(shown, "CGC::Mesh")
    targets = [item for item in shown if _is_target(item)]
    named = {item.id for item in targets}
    supports = [item for item in shown if item.kind in _POINTS and item.id not in named]
    creases = [item for item in shown if item.kind == "curve"]
    outlines = []
    if not mesh:
        # Without a mesh, the largest closed curve is the boundary and closed curves inside it are holes, as in other drawings.
        closed = sorted((item for item in creases if item.geometry.IsClosed), key=_reach)
        holes = [item for item in closed[:-1] if _overlap(item, closed[-1])]
        outlines = [*closed[-1:], *holes]
        creases = [item for item in creases if item not in outlines]
        if holes:
            taken = "the closed curve inside it as a hole" if len(holes) == 1 else f"{len(holes)} closed curves inside it as holes"
            more.append(f"{closed[-1].label} was used as the outline and {taken}; draw closed creases on the layer CGC::Creases")
    return Selection(mesh, supports, creases, targets, [], [], outlines, regions, notes + more)


def _reach(item: Item) -> float:
    box = item.geometry.GetBoundingBox()
    return (box.Max.X - box.Min.X) * (box.Max.Y - box.Min.Y)


def _overlap(item: Item, other: Item) -> bool:
    """Check whether the boxes around two curves overlap in plan."""
    a, b = item.geometry.GetBoundingBox(), other.geometry.GetBoundingBox()
    return all(getattr(a.Min, k) < getattr(b.Max, k) and getattr(b.Min, k) < getattr(a.Max, k) for k in "XY")


def _first_mesh(items: list[Item], layer: str) -> tuple[list[Item], list[str]]:
    for kinds in (("mesh",), _SURFACES):
        found = [item for item in items if item.kind in kinds]
        if len(found) > 1:
            return found[:1], [
                f"{found[0].label} was used, and {len(found) - 1} more ignored; move the meshes of the surface to layer {layer}"
            ]
        if found:
            return found, []
    return [], []


def _is_target(item: Item) -> bool:
    if item.kind == "text dot" and dot_law(item.geometry.Text, named=True) is not None:
        return True
    return item.kind in ("text dot", "point") and user_law(item.text) is not None
