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
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.measured import Measured
from ..runtime.measured import measure
from .regions import part_of

__all__ = ["BakeOutputs", "bake"]

LAYER = "CGC Result"  # same layer as in written files; readers ignore it
SAND, INK, RED = (140, 110, 60), (30, 30, 30), (200, 40, 40)


class BakeOutputs(NamedTuple):
    """Outputs of the component."""

    baked: Optional[list[str]] = None


@reports_errors(BakeOutputs)
def bake(component: Any, cgc_mesh: Any, layer: Optional[str], bake: Optional[bool]) -> BakeOutputs:
    """Bake a mesh, its regions, creases and supports; replaces the objects that this branch baked earlier."""
    if cgc_mesh is None:
        ask_for(component, "a CGC mesh")
        return BakeOutputs()
    if not bake:
        set_message(component, "set bake to true")
        return BakeOutputs()
    problem = cgc_mesh.to_problem().without_dummies()
    found = measure(cgc_mesh)
    root = layer.strip() if layer and layer.strip() else LAYER
    # Each branch replaces its own earlier objects only.
    run = int(getattr(component, "RunCount", 1))
    with baking(str(component.InstanceGuid) if run <= 1 else f"{component.InstanceGuid} {run}") as bakery:
        bakery.clear()
        _bake_surface(bakery, root, problem, found)
        _bake_regions(bakery, root, problem, found)
        _bake_lines(bakery, root, problem)
    set_message(component, f"{len(bakery.baked)} objects baked")
    return BakeOutputs(bakery.baked)


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
