"""Messages: how a solve ended, in one sentence for the designer."""

from __future__ import annotations

from typing import Union

import numpy as np
from scipy.sparse.csgraph import connected_components

from ...errors import HALVED
from ...errors import Sentence
from ...errors import allow_more_steps
from ...errors import use_method
from ...meshing.existence import Overload
from ...meshing.existence import too_much
from ...model.frame import Frame
from ...model.laws import types_of
from .system import System

__all__ = ["message"]


def message(
    status: str,
    cause: Union[str, Overload],
    steps: int,
    max_error: float,
    system: System,
    frame: Frame,
    dents: int,
    measure: str = "defect",
) -> str:
    """Return the sentence.

    Parameters
    ----------
    status
        One of :data:`compas_cgc.model.result.STATUSES`.
    cause
        What the solver noticed where it did not converge.
    steps
        Steps taken.
    max_error
        Largest |K - K̄| of the shape that is returned [1/L^2], in model units.
    system
        The problem.
    frame
        From the units of the system to those of the model.
    dents
        Vertices of a mostly convex surface that bend the other way.
    measure
        Of K, in which the error is.
    """
    reached = f"largest |K - K̄| {max_error:.3g}" + ("" if measure == "defect" else f" in the {measure} measure")
    taken = "1 step" if steps == 1 else f"{steps} steps"
    if status == "converged":
        many = "1 vertex is" if dents == 1 else f"{dents} vertices are"
        bent = f"; {many} dented; another initial surface may give a smoother result" if dents and measure != "smooth" else ""
        return f"converged in {taken}: {reached}{bent}"
    if status == "cancelled":
        return f"cancelled after {taken}: {reached}"
    if status == "step_limit":
        return allow_more_steps(f"not converged in {taken}: {reached}", steps)
    if isinstance(cause, Overload):
        return too_much(cause.curvature / frame.scale**2, cause.most / frame.scale**2)
    why = cause if status == "infeasible" else _advice(cause, system)
    return Sentence("{} after {}: {}; the best shape on the way is returned, {}").format(status, taken, why, reached)


def _advice(cause: str, system: System) -> str:
    if (types_of(system.targets) < 0).any():
        text = "moves along the normals alone cannot solve regions with K̄ < 0; use the method 'projection', and leave an edge free"
        return Sentence(text, [use_method("projection")])
    if cause == "singular":
        loose = _held_nowhere(system)
        if loose >= 0:
            return f"the part of the mesh around vertex {loose} has no supports; fix some of its vertices"
        return Sentence(
            "the equations have no solution near this shape; try a smaller K̄, or an initial surface without flat or folded faces", [HALVED]
        )
    if (system.targets == 0).any():
        text = (
            "a region with K̄ = 0 needs an initial surface that is already bent, or creases around it; otherwise use the method 'projection'"
        )
        return Sentence(text, [use_method("projection")])
    if cause == "start":
        return "the initial surface is too far from the target; give a better one, or use start='auto'"
    text = "the target is probably too large for this boundary; try a smaller K̄, or a boundary without inward corners"
    return Sentence(text, [HALVED])


def _held_nowhere(system: System) -> int:
    """Return a vertex of a part of the mesh without any vertex that is held, or -1."""
    F, asked = system.problem.faces, system.problem.asked
    pattern = system.equations.pattern
    count, part = connected_components(pattern.matrix(np.ones(pattern.size)), directed=False)
    part_of = np.full(len(asked), -1)
    part_of[system.asked] = part
    held = np.zeros(count, bool)
    mixed = ~asked[F].all(axis=1)
    labels = part_of[F[mixed]].max(axis=1)
    held[labels[labels >= 0]] = True
    return -1 if held.all() else int(system.asked[np.flatnonzero(~held[part])[0]])
