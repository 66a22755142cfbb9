"""Smooth surfaces of all regions at once: heights over a plane for each region, equal along the edges that regions share.

Heights are tensor-product splines. Gauss-Newton minimises the error of K at points of all faces, the distance from the vertices
and edges, the gaps along shared edges, the kinks along smooth ones and the roughness. The regions are fitted together, so that
neighbours meet along one curve, with small kinks along seams that are meant to be smooth.
"""

from __future__ import annotations

from typing import Any
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.interpolate import CubicSpline
from scipy.optimize import linprog
from scipy.spatial import cKDTree

from ...discrete import face_normals
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import MeshError
from ...linalg import linear_solver
from ...model.lengths import place_text
from ...model.problem import CGCProblem
from .edges import RegionEdge
from .edges import region_edges
from .heights import SECOND_ORDERS
from .heights import HeightSpace
from .heights import curvature
from .joints import Joined
from .joints import Joints
from .joints import Region
from .singular import singular_vertices

__all__ = ["AIM", "AWAY_FROM", "CLOSE", "LOOSE", "AccuracyNote", "Fit", "Piece", "distances", "fitted", "reference", "samples"]

MIN_COSINE = 0.05  # least cosine between the face normals of a region and its direction of projection
LEVEL_COSINE = 0.6  # least cosine for a projection along the mean normal
DISTANCE = 7e-5  # distance of a vertex or an edge, relative to the size, that costs as much as CURVATURE_ERROR
CURVATURE_ERROR = 0.003  # error of K relative to its target
CURVATURE_FLOOR = 0.02  # smallest reference for errors of K, for a surface of size 1
REGION_FLOOR = 0.005  # the same for a region of size 1, whose development such an error of K strains by about 2e-4
MAX_SEAM_KINK = np.radians(3.0)  # median kink of an edge up to which regions are meant to meet smoothly; a larger one is a crease
KINK = np.radians(0.35)  # kink at a smooth edge that costs as much as CURVATURE_ERROR
ROUGHNESS = 1e-10  # weight of the squared third derivative for edges of length 1
START_ROUGHNESS = 1e-4  # the same for the initial surface through the vertices
# Least distance from singular vertices up to which the weight of K is reduced, relative to the size. Beside straight held edges with
# K > 0, K of the mesh itself is off within a length that does not shrink with its edges.
SINGULAR_LENGTH = 0.04
MARGIN_POWER = 8.0  # high enough that K nearly counts only where its error is measured
CROSSING_MARGIN = 0.5  # distance from points where three or more regions meet with the same effect, in mesh edges
# Factors on DISTANCE, errors of K in units of CURVATURE_ERROR beyond which they are outliers, and gaps that cost as much as DISTANCE,
# relative to it.
CLOSE = (
    (16.0, np.inf, 1e-1),
    (8.0, np.inf, 3e-2),
    (4.0, np.inf, 1e-2),
    (2.0, 300.0, 3e-3),
    (1.0, 100.0, 1e-3),
    *((1.0, 50.0, 1e-3),) * 4,
    *((1.0, 20.0, 1e-4),) * 4,
    *((1.0, 20.0, 3e-5),) * 3,
)
# For meshes that are farther from a surface with exact K.
LOOSE = (
    *((16.0, np.inf, 1e-1),) * 2,
    (8.0, np.inf, 3e-2),
    (4.0, np.inf, 1e-2),
    *((4.0, np.inf, 1e-3),) * 6,
    *((4.0, 100.0, 1e-4),) * 4,
    *((4.0, 100.0, 3e-5),) * 3,
)
Stages = tuple[tuple[float, float, float], ...]
MEASURED_GAP = 1e-3  # relative gap of the stages whose surfaces are candidates
MAX_DISTANCE = 5e-4  # tolerance of the distance of vertices and edges relative to the size
COARSE_DISTANCE = 1e-3  # the largest one, for meshes whose faces are as far from the surface
MAX_GAP = 1e-6  # tolerance of the gap between neighbours relative to the size
GAP_AIM = 4e-7  # the same gap, below which surfaces are compared by their K: .01 mm for a roof of 25 m
MAX_KINK = 2.0  # tolerance of the kink at smooth edges, 95th percentile [deg]
MAX_CURVATURE_ERROR = 0.1  # tolerance of the error of K, 95th percentile away from singular vertices
AIM = 0.02  # the same error, below which surfaces are compared by their distance and gap too
AWAY = 2.0  # distance from singular vertices, in mesh edges, beyond which the error of K counts
AWAY_FROM = "away from supports and singular edges"  # in words
DAMPING = 1e-6  # relative to the mean of the diagonal
SAMPLES_PER_EDGE = 4  # points of a shared edge per mesh edge
MARGIN = 2.5  # distance from singular vertices, in mesh edges, up to which the weight of K is reduced


