"""NURBS surfaces of the regions of a result, whose sides coincide, with their shared curves."""

from __future__ import annotations

from ...errors import MeshError
from ...fabrication.shell.patches import region_patches
from ...fabrication.shell.regions import region_surfaces
from ...model.counts import counted
from ...model.problem import CGCProblem
from .layers import NURBS
from .nurbs import nurbs_surface
from .write import LayerWriter

__all__ = ["draw_nurbs"]


def draw_nurbs(writer: LayerWriter, problem: CGCProblem, unit: str) -> list[str]:
    """Draw an untrimmed NURBS surface for each region and the curves of its edges, and return a note on them.

    If the surfaces miss their tolerances, none is drawn, the note states the reason, and the mesh remains.
    """
    layer = writer.layer(NURBS, (70, 100, 150))
    try:
        fit = region_surfaces(problem)
        made, sides, errors = region_patches(problem, fit)
    except MeshError as error:
        return [str(error)]
    for region, patch in enumerate(made):
        writer.archive.Objects.AddSurface(nurbs_surface(patch.nurbs), writer.attributes(layer, f"region {region}", {"region": str(region)}))
    for edge, points in zip(fit.edges, sides):
        beside = ", ".join(map(str, edge.regions))
        writer.polyline(fit.centre + fit.scale * points, writer.attributes(layer, f"edge of region {beside}", {"regions": beside}))
    others = [str(region) for region, patch in enumerate(made) if not patch.sides]
    cut = f"; regions without four sides ({', '.join(others)}) extend beyond their edges and are trimmed in .step files" if others else ""
    return [fit.note(errors, 1.0, unit, f"{counted(len(made), 'NURBS surface')}, ", cut)]
