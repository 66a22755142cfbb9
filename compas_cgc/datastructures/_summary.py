"""What a designer asks of a result first: fair or not, how high, how curved, and held where."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..model.checks import turns_about
from ..model.goals.wholes import Unknown
from ..model.problem import CGCProblem
from ..model.roles import FIXED
from ..model.verdict import Verdict

__all__ = ["summary"]

NOTHING = 1e-9  # of the size of a surface, that is no height
SUNK = 1e-3  # of it, by which a roof lies under its supports
FACING = 0.5  # part of the area of a drawing that faces one way from which it has a plan
KEPT = (0.8, 1.25)  # parts of its plan that a surface may cover and still be taken for what was drawn


def summary(problem: CGCProblem, drawn: Optional[FloatArray], status: str, judged: Optional[Verdict], max_error: float) -> str:
    """Return the verdict and the surface in one sentence.

    Parameters
    ----------
    problem
        With its vertices on the surface.
    drawn
        ``(n, 3)`` where they were drawn [L]; None where that is not known.
    status
        Of the solve.
    judged
        The verdict; None where there is no surface.
    max_error
        Largest |K - K̄| [1/L^2].
    """
    if judged is None:
        return "no surface: what was drawn is left as it is"
    surface = f"{_heights(problem)}{_covered(problem, drawn)}, {_curvature(problem, status, max_error)}, {_held(problem)}"
    return f"not as asked: {surface}" if status != "converged" else f"{judged}{':' if judged.fair else ';'} {surface}"


def _heights(problem: CGCProblem) -> str:
    size = float(np.ptp(problem.vertices, axis=0).max(initial=0.0))
    low, high = (_number(z, size) for z in (problem.vertices[:, 2].min(), problem.vertices[:, 2].max()))
    return f"level at {low}" if low == high else f"heights from {low} to {high}{_sunk(problem, size)}"


def _sunk(problem: CGCProblem, size: float) -> str:
    """Return how far a roof of K > 0 dips under the edge that it is held along: between domes, where water would stay."""
    z, fixed = problem.vertices[:, 2], problem.roles == FIXED
    held = fixed[boundary_vertices(problem.vertices, problem.faces)]
    bulges = (problem.targets[problem.asked] > 0.0).all() and face_normals(problem.vertices, problem.faces)[:, 2].mean() > 0.0
    if not held.any() or not held.all() or not bulges:
        return ""
    lowest = float(z[fixed].min())
    under = lowest - float(z.min())
    return (
        f", inside {_number(under, size)} under its edge (goals=[Above({_number(lowest, size)})] keeps it up)"
        if under > SUNK * size
        else ""
    )


def _covered(problem: CGCProblem, drawn: Optional[FloatArray]) -> str:
    """Return how much of the plan that was drawn a surface covers, where that is far from all of it: with K < 0 free edges draw in."""
    if drawn is None:
        return ""
    faces = problem.faces[problem.real_faces]
    before, after = (np.cross(V[faces[:, 1]] - V[faces[:, 0]], V[faces[:, 2]] - V[faces[:, 0]]) for V in (drawn, problem.vertices))
    plan = before.sum(axis=0)
    if np.linalg.norm(plan) <= FACING * np.linalg.norm(before, axis=1).sum():
        return ""
    share = float(after.sum(axis=0) @ plan / (plan @ plan))
    return "" if KEPT[0] <= share <= KEPT[1] else f", over {100 * share:.0f} % of the plan that was drawn (a K nearer to 0 keeps more)"


def _curvature(problem: CGCProblem, status: str, max_error: float) -> str:
    targets = problem.targets[problem.asked]
    targets = targets[np.isfinite(targets)]
    if not len(targets):
        return "K asked nowhere"
    low, high = f"{targets.min():.4g}", f"{targets.max():.4g}"
    count = len(problem.region_targets())
    text = f"K = {low}" if low == high else f"K from {low} to {high}"
    text += f" in {count} regions" if count > 1 else ""
    if status != "converged":
        return f"{text} missed by up to {max_error:.2g}"
    found = any(isinstance(own, Unknown) for own in problem.goals)
    return f"{text}, found" if found else f"{text} as asked"


def _held(problem: CGCProblem) -> str:
    rim, fixed = boundary_vertices(problem.vertices, problem.faces), problem.roles == FIXED
    if rim.any() and np.array_equal(rim, fixed):
        return "held along its whole edge"
    count = int(fixed.sum())
    loose = " only, about which it can turn" if turns_about(problem) else ""
    return f"held at {count} of {len(fixed)} vertices{loose}"


def _number(value: float, size: float) -> str:
    return "0" if abs(value) <= NOTHING * size else f"{value:.4g}"