class Piece(NamedTuple):
    """The fitted surface of a region, in a frame of unit size."""

    axes: FloatArray  # (3, 3) rows: two axes of the plane and the direction of the heights
    space: HeightSpace
    coefficients: FloatArray  # (a b,)

    def local(self, points: FloatArray) -> FloatArray:
        """Return points (k, 3) in the axes of the plane."""
        return points @ self.axes.T

    def lifted(self, xy: FloatArray) -> FloatArray:
        """Return the points (k, 3) of the surface over points of the plane (k, 2)."""
        return np.column_stack([xy, self.space.basis(xy) @ self.coefficients]) @ self.axes

    def gaussian(self, xy: FloatArray) -> FloatArray:
        """Return K (k,) over points of the plane (k, 2)."""
        return curvature(*(self.space.basis(xy, order) @ self.coefficients for order in SECOND_ORDERS)).K


class AccuracyNote(str):
    """A sentence on the accuracy of smooth surfaces, with its figures.

    Parameters
    ----------
    text
        The sentence.
    figures
        ``surfaces`` (their number), ``unit``, ``gap`` and ``distance`` in it, ``curvature_error`` relative to the target and ``kinks``
        [deg] by percentile, and ``kinks_at_seams``, the largest first: the ``regions`` on both sides, ``median`` and ``largest`` [deg], and
        the ``place`` of the largest.
    """

    figures: dict[str, Any]

    def __new__(cls, text: str, figures: dict[str, Any]) -> AccuracyNote:
        """Return the note."""
        note = super().__new__(cls, text)
        note.figures = figures
        return note

    def __reduce__(self) -> tuple[Any, ...]:
        return AccuracyNote, (str(self), self.figures)


