"""Contradictions between goals about positions in plan and distances from planes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Optional
from typing import cast

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.plan import flattened
from ...errors import Sentence
from ...meshing.in_outline import inside_outline
from ..constraints import Constraint
from ..constraints import unit
from ..problem import CGCProblem
from ..tolerances import NEGLIGIBLE
from .binding import bind
from .heights import about
from .inequalities import NearPlane
from .inequalities import Within
from .names import goal_name
from .numbers import in_plan
from .places import EdgeInPlan
from .places import Level

__all__ = ["plan_clashes"]


def plan_clashes(problem: CGCProblem) -> Iterator[str]:
    """Return messages for goals without a common position in plan, and for planes too far apart."""
    size = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))
    goals = [goal for goal in problem.goals if isinstance(goal, (Within, NearPlane, EdgeInPlan, Level))]
    for one, other in combinations(goals, 2):
        said = _apart(problem, one, other, NEGLIGIBLE * size)
        if said is not None:
            yield Sentence("{} and {} contradict each other{}").format(goal_name(one), goal_name(other), said)


def _apart(problem: CGCProblem, one: Constraint, other: Constraint, rounding: float) -> Optional[str]:
    """Return why two goals exclude each other, None if they may be compatible."""
    if isinstance(one, NearPlane) and isinstance(other, NearPlane):
        return _planes_apart(problem, one, other, rounding)
    if isinstance(one, Within) and isinstance(other, Within):
        common = np.intersect1d(about(problem, one), about(problem, other))
        first, second = _line(one), _line(other)
        meet = _meet(first, second) or bool(inside_outline(first[:1], second).any() or inside_outline(second[:1], first).any())
        return ": their outlines do not overlap; widen one of them" if len(common) and not meet else None
    if isinstance(one, (EdgeInPlan, Level)) and isinstance(other, (EdgeInPlan, Level)):
        return _edges_apart(problem, one, other, rounding)
    within, edge = (one, other) if isinstance(one, (Within, NearPlane)) else (other, one)
    if isinstance(edge, (EdgeInPlan, Level)):
        return _edge_outside(problem, within, edge, rounding)
    within, plane = (one, other) if isinstance(one, Within) else (other, one)
    if isinstance(within, Within) and isinstance(plane, NearPlane):
        common = np.intersect1d(about(problem, within), about(problem, plane))
        off = _off(plane, _line(within))
        if len(common) and off is not None and ((off > plane.distance + rounding).all() or (off < -plane.distance - rounding).all()):
            return ": the outline lies too far from the plane; widen one of them"
    return None


def _planes_apart(problem: CGCProblem, one: NearPlane, other: NearPlane, rounding: float) -> Optional[str]:
    first, second = (unit(goal.normal, "the normal of a plane") for goal in (one, other))
    apart = abs(float((np.asarray(other.point, float) - np.asarray(one.point, float)) @ first))
    parallel = float(np.linalg.norm(np.cross(first, second))) <= NEGLIGIBLE
    if not parallel or apart <= one.distance + other.distance + rounding:
        return None
    if not len(np.intersect1d(about(problem, one), about(problem, other))):
        return None
    return f": these planes are {apart:.3g} apart; increase one of the distances"


def _edges_apart(problem: CGCProblem, one: Constraint, other: Constraint, rounding: float) -> Optional[str]:
    """Return why a level edge, whose plan is fixed, is not over the line of another goal."""
    for ring, line in ((one, other), (other, one)):
        for place in _places(problem, ring):
            for sheet in _places(problem, line):
                common, where, _ = np.intersect1d(place.vertices, sheet.vertices, return_indices=True)
                if not isinstance(place, Level) or not len(common):
                    continue
                points = flattened(np.asarray(place.points, dtype=np.float64))[where]
                if isinstance(sheet, Level):
                    theirs = flattened(np.asarray(sheet.points, dtype=np.float64))
                    nearest = theirs[np.searchsorted(np.asarray(sheet.vertices), common)]
                else:
                    nearest = sheet.closest_points(points).points
                off = np.linalg.norm((points - nearest)[:, :2], axis=1)
                if off.max() > rounding:
                    vertex = int(common[np.argmax(off)])
                    return f" at vertex {vertex}, whose prescribed positions in plan are {off.max():.3g} apart; remove one of them"
    return None


def _edge_outside(problem: CGCProblem, within: Constraint, edge: Constraint, rounding: float) -> Optional[str]:
    """Return why an edge lies outside a closed line or too far from a vertical plane."""
    for place in _places(problem, edge):
        mine = np.isin(np.asarray(place.vertices, dtype=np.int64), about(problem, within))
        if not mine.any():
            continue
        points = flattened(np.asarray(place.points, dtype=np.float64))
        if isinstance(place, Level):
            slack = _slack(within, points[mine])
            if slack is not None and slack.min() < -rounding:
                vertex = int(np.asarray(place.vertices)[mine][np.argmin(slack)])
                return f" at vertex {vertex}, which lies {-slack.min():.3g} outside; widen one of them"
        elif _all_outside(within, points, bool(getattr(place, "closed", False)), rounding):
            return ": the whole edge lies outside; widen one of them"
    return None


def _all_outside(within: Constraint, line: FloatArray, closed: bool, rounding: float) -> bool:
    if isinstance(within, Within):
        outline = _line(within)
        slack = within.slack(line)[0]
        return bool((slack < -rounding).all()) and not _meet(outline, line, closed)
    off = _off(cast(NearPlane, within), line)
    near = cast(NearPlane, within).distance + rounding
    return off is not None and bool((off > near).all() or (off < -near).all())


def _slack(within: Constraint, points: FloatArray) -> Optional[FloatArray]:
    """Return the slack of points in plan (k,), None if it depends on their heights."""
    if isinstance(within, Within):
        return within.slack(points)[0]
    plane = cast(NearPlane, within)
    off = _off(plane, points)
    return None if off is None else plane.distance - np.abs(off)


def _off(plane: NearPlane, points: FloatArray) -> Optional[FloatArray]:
    """Return the signed distance of points in plan from a vertical plane (k,), None for any other plane."""
    normal = unit(plane.normal, "the normal of a plane")
    if abs(normal[2]) > NEGLIGIBLE:
        return None
    return np.asarray((points[:, :2] - np.asarray(plane.point, float)[:2]) @ normal[:2])


def _places(problem: CGCProblem, goal: Constraint) -> list:
    return list(bind(problem.with_goals([goal], add=False)).places)


def _line(within: Constraint) -> FloatArray:
    return in_plan(cast(Within, within).points, "points", 3)


def _meet(outline: FloatArray, line: FloatArray, closed: bool = True) -> bool:
    """Check whether a closed line and another one cross or touch in plan."""
    a, b = outline[:, None, :2], np.roll(outline, -1, axis=0)[:, None, :2]
    ahead = np.roll(line, -1, axis=0)
    p, q = (line, ahead) if closed else (line[:-1], ahead[:-1])
    p, q = p[None, :, :2], q[None, :, :2]
    return bool(((_turn(a, b, p) * _turn(a, b, q) <= 0.0) & (_turn(p, q, a) * _turn(p, q, b) <= 0.0)).any())


def _turn(p: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
    """Return twice the areas of the triangles p, q, r in plan, positive where they turn left."""
    return np.asarray((q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0]))
