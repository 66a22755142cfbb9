"""Regions of a result as NURBS surfaces, each with its distance from the mesh and the K of the surface itself."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...analysis._splines import DEGREE
from ...analysis.nurbs import FittedSurface
from ...analysis.nurbs import fit_region
from ...discrete.arrays import IntArray
from ...errors import MeshError
from ...model.problem import CGCProblem
from ._types import Geometry
from .archive import rhino3dm_module
from .write import LayerWriter

__all__ = ["NURBS", "draw_nurbs", "nurbs_surface"]

NURBS = "CGC::NURBS"
ASTRAY = 0.01  # of K, from which on a surface is farther from it than it should be
OFF = 4e-5  # of the size of the mesh: what a surface may be off its vertices for the sake of its K


def draw_nurbs(writer: LayerWriter, problem: CGCProblem, unit: str) -> list[str]:
    """Draw an untrimmed NURBS surface for each region, side by side along the creases, and return a sentence on each."""
    layer = writer.layer(NURBS, (70, 100, 150))
    notes = []
    label = problem.regions()
    within = OFF * float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    for region in range(label.max(initial=-1) + 1):
        faces = problem.faces[label == region]
        try:
            target = _target(problem, faces)
            fit = fit_region(problem.vertices, faces, K=target, within=within)
        except MeshError as error:
            notes.append(f"region {region} was not fitted: {error}")
            continue
        K = float(np.median(fit.gaussian))
        text = {"region": str(region), "K": repr(K), "deviation": repr(fit.deviation)}
        writer.archive.Objects.AddSurface(nurbs_surface(fit), writer.attributes(layer, f"region {region}", text))
        for edge in fit.edges:
            writer.polyline(edge, writer.attributes(layer, f"edge of region {region}", {"region": str(region)}))
        cut = "; it overhangs, cut it along the edge curves beside it (Rhino: Split)" if fit.edges else ""
        notes.append(f"region {region} as NURBS: K {K:.4g} (median){_off(fit, target)}, within {fit.deviation:.2g}{unit} of the mesh{cut}")
    return notes


def _off(fit: FittedSurface, target: Optional[float]) -> str:
    """Return how far the K of a surface is from that asked for, and what helps where that is more than it should be."""
    if not target:
        return ""
    off = float(np.median(np.abs(fit.gaussian / target - 1.0)))
    # Between its vertices a mesh has its K to the square of its edges only, saddles between domes to less.
    return f", {100 * off:.2g} % off in the median" + ("; a finer mesh has it nearer" if off > ASTRAY else "")


def _target(problem: CGCProblem, faces: IntArray) -> Optional[float]:
    """Return the K asked for in a region, or None where it is not one number."""
    used = np.unique(faces)
    # On a crease a vertex has the target of another region, or none.
    targets = np.unique(problem.targets[used[problem.asked[used]]])
    return float(targets[0]) if len(targets) == 1 and np.isfinite(targets[0]) else None


def nurbs_surface(fit: FittedSurface) -> Geometry:
    """Return a fitted surface as one of Rhino."""
    rhino3dm = rhino3dm_module()

    a, b, _ = fit.control.shape
    surface = rhino3dm.NurbsSurface.Create(3, False, DEGREE + 1, DEGREE + 1, a, b)
    for i in range(a):
        for j in range(b):
            x, y, z = fit.control[i, j].tolist()
            surface.Points[i, j] = rhino3dm.Point4d(x, y, z, 1.0)
    # Rhino leaves out the first and the last knot, which no point of the surface depends on.
    for knots, values in ((surface.KnotsU, fit.knots_u[1:-1]), (surface.KnotsV, fit.knots_v[1:-1])):
        for k, value in enumerate(values.tolist()):
            knots[k] = value
    return surface