class Fit(NamedTuple):
    """The fitted surfaces of all regions, in a frame of unit size."""

    pieces: list[Piece]
    centre: FloatArray  # (3,) of the frame [L]
    scale: float  # size of the surface [L]
    edges: list[RegionEdge]
    curves: list[FloatArray]  # (k, 3) points of every edge on its first surface, in the frame
    gap: float  # largest distance of the second surface from the points of a shared edge, and of the ends of edges at a vertex [L]
    kinks: FloatArray  # (n,) angles between the normals at the points of shared edges that are meant to be smooth [deg]
    kink_edges: IntArray  # (n,) edge of each of these points
    kink_points: FloatArray  # (n, 3) the points, in the frame
    distance: float  # largest distance of a vertex, or of a point of an edge between vertices, from its surface [L]
    sagitta: float  # largest distance of a face from the surface over it, away from singular vertices [L]
    errors: FloatArray  # (m,) error of K at the face centres relative to its target, NaN where no K is prescribed
    singular: FloatArray  # (k, 3) vertices at which the curvature has no bound, in the frame
    away: IntArray  # faces away from them

    def percentiles(self) -> FloatArray:
        """Return the 50th, 95th and 100th percentile of the error of K away from singular vertices, relative to its target (3,)."""
        errors = self.errors[self.away]
        errors = errors[np.isfinite(errors)]
        return np.percentile(errors, [50, 95, 100]) if len(errors) else np.zeros(3)

    def kink_percentiles(self) -> FloatArray:
        """Return the 50th, 95th and 100th percentile of the kinks at smooth edges (3,) [deg]."""
        return np.percentile(self.kinks, [50, 95, 100]) if len(self.kinks) else np.zeros(3)

    @property
    def reach(self) -> float:
        """Tolerance of the distance of vertices and edges [L], larger for coarse meshes, which are inaccurate themselves."""
        return max(MAX_DISTANCE * self.scale, min(self.sagitta, COARSE_DISTANCE * self.scale))

    def rank(self) -> tuple[float, bool, float, bool, float]:
        """Return a key that is smallest for the best of several fits: tolerances first, then gap and error of K down to their aims."""
        wide, far = self.gap > GAP_AIM * self.scale, self.distance > MAX_DISTANCE * self.scale
        return max(self.shortfall(), 1.0), wide, max(float(self.percentiles()[1]), AIM), far, self.shortfall()

    def meets_aims(self) -> bool:
        """Check whether all tolerances are met, and the aims for the gap and for the error of K."""
        return self.rank()[:3] == (1.0, False, AIM)

    def shortfall(self) -> float:
        """Return the largest of distance, gap, kink and error of K (95th percentiles), each relative to its tolerance."""
        gap, curvature_error = self.gap / (MAX_GAP * self.scale), float(self.percentiles()[1]) / MAX_CURVATURE_ERROR
        return max(self.distance / self.reach, gap, curvature_error, float(self.kink_percentiles()[1]) / MAX_KINK)

    def accuracy(self, errors: FloatArray, factor: float, unit: str) -> str:
        """Return gaps and distances, multiplied by a factor, kinks, and percentiles of the error of K (3,), as a phrase."""
        half, most, largest = (100.0 * errors).tolist()
        text = f"{factor * self.gap:.2g}{unit} apart at most, within {factor * self.distance:.3g}{unit} of the mesh; "
        if len(self.kinks):
            text += "kinks at smooth seams {:.2g} (50 %), {:.2g} (95 %), {:.2g} degrees (100 %); ".format(*self.kink_percentiles())
        return text + f"error of K {AWAY_FROM} {half:.2g} % (50 %), {most:.2g} % (95 %), {largest:.2g} % (100 %)"

    def note(self, errors: FloatArray, factor: float, unit: str, before: str, after: str = "") -> AccuracyNote:
        """Return a note on the accuracy, as a sentence and as figures for errors of K (3,); lengths are multiplied by a factor."""
        percent = ("50", "95", "100")
        seams = []
        for number in np.unique(self.kink_edges).tolist():
            own = np.flatnonzero(self.kink_edges == number)
            worst = own[np.argmax(self.kinks[own])]
            place = factor * (self.centre + self.scale * self.kink_points[worst])
            degrees = {"median": float(np.median(self.kinks[own])), "largest": float(self.kinks[worst])}
            seams.append({"regions": list(self.edges[number].regions), **degrees, "place": place.tolist()})
        figures = {
            "surfaces": len(self.pieces),
            "unit": unit.strip(),
            "gap": factor * self.gap,
            "distance": factor * self.distance,
            "curvature_error": dict(zip(percent, np.asarray(errors).tolist())),
            "kinks": dict(zip(percent, self.kink_percentiles().tolist())),
            "kinks_at_seams": sorted(seams, key=lambda seam: -seam["largest"]),
        }
        return AccuracyNote(before + self.accuracy(errors, factor, unit) + after, figures)


def fitted(problem: CGCProblem, cell: float, rows: int, stages: Stages) -> Fit:
    """Return smooth surfaces near all regions of a solved mesh, with shared edges.

    Parameters
    ----------
    problem
        The solved problem.
    cell
        Length of the spans of the splines relative to the mean edge length.
    rows
        Rows of points in every face at which K is prescribed; splines with few points per span have another K between them.
    stages
        Weights of the Gauss-Newton steps.

    Raises
    ------
    MeshError
        If a region is not a graph over a plane.
    """
    return _System(problem, cell, rows).solved(stages)


