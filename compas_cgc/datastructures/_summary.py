"""Summary of a result in one sentence: verdict, heights, K and supports."""

from __future__ import annotations

import re
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..model.checks import turns_about
from ..model.goals.wholes import Unknown
from ..model.laws import Law
from ..model.lengths import length_text
from ..model.lengths import unit_suffix
from ..model.problem import CGCProblem
from ..model.result import FAILED
from ..model.roles import FIXED
from ..model.verdict import Verdict

__all__ = ["summary"]

MIN_SAG = 1e-3  # depth below the supports, relative to the size, that is reported
MIN_PLAN_SHARE = 0.5  # share of the area of a drawing that must face one way for its plan area to make sense
PLAN_RANGE = (0.8, 1.25)  # ratios of plan area to drawn plan area that are not reported


def summary(problem: CGCProblem, drawn: Optional[FloatArray], status: str, judged: Verdict, max_error: float) -> str:
    """Return the verdict and the surface in one sentence.

    Parameters
    ----------
    problem
        Problem with its vertices on the surface.
    drawn
        ``(n, 3)`` drawn vertices [L]; None if unknown.
    status
        Status of the solve.
    judged
        Verdict.
    max_error
        Largest |K - K̄| [1/L^2].
    """
    if status in FAILED:
        return "no surface found: the drawing is unchanged"
    surface = f"{_heights(problem)}{_covered(problem, drawn)}, {_curvature(problem, status, max_error)}, {_held(problem)}"
    return f"target not met: {surface}" if status != "converged" else f"{judged}{':' if judged.fair else ';'} {surface}"


def _heights(problem: CGCProblem) -> str:
    """Return the range of heights relative to the lowest support, in the unit of the drawing; of z where there are no supports."""
    size, z = float(np.ptp(problem.vertices, axis=0).max(initial=0.0)), problem.vertices[:, 2]
    held = problem.roles == FIXED
    base = float(z[held].min()) if held.any() else 0.0
    low, high = (length_text(own - base, size) for own in (float(z.min()), float(z.max())))
    unit = unit_suffix(problem.drawing.units)
    if low == high:
        return "level with its supports" if held.any() else f"level at z = {low}{unit}"
    return f"heights from {low} to {high}{unit}{' relative to the lowest support' if held.any() else ''}{_sunk(problem, size)}"


def _sunk(problem: CGCProblem, size: float) -> str:
    """Return how far a roof of K > 0 sags below its supported boundary, where water would collect between domes."""
    z, fixed = problem.vertices[:, 2], problem.roles == FIXED
    held = fixed[boundary_vertices(problem.vertices, problem.faces)]
    bulges = (problem.types[problem.asked] > 0).all() and face_normals(problem.vertices, problem.faces)[:, 2].mean() > 0.0
    if not held.any() or not held.all() or not bulges:
        return ""
    lowest = float(z[fixed].min())
    under = lowest - float(z.min())
    return (
        f", sagging {length_text(under, size)} below its boundary (goals=[Above({length_text(lowest, size)})] prevents this)"
        if under > MIN_SAG * size
        else ""
    )


def _covered(problem: CGCProblem, drawn: Optional[FloatArray]) -> str:
    """Return the share of the drawn plan that a surface covers if it is far from 1; with K < 0 free edges move inwards."""
    if drawn is None:
        return ""
    faces = problem.faces[problem.real_faces]
    before, after = (np.cross(V[faces[:, 1]] - V[faces[:, 0]], V[faces[:, 2]] - V[faces[:, 0]]) for V in (drawn, problem.vertices))
    plan = before.sum(axis=0)
    if np.linalg.norm(plan) <= MIN_PLAN_SHARE * np.linalg.norm(before, axis=1).sum():
        return ""
    share = float(after.sum(axis=0) @ plan / (plan @ plan))
    return (
        "" if PLAN_RANGE[0] <= share <= PLAN_RANGE[1] else f", covering {100 * share:.0f} % of the drawn plan (a K nearer to 0 covers more)"
    )


def _curvature(problem: CGCProblem, status: str, max_error: float) -> str:
    targets = problem.targets[problem.asked]
    targets = targets[np.isfinite(targets)]
    laws = list(dict.fromkeys(map(_shortened, problem.laws.values())))
    if not len(targets) and not laws:
        return "no K prescribed"
    parts, count = laws, len(problem.region_targets())
    if len(targets):
        low, high = f"{targets.min():.4g}", f"{targets.max():.4g}"
        parts = [f"K = {low}" if low == high else f"K from {low} to {high}", *laws]
    text = " and ".join(parts) + (f" in {count} regions" if count > 1 else "")
    if status != "converged":
        return f"{text} with errors up to {max_error:.2g}"
    found = any(isinstance(own, Unknown) for own in problem.goals)
    return f"{text} (solved for)" if found else f"{text} as prescribed"


def _shortened(law: Law) -> str:
    """Return a law as text, with four digits of its numbers."""
    return re.sub(r"\d+\.\d+(e[-+]?\d+)?", lambda number: f"{float(number[0]):.4g}", str(law))


def _held(problem: CGCProblem) -> str:
    rim, fixed = boundary_vertices(problem.vertices, problem.faces), problem.roles == FIXED
    if rim.any() and np.array_equal(rim, fixed):
        return "supported along its whole boundary"
    count = int(fixed.sum())
    loose = " only, about which it can rotate" if turns_about(problem) else ""
    return f"supported at {count} of {len(fixed)} vertices{loose}"
