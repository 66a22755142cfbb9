"""Bake: a surface in the Rhino document, its parts on layers with names and user text."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ..._version import __version__
from ...io.rhino.colours import largest
from ...io.rhino.colours import signed_colours
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ...model.problem import CGCProblem
from ..runtime.bake import Bakery
from ..runtime.bake import baking
from ..runtime.bake import is_baked
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.fingerprint import fingerprint
from ..runtime.measured import Measured
from ..runtime.measured import measure
from ..runtime.memories import Memories
from ..runtime.trees import branches_of
from ..runtime.trees import matched
from ..runtime.trees import tree_at
from .regions import part_of

__all__ = ["BakeOutputs", "bake"]

LAYER = "CGC Result"  # same layer as in written files; readers ignore it
SAND, INK, RED = (140, 110, 60), (30, 30, 30), (200, 40, 40)


class BakeOutputs(NamedTuple):
    """Outputs of the component."""

    baked: Any = None


class _Piece(NamedTuple):
    """A mesh to bake."""

    root: str  # parent layer
    problem: CGCProblem
    found: Measured


class _Last(NamedTuple):
    """What a component baked last while `bake` stays true."""

    inputs: str  # fingerprint
    ids: list[str]
    out: BakeOutputs


_LAST: Memories[_Last] = Memories(lambda last: None)


@reports_errors(BakeOutputs, trees=("cgc_mesh", "layer"))
def bake(component: Any, cgc_mesh: Any, layer: Any, bake: Optional[bool]) -> BakeOutputs:
    """Bake all meshes of a data tree with their regions, creases and supports in one undo step.

    They replace all objects that the component baked earlier, also those of branches that no longer exist. While `bake` stays true,
    inputs that have not changed are not baked again.
    """
    matches = matched(branches_of(cgc_mesh), branches_of(layer))
    if not any(mesh is not None for match in matches for mesh, _ in match.rows):
        ask_for(component, "a CGC mesh")
        return BakeOutputs()
    if not bake:
        _LAST.drop(component)
        set_message(component, "set bake to true")
        return BakeOutputs()
    inputs, last = fingerprint(*(row for match in matches for row in match.rows)), _LAST.of(component)
    if last is not None and last.inputs == inputs and is_baked(last.ids):
        return last.out
    pieces = [[None if mesh is None else _piece(mesh, own) for mesh, own in match.rows] for match in matches]
    branches: list[tuple[Any, int, list[Optional[str]]]] = []
    with baking(str(component.InstanceGuid)) as bakery:
        for root in {piece.root: None for row in pieces for piece in row if piece is not None}:
            bakery.layer(root, SAND)  # before anything is deleted, as a name can be invalid
        bakery.clear()
        for match, row in zip(matches, pieces):
            for number, piece in enumerate(row):
                first = len(bakery.baked)
                if piece is not None:
                    _bake(bakery, piece)
                branches.append((match.path, number, [*bakery.baked[first:]] or [None]))
    set_message(component, f"{len(bakery.baked)} objects baked")
    out = BakeOutputs(tree_at(branches))
    _LAST.drop(component)
    _LAST.keep(component, _Last(inputs, bakery.baked, out))
    return out


def _piece(mesh: Any, layer: Optional[str]) -> _Piece:
    return _Piece(layer.strip() if layer and layer.strip() else LAYER, mesh.to_problem().without_dummies(), measure(mesh))


def _bake(bakery: Bakery, piece: _Piece) -> None:
    _bake_surface(bakery, *piece)
    _bake_regions(bakery, *piece)
    _bake_lines(bakery, piece.root, piece.problem)


def _bake_surface(bakery: Bakery, root: str, problem: CGCProblem, found: Measured) -> None:
    K = found.figures["K"]
    text = {"verdict": str(found.report.verdict), "max error": repr(found.report.max_error), "version": __version__}
    colours = signed_colours(K, largest(K))
    bakery.add("Mesh", mesh_from_arrays(problem.vertices, problem.faces, colours), bakery.layer(f"{root}::Mesh", SAND), "surface", text)


def _bake_regions(bakery: Bakery, root: str, problem: CGCProblem, found: Measured) -> None:
    on, label = bakery.layer(f"{root}::Regions", SAND), problem.regions()
    for region in found.report.regions:
        figures = {"K": region.target, "K reached": region.total_curvature, "error": region.max_error, "area": region.area}
        text = {"region": str(region.region), **{name: repr(value) for name, value in figures.items() if value is not None}}
        part = part_of(problem.vertices, problem.faces[label == region.region])
        bakery.add("Mesh", mesh_from_arrays(*part), on, f"region {region.region}", text)


def _bake_lines(bakery: Bakery, root: str, problem: CGCProblem) -> None:
    creases = [problem.vertices[path] for path in problem.crease_paths()]
    if creases:
        on = bakery.layer(f"{root}::Creases", INK)
        for number, points in enumerate(creases):
            bakery.add("Curve", polyline_to_rhino(points), on, f"crease {number}", {})
    if len(problem.supports):
        on = bakery.layer(f"{root}::Supports", RED)
        for vertex, point in zip(problem.supports.tolist(), points_to_rhino(problem.vertices[problem.supports])):
            bakery.add("Point", point, on, f"support {vertex}", {})