class _Region(NamedTuple):
    used: IntArray  # its vertices
    faces: Faces
    plan: FloatArray  # (n, 3) all vertices in its axes
    splines: Region


class _System:
    """The equations of a fit."""

    def __init__(self, problem: CGCProblem, cell: float, rows: int):
        V, F = problem.vertices, problem.faces
        self.problem, self.label = problem, problem.regions()
        self.centre, self.scale = V.mean(axis=0), float(np.linalg.norm(np.ptp(V, axis=0)))
        self.V = (V - self.centre) / self.scale
        self.edge = float(np.linalg.norm(self.V[F[:, 1]] - self.V[F[:, 0]], axis=1).mean())
        self.edges = region_edges(self.V, F, self.label)
        self.singular_vertices = singular_vertices(problem)
        self.singular = self.V[self.singular_vertices]
        self.lines = [samples(self.V[edge.path]) for edge in self.edges]
        self.regions = self._regions(cell)
        self.size = sum(region.splines.space.size for region in self.regions)
        self.joints = Joints([region.splines for region in self.regions], self.edges, self.lines, self._directions(), self.size)
        self._tether()
        self._curvature(_face_points(rows), max(MARGIN * self.edge, SINGULAR_LENGTH))
        self._centres()
        rough = sparse.vstack(self._stack(lambda region: region.splines.space.roughness())).tocsr()
        self.rough = rough.T @ rough

    def _regions(self, cell: float) -> list[_Region]:
        regions, start = [], 0
        normals = face_normals(self.V, self.problem.faces)
        for number in range(self.label.max(initial=-1) + 1):
            faces = self.problem.faces[self.label == number]
            axes = _axes(self.V[np.unique(faces)], normals[self.label == number])
            if axes is None:
                raise MeshError(self._why_no_graph(faces, normals[self.label == number], number))
            plan = self.V @ axes.T
            own = np.concatenate(
                [plan[np.unique(faces)]] + [line @ axes.T for e, line in zip(self.edges, self.lines) if number in e.regions]
            )
            # Edges move within the tolerance of the distance, and stay inside the rectangle.
            low, high = own[:, :2].min(axis=0) - COARSE_DISTANCE, own[:, :2].max(axis=0) + COARSE_DISTANCE
            space = HeightSpace.over(low, high, cell * self.edge)
            regions.append(_Region(np.unique(faces), faces, plan, Region(axes, space, start)))
            start += space.size
        return regions

    def _directions(self) -> list[FloatArray]:
        """Return the directions in which points of edges are moved onto the surfaces (n, 3): at ends, the mean of those of all regions."""
        ends: dict[int, set[int]] = {}
        for edge in self.edges:
            for vertex in edge.path[[0, -1]].tolist():
                ends.setdefault(vertex, set()).update(edge.regions)
        means = {vertex: np.mean([self.regions[k].splines.axes[2] for k in own], axis=0) for vertex, own in ends.items()}
        found = []
        for edge, line in zip(self.edges, self.lines):
            first, last = (means[vertex] for vertex in edge.path[[0, -1]].tolist())
            along = first + np.linspace(0.0, 1.0, len(line))[:, None] * (last - first)
            found.append(along / np.linalg.norm(along, axis=1, keepdims=True))
        return found

    def _why_no_graph(self, faces: Faces, normals: FloatArray, number: int) -> str:
        """Return the reason why a region with face normals (k, 3) is not a graph over a plane, and the remedy."""
        cosines = normals @ normals.sum(axis=0) / np.linalg.norm(normals.sum(axis=0))
        if not np.isin(faces[cosines < MIN_COSINE], self.singular_vertices).any(axis=1).all():
            return f"region {number} closes or folds over, so it is no surface over a plane; divide it by a crease"
        steepest = self.V[faces[np.argmin(cosines)]].mean(axis=0)
        place = place_text(self.centre + self.scale * steepest, self.scale)
        return (
            f"region {number} is vertical or overhangs beside a support at {place}, so it is no surface over a plane; with K > 0 the slope "
            "beside a straight support grows as the mesh is refined, so use longer mesh edges, or divide the region by a crease"
        )

    def _stack(self, rows: Callable[[_Region], sparse.csr_matrix]) -> list[sparse.csr_matrix]:
        return [region.splines.placed(rows(region), self.size) for region in self.regions]

    def _tether(self) -> None:
        """Prepare the distance from vertices, and from points of edges between them, where little else holds a surface."""
        self.guides, counts = [], []
        for number, own in enumerate(self.regions):
            edges = [line @ own.splines.axes.T for edge, line in zip(self.edges, self.lines) if number in edge.regions]
            self.guides.append(np.concatenate([own.plan[own.used], *edges]))
            counts.append(np.full(len(self.guides[-1]), 1.0 / SAMPLES_PER_EDGE))
            counts[-1][: len(own.used)] = 1.0
        plans = [guides[:, :2] for guides in self.guides]
        self.near, *self.slopes = (self._basis(plans, order) for order in ((0, 0), (1, 0), (0, 1)))
        self.heights, self.counts = np.concatenate(self.guides)[:, 2], np.concatenate(counts)

    def _basis(self, plans: list[FloatArray], order: tuple[int, int]) -> sparse.csr_matrix:
        """Return basis functions, or their derivatives, at points (k, 2) of the planes of all regions in turn."""
        rows = [own.splines.placed(own.splines.space.basis(xy, order), self.size) for own, xy in zip(self.regions, plans)]
        return sparse.vstack(rows).tocsr()

    def _curvature(self, inside: FloatArray, margin: float) -> None:
        """Prepare K at points (p, 3) of all faces, in barycentric coordinates; basis functions and derivatives have one sparsity."""
        targets = [np.nan if K is None else K * self.scale**2 for K in self.problem.region_targets()]
        floors = [reference(K, own.plan[own.used], 1.0) for own, K in zip(self.regions, targets)]
        places = [np.einsum("pc,fcx->fpx", inside, own.plan[own.faces][:, :, :2]).reshape(-1, 2) for own in self.regions]
        self.parts = [self._basis(places, order) for order in SECOND_ORDERS]
        self.target, self.reference = (np.repeat(own, [len(xy) for xy in places]) for own in (targets, floors))
        points = np.concatenate([np.einsum("pc,fcx->fpx", inside, self.V[own.faces]).reshape(-1, 3) for own in self.regions])
        weight = np.minimum(1.0, distances(points, self.singular) / margin) ** MARGIN_POWER
        around: dict[int, set[int]] = {}
        for edge in self.edges:
            for end in edge.path[[0, -1]].tolist():
                around.setdefault(end, set()).update(edge.regions)
        crossings = [vertex for vertex, regions in around.items() if len(regions) > 2]
        if crossings:
            near = distances(points, self.V[crossings]) / (CROSSING_MARGIN * self.edge)
            weight = np.minimum(weight, np.minimum(1.0, near) ** MARGIN_POWER)
        self.curved = np.where(np.isfinite(self.target), weight, 0.0) / len(points)

    def _centres(self) -> None:
        """Prepare the surface at the centres of all faces, region by region."""
        self.order = np.argsort(self.label, kind="stable")
        centres = [own.plan[own.faces].mean(axis=1)[:, :2] for own in self.regions]
        self.middle, *self.bends = (self._basis(centres, order) for order in ((0, 0), *SECOND_ORDERS))
        first = np.cumsum([0, *map(len, self.guides)])
        self.corners = np.concatenate([start + np.searchsorted(own.used, own.faces) for start, own in zip(first, self.regions)])

    def errors(self, x: FloatArray) -> FloatArray:
        """Return the error of K at the face centres (m,) relative to its target."""
        points = len(self.target) // len(self.label)
        K, errors = curvature(*(part @ x for part in self.bends)).K, np.empty(len(self.label))
        errors[self.order] = np.abs(K - self.target[::points]) / self.reference[::points]
        return errors

    def _piece(self, own: _Region, x: FloatArray) -> Piece:
        return Piece(own.splines.axes, own.splines.space, own.splines.own(x))

    def solved(self, stages: Stages) -> Fit:
        """Return the fit."""
        count, stiff = self.counts.sum(), self.edge**4 * self.rough
        near = self.near.multiply((self.counts / count)[:, None]).tocsr()
        solver = linear_solver(self.size, symmetric=True)
        x = solver.factorise((self.near.T @ near + START_ROUGHNESS * stiff).tocsr()).solve(near.T @ self.heights)
        own, tried = self.counts, []
        joined = self.joints.at(x)
        self.smooth = self.joints.smooth(joined.kinks, MAX_SEAM_KINK)
        stiff = ROUGHNESS / DISTANCE**2 * stiff
        for looser, outlier, joint in stages:
            K, gradients = curvature(*(part @ x for part in self.parts))
            error = np.where(self.curved > 0.0, (K - self.target) / self.reference, 0.0) / CURVATURE_ERROR
            weight = np.sqrt(self.curved / (1.0 + (error / outlier) ** 2))
            by = self._rates([weight / self.reference / CURVATURE_ERROR * gradient for gradient in gradients])
            off = self.heights - self.near @ x
            own = own * np.maximum(1.0, np.abs(off) / (looser * DISTANCE))
            own = own / np.sqrt(own.sum() / count)
            tether = own / count / (looser * DISTANCE) ** 2
            join = 1.0 / (joint * DISTANCE) ** 2 / max(len(joined.gaps), 1)
            bend = self.smooth / KINK**2 / max(len(joined.gaps), 1)
            normal = (
                by.T @ by
                + self.near.T @ self.near.multiply(tether[:, None])
                + join * joined.gap_rates.T @ joined.gap_rates
                + joined.kink_rates.T @ joined.kink_rates.multiply(bend[:, None])
                + stiff
            )
            right = (
                self.near.T @ (tether * off)
                - by.T @ (weight * error)
                - join * (joined.gap_rates.T @ joined.gaps)
                - joined.kink_rates.T @ (bend * joined.kinks)
                - stiff @ x
            )
            normal = (normal + DAMPING * normal.diagonal().mean() * sparse.identity(self.size)).tocsr()
            x = x + solver.factorise(normal).solve(right)
            joined = self.joints.at(x)
            if joint <= MEASURED_GAP:
                tried.append(self._measured(x, joined))
        # Steps near the end do not always improve a surface that is singular somewhere.
        return min(tried, key=Fit.rank)

    def _rates(self, gradients: list[FloatArray]) -> sparse.csr_matrix:
        """Return the derivatives of K by all coefficients, from those by the derivatives of the heights (k,)."""
        rates = self.parts[0].copy()
        rows = [gradient[:, None] * part.data.reshape(len(gradient), -1) for part, gradient in zip(self.parts, gradients)]
        rates.data = np.nan_to_num(np.sum(rows, axis=0).ravel(), posinf=0.0, neginf=0.0)
        return rates

    def _measured(self, x: FloatArray, joined: Joined) -> Fit:
        V, F, size = self.V, self.problem.faces, self.scale
        distant = distances(V[F].mean(axis=1), self.singular) > AWAY * self.edge
        pieces = [self._piece(region, x) for region in self.regions]
        heights = self.near @ x
        distance = float(np.abs((self.heights - heights) * _uprightness(self.slopes, x)).max())
        sags = np.abs((heights[self.corners].mean(axis=1) - self.middle @ x) * _uprightness(self.bends[:2], x))
        sagitta = float(sags[distant[self.order]].max(initial=0.0))
        gap = size * max(float(np.abs(joined.gaps).max(initial=0.0)), _ends_apart(self.edges, joined.curves))
        kinks = np.degrees(np.arcsin(np.minimum(joined.sines[self.smooth], 1.0)))
        smooth = joined.edges[self.smooth], np.concatenate(joined.curves)[self.joints.shared][self.smooth]
        away, distance, sagitta = np.flatnonzero(distant), size * distance, size * sagitta
        frame = self.centre, size
        return Fit(pieces, *frame, self.edges, joined.curves, gap, kinks, *smooth, distance, sagitta, self.errors(x), self.singular, away)


