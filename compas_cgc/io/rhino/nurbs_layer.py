"""NURBS surfaces of the regions of a result, with their deviation from the mesh and their curvature."""

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
MAX_CURVATURE_ERROR = 0.01  # relative error of K above which a finer mesh is recommended
FIT_TOLERANCE = 4e-5  # largest distance from the vertices that improves K, relative to the size of the mesh
REFUSED_DISTANCE = 1e-3  # distance from the vertices above which a surface is not written, relative to the size of the mesh
REFUSED_CURVATURE_ERROR = 0.1  # median relative error of K above which a surface is not written


def draw_nurbs(writer: LayerWriter, problem: CGCProblem, unit: str) -> list[str]:
    """Draw an untrimmed NURBS surface for each region and return a note on each.

    A surface that is far from the mesh or from its K is not drawn; the mesh remains.
    """
    layer = writer.layer(NURBS, (70, 100, 150))
    notes = []
    label = problem.regions()
    within = FIT_TOLERANCE * float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    for region in range(label.max(initial=-1) + 1):
        faces = problem.faces[label == region]
        try:
            target = _target(problem, faces)
            fit = fit_region(problem.vertices, faces, K=target, within=within)
            _refuse_poor(fit, target, within / FIT_TOLERANCE, unit)
        except MeshError as error:
            notes.append(f"region {region} could not be fitted: {error}")
            continue
        K = float(np.median(fit.gaussian))
        text = {"region": str(region), "K": repr(K), "deviation": repr(fit.deviation)}
        writer.archive.Objects.AddSurface(nurbs_surface(fit), writer.attributes(layer, f"region {region}", text))
        for edge in fit.edges:
            writer.polyline(edge, writer.attributes(layer, f"edge of region {region}", {"region": str(region)}))
        cut = "; it extends beyond the region: cut it along the edge curves beside it (Rhino: Split)" if fit.edges else ""
        notes.append(f"region {region} as NURBS: K {K:.4g} (median){_off(fit, target)}, within {fit.deviation:.2g}{unit} of the mesh{cut}")
    return notes


def _refuse_poor(fit: FittedSurface, target: Optional[float], size: float, unit: str) -> None:
    """Raise an error if a surface is far from the mesh or from its K."""
    error = _median_error(fit, target)
    if fit.deviation > REFUSED_DISTANCE * size:
        reason = f"the surface is up to {fit.deviation:.3g}{unit} from the mesh"
    elif error > REFUSED_CURVATURE_ERROR:
        reason = f"the K of the surface differs from its target by {100 * error:.3g} % (median)"
    else:
        return
    raise MeshError(f"{reason}; divide the region by creases into parts with four sides, or refine the mesh")


def _median_error(fit: FittedSurface, target: Optional[float]) -> float:
    """Return the median relative error of K, 0 without a target or for K = 0."""
    return float(np.median(np.abs(fit.gaussian / target - 1.0))) if target else 0.0


def _off(fit: FittedSurface, target: Optional[float]) -> str:
    """Return a clause on the error of K of a surface, with a remedy if the error is large."""
    if not target:
        return ""
    off = _median_error(fit, target)
    # Between its vertices, the mesh has K to second order in the edge length only, and less on saddles between domes.
    return f", median error {100 * off:.2g} %" + ("; a finer mesh reduces it" if off > MAX_CURVATURE_ERROR else "")


def _target(problem: CGCProblem, faces: IntArray) -> Optional[float]:
    """Return the target of a region, None if it is not constant."""
    used = np.unique(faces)
    # A vertex on a crease has the target of another region, or NaN.
    targets = np.unique(problem.targets[used[problem.asked[used]]])
    return float(targets[0]) if len(targets) == 1 and np.isfinite(targets[0]) else None


def nurbs_surface(fit: FittedSurface) -> Geometry:
    """Return a fitted surface as a Rhino NURBS surface."""
    rhino3dm = rhino3dm_module()

    a, b, _ = fit.control.shape
    surface = rhino3dm.NurbsSurface.Create(3, False, DEGREE + 1, DEGREE + 1, a, b)
    for i in range(a):
        for j in range(b):
            x, y, z = fit.control[i, j].tolist()
            surface.Points[i, j] = rhino3dm.Point4d(x, y, z, 1.0)
    # Rhino omits the first and the last knot, which do not affect the surface.
    for knots, values in ((surface.KnotsU, fit.knots_u[1:-1]), (surface.KnotsV, fit.knots_v[1:-1])):
        for k, value in enumerate(values.tolist()):
            knots[k] = value
    return surface
