"""A coarser mesh of the same drawing, on which large problems are solved first."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..meshing.carry_over import CarryOver
from ..meshing.coarse_plan import CoarsePlan
from ..meshing.coarse_plan import coarse_plan
from ..model.constraints import Constraint
from ..model.constraints import Fixed
from ..model.constraints import PositionConstraint
from ..model.constraints import Proximity
from ..model.divided import along_inner_lines
from ..model.goals.inequalities import Bound
from ..model.goals.wholes import Length
from ..model.goals.wholes import Unknown
from ..model.goals.wholes import Whole
from ..model.problem import CGCProblem
from ..model.roles import CREASE
from ..model.roles import DUMMY
from ..model.roles import INTERNAL

__all__ = ["Coarse", "coarsened", "laid_out_anew", "plan_of"]

# area of a face in plan over its own, above which a drawing has a plan; a face inclined by 87°, steeper ones collapse in plan
UPRIGHT = 0.05
LARGEST = 0.6  # vertices of a coarser mesh over those of the drawing; with more, the coarse solve takes as long as it saves
LEAST = 1e-4  # square of the extent of faces in one direction over that in the other; limits the stretch of the plan to a factor of 100
# vertices of a constraint that are all kept [vertices]; constraints of single points lose their points otherwise, those of lines do not
FEW = 12


class Coarse:
    """A problem on a coarser mesh, and the way back.

    Parameters
    ----------
    problem, fine
        The problem on the coarser mesh of k vertices, and on the finer one of n.
    plans
        ``(k, 2)`` and ``(n, 2)`` vertices of both in plan [L].
    regions
        ``(k, r)`` and ``(n, r)`` bool: the vertices of each region between creases.
    kept
        ``(h,)`` vertices of the finer mesh that are the first of the coarser one, all that are fixed there among them.
    up
        ``(3,)`` direction that the plan is seen against.
    """

    def __init__(
        self,
        problem: CGCProblem,
        fine: CGCProblem,
        plans: tuple[FloatArray, FloatArray],
        regions: tuple[Mask, Mask],
        kept: Indices,
        up: FloatArray,
    ):
        self.problem, self.kept = problem, kept
        self._fine, self._up, self._within = fine, up, regions[0]
        self._parts = [
            (here, there, CarryOver(plans[0][here], plans[1][there]))
            for here, there in ((np.flatnonzero(regions[0][:, r]), np.flatnonzero(regions[1][:, r])) for r in range(regions[0].shape[1]))
        ]

    @property
    def regions(self) -> list[list[int]]:
        """Regions of the coarser mesh within each region of the finer one."""
        return _regions(self.problem, self._within)

    @property
    def flat(self) -> FloatArray:
        """Vertices (n, 3) of the finer mesh in a plane, seen as they are against the plan [L]."""
        V = self._fine.vertices
        return np.asarray(V - np.outer(V @ self._up, self._up))

    def carried_targets(self, targets: FloatArray) -> FloatArray:
        """Return the targets (n,) of the finer mesh for those (k,) found on the coarser one, region by region [1/L^2]."""
        result = self._fine.targets.copy()
        for here, there, _ in self._parts:
            first = here[np.argmax(self.problem.asked[here])]
            drawn, found = self.problem.targets[first], targets[first]
            own = result[there] * (found / drawn) if drawn else np.nan
            result[there] = np.where(np.isfinite(own), own, found)
        return result

    def carried(self, vertices: FloatArray, anew: bool = False) -> FloatArray:
        """Return the vertices (n, 3) of the finer mesh for those (k, 3) of the coarser one; what is fixed stays.

        The moves from the drawing are carried over or, where its heights mean nothing, the heights `anew`: those of a curved drawing are
        read between its vertices, and what they are off there would come back as waves.
        """
        before, moved = self._fine.vertices, vertices - self.problem.vertices
        if anew:
            moved, before = moved + np.outer(self.problem.vertices @ self._up, self._up), self.flat
        total, count = np.zeros((len(self._fine.vertices), 3)), np.zeros(len(self._fine.vertices))
        for here, there, carry in self._parts:
            total[there] += carry(moved[here])
            count[there] += 1.0
        loose = self._fine.movable & (count > 0.0)
        result = self._fine.vertices.copy()
        result[loose] = (before + total / np.maximum(count, 1.0)[:, None])[loose]
        return result


def coarsened(problem: CGCProblem, count: int) -> Optional[Coarse]:
    """Return a problem on a mesh of about so many vertices, with the same supports, creases, targets and constraints.

    Parameters
    ----------
    problem
        The problem.
    count
        Vertices wanted.

    Returns
    -------
    Coarse or None
        None where there is none to be had: the drawing has no plan, lines are too close for so few vertices, a region would lose all
        vertices where K is prescribed, or a path whose length is prescribed would lose some.
    """
    return _laid_out(problem, count, LARGEST, True)


def laid_out_anew(problem: CGCProblem, count: int, symmetric: bool = False) -> Optional[Coarse]:
    """Return a problem as :func:`coarsened` does, but of as many vertices as are wanted, and with equilateral faces in plan.

    These are as symmetric as the plan if that is asked for, which takes short edges along the rim.
    """
    return _laid_out(problem, count, math.inf, False, symmetric)


def _laid_out(problem: CGCProblem, count: int, largest: float, stretched: bool, symmetric: bool = False) -> Optional[Coarse]:
    """Return a problem on another mesh, with faces as stretched as those of the drawing or with equilateral ones."""
    V, F = problem.vertices, problem.faces
    kinds = (PositionConstraint, Fixed, Proximity, Bound, Whole, Unknown)
    if (problem.roles == DUMMY).any() or not all(isinstance(own, kinds) for own in problem.goals):
        return None
    seen = plan_of(V, F)
    if seen is None:
        return None
    plan, up = seen
    plan = plan @ _evened(plan, F) if stretched else plan
    fixed = ~problem.movable
    edges = edge_faces(F)
    lines = edges[along_inner_lines(problem, fixed, edges), :2]
    corners = plan[F]
    side, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * float((side[:, 0] * other[:, 1] - side[:, 1] * other[:, 0]).sum())
    step = math.sqrt(area / count * 2.0 / math.sqrt(3.0))
    found = coarse_plan(plan, F, lines, _kept(problem, fixed, lines), step, anew=not stretched, symmetric=symmetric)
    if found is None or len(found.kept) + len(found.within) > largest * len(V):
        return None
    paths = [own.vertices for own in problem.goals if isinstance(own, Length)]
    if not all(np.isin(path, found.kept).all() for path in paths):
        return None
    labels = problem.regions()
    belongs = np.zeros((len(V), labels.max() + 1), bool)
    belongs[F.ravel(), np.repeat(labels, 3)] = True
    inner = labels[found.within][:, None] == np.arange(belongs.shape[1])
    here = np.vstack([belongs[found.kept], inner])
    if not here.any(axis=0).all():
        return None
    coarse = _posed(problem, found, here)
    if (belongs[problem.asked].any(axis=0) & ~here[coarse.asked].any(axis=0)).any():
        return None
    places = np.vstack([plan[found.kept], np.einsum("pk,pkx->px", found.weights, plan[F[found.within]])])
    return Coarse(coarse, problem, (places, plan), (here, belongs), found.kept, up)


def _posed(problem: CGCProblem, found: CoarsePlan, here: Mask) -> CGCProblem:
    """Return the problem on a coarser mesh, whose vertices belong to regions (k, r)."""
    corners, asked = problem.faces[found.within], problem.asked
    # The target at a point is interpolated between vertices with a target, or that of the region if there are none.
    heard = found.weights * asked[corners]
    told = heard.any(axis=1)
    heard = heard / np.where(told, heard.sum(axis=1), 1.0)[:, None]
    theirs = np.where(asked, problem.targets, 0.0)[corners]
    loudest = theirs[np.arange(len(theirs)), heard.argmax(axis=1)]
    between = loudest + np.einsum("pk,pk->p", heard, theirs - loudest[:, None])
    if not told.all():
        between = np.where(told, between, _elsewhere(problem)[found.within])
    index = np.full(len(problem.vertices), -1)
    index[found.kept] = np.arange(len(found.kept))
    lines = found.lines
    drawn = CGCProblem(
        np.vstack([problem.vertices[found.kept], np.einsum("pk,pkx->px", found.weights, problem.vertices[corners])]),
        found.faces,
        np.concatenate([problem.roles[found.kept], np.full(len(between), INTERNAL)]),
        np.concatenate([problem.targets[found.kept], between]),
        creases=lines[_creased(problem)[found.kept][lines].all(axis=1)],
    )
    regions = _regions(drawn, here)
    goals = [_of_regions(own.renumbered(index), regions) for own in problem.goals]
    coarse = drawn.with_goals(goals, add=False) if goals else drawn
    laws = {region: law for number, law in problem.laws.items() for region in regions[number]}
    return coarse.with_laws(laws) if laws else coarse


def _elsewhere(problem: CGCProblem) -> FloatArray:
    """Return the target of every face: the mean of its region, or for regions without targets that of the faces beside it (m,)."""
    # Not the nearest vertex: beside the end of a crease it may belong to another region.
    regions, targets = problem.regions(), problem.face_targets().copy()
    for region, K in enumerate(problem.region_targets()):
        within = problem.targets[problem.region_vertices(region) & problem.asked]
        if K is not None or len(within):
            targets[regions == region] = within.mean() if K is None else K
    return targets


def _regions(coarse: CGCProblem, here: Mask) -> list[list[int]]:
    """Return the regions of a coarser mesh for each of the finer one; their faces lie in the regions that have all their vertices."""
    regions, inside = coarse.regions(), np.asarray(here[coarse.faces].all(axis=1))
    alone = inside & (inside.sum(axis=1) == 1)[:, None]
    return [np.unique(regions[own]).tolist() for own in alone.T]


def _of_regions(goal: Constraint, regions: list[list[int]]) -> Constraint:
    """Return a goal that names regions by their numbers on a coarser mesh."""
    if not isinstance(goal, Unknown) or isinstance(goal.regions, str):
        return goal
    return replace(goal, regions=[number for region in goal.regions for number in regions[region]])


def plan_of(V: FloatArray, F: IntArray) -> Optional[tuple[FloatArray, FloatArray]]:
    """Return the vertices (n, 2) seen against the direction (3,) that all faces face, and that; None where there is no such direction."""
    crosses = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    facing = crosses.sum(axis=0)
    length = float(np.linalg.norm(facing))
    if not length > 0.0:
        return None
    up = facing / length
    if not (crosses @ up > UPRIGHT * np.linalg.norm(crosses, axis=1)).all():
        return None
    side = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    side /= np.linalg.norm(side)
    return V @ np.array([side, np.cross(up, side)]).T, up


def _evened(plan: FloatArray, F: IntArray) -> FloatArray:
    """Return the map (2, 2) that makes the faces of a plan equilateral on average.

    Laid out evenly there, a coarser mesh has the finer one's layout, and bending has the same meaning on both.
    """
    edges = (np.roll(plan[F], -1, axis=1) - plan[F]).reshape(-1, 2)
    values, vectors = np.linalg.eigh(edges.T @ edges / np.einsum("ij,ij->", edges, edges))
    return (vectors * np.sqrt(0.5 / np.maximum(values, LEAST))) @ vectors.T


def _creased(problem: CGCProblem) -> Mask:
    creased = problem.roles == CREASE
    creased[problem.creases] = True
    return creased


def _kept(problem: CGCProblem, fixed: Mask, lines: Edges) -> Mask:
    """Mark the supports that stand alone or end a row, and the vertices of constraints that name a few (n,)."""
    V, F = problem.vertices, problem.faces
    rim = boundary_vertices(V, F)
    edges = edge_faces(F)
    u, v = edges[edges[:, 3] < 0, :2].T
    kept = fixed & ~rim
    kept[lines] = False
    ends = fixed[u] != fixed[v]
    kept[u[ends & fixed[u]]] = True
    kept[v[ends & fixed[v]]] = True
    for own in problem.goals:
        named = getattr(own, "vertices", ())
        if not isinstance(named, str) and 0 < len(named) <= FEW:
            kept[list(named)] = True
    return kept