def _face_points(rows: int) -> FloatArray:
    """Return the barycentric coordinates (p, 3) of points in some rows over a face."""
    whole = np.array([[i, j, rows - 1 - i - j] for i in range(rows) for j in range(rows - i)])
    return (whole + 1 / 3) / rows


def _ends_apart(edges: list[RegionEdge], curves: list[FloatArray]) -> float:
    """Return the largest distance of the ends of edges that meet at a vertex."""
    ends: dict[int, list[FloatArray]] = {}
    for edge, curve in zip(edges, curves):
        for vertex, point in zip(edge.path[[0, -1]].tolist(), curve[[0, -1]]):
            ends.setdefault(vertex, []).append(point)
    return max(float(np.linalg.norm(np.ptp(points, axis=0))) for points in ends.values())


def _uprightness(slopes: list[sparse.csr_matrix], x: FloatArray) -> FloatArray:
    """Return the cosines of the slopes (k,) from both first derivatives of the heights."""
    cosines: FloatArray = 1.0 / np.sqrt(1.0 + (slopes[0] @ x) ** 2 + (slopes[1] @ x) ** 2)
    return cosines


def distances(points: FloatArray, others: FloatArray) -> FloatArray:
    """Return the distance of points (..., 3) to the nearest of other points (n, 3), infinite if there are none."""
    return cKDTree(others).query(points)[0] if len(others) else np.full(points.shape[:-1], np.inf)


