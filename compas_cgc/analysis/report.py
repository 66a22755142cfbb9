"""Analysis report: curvature errors by region, mesh quality and rounding floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..discrete import angle_defects
from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete import vertex_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import PerVertex
from ..discrete.arrays import Vertices
from ..discrete.corners import corner_angles
from ..errors import names_what_was_meant
from ..meshing import vertex_labels
from ..model.law_errors import law_errors
from ..model.measures import measure_of
from ..model.measures import measured_curvature
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from ..model.roles import INTERNAL
from ..model.verdict import Verdict
from ..model.verdict import verdict
from .quadric import quadric_curvatures

__all__ = ["MeshQuality", "RegionReport", "SurfaceReport", "analyse"]


@dataclass(frozen=True)
class RegionReport:
    """Report on one region; figures are ``None`` without internal vertices.

    Parameters
    ----------
    region
        Number of the region.
    faces
        Number of faces.
    area
        Area [L^2].
    asked
        Number of internal vertices.
    target
        K̄, None if it is not one number [1/L^2].
    max_error
        Largest |K - K̄| where K is read: with mid-edge normals more than two edges from supports [1/L^2].
    rms_error
        Root mean square of K - K̄ there [1/L^2].
    total_curvature
        Sum of angle defects over sum of vertex areas [1/L^2].
    quadric_median
        Median K of local quadric fits [1/L^2].
    quadric_low
        First decile of the same [1/L^2].
    quadric_high
        Last decile of the same [1/L^2].
    principal_max
        Largest principal curvature of the fits [1/L].
    principal_min
        Smallest principal curvature of the fits [1/L].
    concave_edges
        Number of edges inside the region that fold inwards.
    law
        Law of the region if it is not constant K; the errors are then its residuals, in its units.

    Examples
    --------
    >>> import compas_cgc
    >>> report = compas_cgc.analyse(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))))
    >>> report.regions[0].target, report.regions[0].faces
    (0.02, 432)
    """

    region: int
    faces: int
    area: float  # [L^2]
    asked: int  # number of internal vertices
    target: Optional[float]  # K̄, None if it is not one number [1/L^2]
    max_error: Optional[float]  # largest |K - K̄| where K is read [1/L^2]
    rms_error: Optional[float]  # root mean square of K - K̄ there [1/L^2]
    total_curvature: Optional[float]  # sum of angle defects over sum of vertex areas [1/L^2]
    quadric_median: Optional[float]  # median K of local quadric fits [1/L^2]
    quadric_low: Optional[float]  # first decile of the same [1/L^2]
    quadric_high: Optional[float]  # last decile of the same [1/L^2]
    principal_max: Optional[float]  # largest principal curvature of the fits [1/L]
    principal_min: Optional[float]  # smallest principal curvature of the fits [1/L]
    concave_edges: int  # number of edges inside the region that fold inwards
    law: Optional[str] = None  # other than constant K; the errors are then the residuals of the law, in its units


@dataclass(frozen=True)
class MeshQuality:
    """Quality of the mesh of a surface.

    Parameters
    ----------
    vertices
        Number of vertices.
    faces
        Number of faces.
    regular
        Share of the inner vertices with valence 6.
    smallest_angle
        Smallest angle of a triangle [degree].
    largest_angle
        Largest angle of a triangle [degree].
    shortest_edge
        Length of the shortest edge [L].
    longest_edge
        Length of the longest edge [L].
    rounding_floor
        Accuracy limit of K due to rounding: machine epsilon over the smallest vertex area [1/L^2].

    Examples
    --------
    >>> import compas_cgc
    >>> report = compas_cgc.analyse(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> report.quality.faces, round(report.quality.regular, 2)
    (432, 1.0)
    """

    vertices: int
    faces: int
    regular: float  # share of the inner vertices with valence 6
    smallest_angle: float  # [degree]
    largest_angle: float  # [degree]
    shortest_edge: float  # [L]
    longest_edge: float  # [L]
    rounding_floor: float  # machine epsilon over the smallest vertex area [1/L^2]


@dataclass(frozen=True)
class SurfaceReport:
    """Report on a surface and its targets.

    Parameters
    ----------
    verdict
        Whether the surface is fair or rough.
    measure
        Measure of K in the errors.
    other_measures
        Largest |K - K̄| by other measures [1/L^2].
    regions
        Reports on the regions, in their order.
    quality
        Quality of the mesh.
    max_error
        Largest |K - K̄| of all regions [1/L^2].
    moved_max
        Largest displacement of a vertex from the reference [L].
    moved_mean
        Mean displacement [L].

    Examples
    --------
    >>> import compas_cgc
    >>> report = compas_cgc.analyse(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))))
    >>> str(report).splitlines()[0]
    'the surface is fair'
    """

    verdict: Verdict  # whether it is fair or rough
    measure: str  # measure of K in the errors
    other_measures: dict[str, float]  # largest |K - K̄| by other measures [1/L^2]
    regions: list[RegionReport]
    quality: MeshQuality
    max_error: float  # largest |K - K̄| of all regions [1/L^2]
    moved_max: Optional[float]  # largest displacement from the reference [L]
    moved_mean: Optional[float]  # mean displacement [L]

    def to_dict(self) -> dict:
        """Return a dict that can be written as JSON."""
        return {**asdict(self), "verdict": self.verdict.to_dict()}

    def __str__(self) -> str:
        heads = ["region", "faces", "area", "target", "max error", "rms error", "total", "quadric fit", "concave edges"]
        rows = [
            [
                str(r.region),
                str(r.faces),
                f"{r.area:.5g}",
                _number(r.target, r.law or ("mixed" if r.asked else "-")),
                _number(r.max_error, form=".2e"),
                _number(r.rms_error, form=".2e"),
                _number(r.total_curvature),
                f"{_number(r.quadric_median)} ({_number(r.quadric_low)} .. {_number(r.quadric_high)})" if r.asked else "-",
                str(r.concave_edges),
            ]
            for r in self.regions
        ]
        q = self.quality
        others = ", ".join(f"{name} {error:.3g}" for name, error in self.other_measures.items())
        lines = [
            f"the surface is {self.verdict}",
            *_columns([heads, *rows]),
            f"mesh: {q.vertices} vertices, {q.faces} faces, {100 * q.regular:.0f} % of the inner vertices regular, "
            f"angles {q.smallest_angle:.1f} to {q.largest_angle:.1f} degrees, edges {q.shortest_edge:.4g} to {q.longest_edge:.4g}",
            f"K by the measure {self.measure}" + (f"; largest error by other measures: {others}" if others else ""),
            f"rounding limits the accuracy of K on this mesh to {q.rounding_floor:.1e}",
        ]
        if self.moved_max is not None:
            lines.append(f"moved by {self.moved_max:.4g} at most, {self.moved_mean:.4g} on average")
        return "\n".join(lines)


@names_what_was_meant()
def analyse(surface: PosesProblem, reference: Optional[PosesProblem] = None, *, others: bool = True) -> SurfaceReport:
    """Return a report on the curvature errors and the mesh of a surface.

    Parameters
    ----------
    surface
        A result, mesh or problem with targets; dummies are ignored. K of a solved surface is read in the measure of
        its solve, that of others by mid-edge normals, or in the smooth measure where the whole rim is fixed and K̄ > 0.
        Mid-edge normals read K more than two edges from supports, beside which the exact surface may be singular.
    reference
        The input of the solve, for displacements.
    others
        Whether to compute errors by other measures too, which doubles the run time.

    Returns
    -------
    SurfaceReport
        ``str(report)`` is a readable table; ``to_dict`` returns plain data.

    Raises
    ------
    ValueError
        If the reference has a different number of vertices.

    Examples
    --------
    >>> import compas_cgc
    >>> report = compas_cgc.analyse(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))))
    >>> report.verdict.fair, len(report.regions), report.max_error < 1e-9
    (True, 1, True)
    """
    problem = problem_of(surface, "or the result of a solve is analysed").without_dummies()
    measure = measure_of(problem)
    V, F = problem.vertices, problem.faces
    before = None if reference is None else problem_of(reference, "is a reference").without_dummies().vertices
    if before is not None and before.shape != V.shape:
        raise ValueError(f"the reference has {len(before)} vertices, but the surface has {len(V)}; give the input of the solve")
    moved = None if before is None else np.linalg.norm(V - before, axis=1)
    regions = _regions(problem, problem.regions(), problem.creases, measured_curvature(problem, measure))
    errors = {
        name: _largest(measured_curvature(problem, name) - problem.targets) for name in ("defect", "smooth") if others and name != measure
    }
    return SurfaceReport(
        getattr(surface, "verdict", None) or verdict(problem, before),
        measure,
        errors,
        regions,
        _quality(V, F, problem.asked),
        max((r.max_error for r in regions if r.max_error is not None and r.law is None), default=0.0),
        None if moved is None else float(moved.max(initial=0.0)),
        None if moved is None else float(moved.mean()),
    )


def _regions(problem: CGCProblem, label: IntArray, creases: Edges, K: PerVertex) -> list[RegionReport]:
    V, F, asked = problem.vertices, problem.faces, problem.roles == INTERNAL
    defect, cell, area = angle_defects(V, F), vertex_areas(V, F), face_areas(V, F)
    fitted = quadric_curvatures(V, F, wanted=asked, through=asked)
    region = vertex_labels(len(V), F, label)
    concave = _concave_edges(V, F, label, creases)
    of_laws = {found.region: found for found in law_errors(problem)}
    reports = []
    for number in range(label.max(initial=-1) + 1):
        own = asked & (region == number)
        targets = np.unique(problem.targets[own])
        error = of_laws[number].residuals if number in of_laws else (K - problem.targets)[own & np.isfinite(K)]
        fit = fitted.gaussian[own & np.isfinite(fitted.gaussian)]
        some, fits = error.size > 0, fit.size > 0
        low, middle, high = np.percentile(fit, [10, 50, 90]).tolist() if fits else (None, None, None)
        reports.append(
            RegionReport(
                region=number,
                faces=int((label == number).sum()),
                area=float(area[label == number].sum()),
                asked=int(own.sum()),
                target=float(targets[0]) if len(targets) == 1 and np.isfinite(targets[0]) else None,
                max_error=float(np.abs(error).max()) if some else None,
                rms_error=float(np.sqrt(np.mean(error**2))) if some else None,
                total_curvature=float(defect[own].sum() / cell[own].sum()) if some else None,
                quadric_median=middle,
                quadric_low=low,
                quadric_high=high,
                principal_max=float(np.nanmax(fitted.largest[own])) if fits else None,
                principal_min=float(np.nanmin(fitted.smallest[own])) if fits else None,
                concave_edges=int((concave == number).sum()),
                law=str(of_laws[number].law) if number in of_laws else None,
            )
        )
    return reports


def _concave_edges(V: Vertices, F: Faces, label: IntArray, creases: Edges) -> IntArray:
    """Return the region of every edge inside a region that folds inwards by more than rounding."""
    edges = edge_faces(F)
    edges = edges[edges[:, 3] >= 0]
    n = len(V)
    code = np.sort(edges[:, :2], axis=1) @ [n, 1]
    edges = edges[~np.isin(code, np.sort(creases, axis=1) @ [n, 1])]
    u, v, left, right = edges.T
    normals = face_normals(V, F)
    sine = np.einsum("ij,ij->i", np.cross(normals[left], normals[right]), V[v] - V[u])
    return label[left[sine < -1e-9 * np.linalg.norm(V[v] - V[u], axis=1)]]


def _quality(V: Vertices, F: Faces, asked: Mask) -> MeshQuality:
    corners = V[F]
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    angle = np.degrees(corner_angles(V, F))
    valence = np.bincount(F.ravel(), minlength=len(V))
    cell = vertex_areas(V, F)
    inner = asked if asked.any() else cell > 0
    return MeshQuality(
        vertices=len(V),
        faces=len(F),
        regular=float((valence[inner] == 6).mean()),
        smallest_angle=float(angle.min()),
        largest_angle=float(angle.max()),
        shortest_edge=float(length.min()),
        longest_edge=float(length.max()),
        rounding_floor=float(np.finfo(float).eps / cell[inner].min()),
    )


def _largest(errors: PerVertex) -> float:
    return float(np.abs(errors[np.isfinite(errors)]).max(initial=0.0))


def _number(value: Optional[float], otherwise: str = "-", form: str = ".5g") -> str:
    return otherwise if value is None else format(value, form)


def _columns(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