def reference(target: float, points: FloatArray, size: float) -> float:
    """Return the curvature relative to which errors of K are measured in a region with points (k, 3), part of a surface of a size."""
    return float(max(np.nan_to_num(abs(target)), CURVATURE_FLOOR / size**2, REGION_FLOOR / (np.ptp(points, axis=0) ** 2).sum()))


def _axes(points: FloatArray, normals: FloatArray) -> Optional[FloatArray]:
    """Return axes (3, 3) in which a region is a graph, None if there are none.

    The direction of projection is the mean normal if possible, otherwise the one that is best for the worst face.
    """
    direction = normals.sum(axis=0) / np.linalg.norm(normals.sum(axis=0))
    if (normals @ direction).min() < LEVEL_COSINE:
        sides = np.column_stack([-normals, np.ones(len(normals))])
        best = linprog([0, 0, 0, -1], A_ub=sides, b_ub=np.zeros(len(normals)), bounds=[(-1, 1)] * 3 + [(None, None)]).x[:3]
        direction = best / max(float(np.linalg.norm(best)), 1e-300)
    if (normals @ direction).min() < MIN_COSINE:
        return None
    flat = points - np.outer(points @ direction, direction)
    axis = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)[2][0]
    axis -= (axis @ direction) * direction
    axis /= np.linalg.norm(axis)
    return np.array([axis, np.cross(direction, axis), direction])


def samples(points: FloatArray) -> FloatArray:
    """Return points (k, 3) on the smooth curve through the vertices of an edge."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    places = np.interp(np.arange(SAMPLES_PER_EDGE * (len(points) - 1) + 1) / SAMPLES_PER_EDGE, np.arange(len(points)), along)
    if len(points) == 2:
        return points[0] + (places / along[-1])[:, None] * (points[1] - points[0])
    return CubicSpline(along, points)(places)
