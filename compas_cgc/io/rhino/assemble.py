"""Assembly of drawn objects to a problem: mesh, supports, creases, targets and constraints."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence
from typing import Callable
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...meshing import Diagnostic
from ...meshing import path_edges
from ...model.constraints import Constraint
from ...model.counts import counted
from ...model.laws import Law
from ...model.lengths import unit_suffix
from ...model.problem import CGCProblem
from ...model.problem import Drawing
from ..reading import ReadProblem
from .creases import lay_creases
from .goals import find_goals
from .meshes import JoinedMesh
from .meshes import join_meshes
from .sketch import Drawn
from .sketch import Part
from .snapping import find_constraints
from .snapping import find_supports
from .snapping import snap_distance
from .targets import find_laws
from .user_text import GOALS_KEY
from .user_text import text_constraints
from .user_text import vertex_values

__all__ = ["assemble"]

# Functions from the sampling tolerance of curves to drawn objects.
AtTolerance = Callable[[float], list[Drawn]]


def assemble(
    name: str,
    parts: Sequence[Part],
    supports: AtTolerance,
    creases: AtTolerance,
    targets: AtTolerance,
    constraints: AtTolerance,
    units: str,
    tolerance: float,
    solved: Optional[Mapping[int, Optional[Law]]] = None,
    crease: str = "trace",
    notes: Sequence[str] = (),
    goals: Optional[AtTolerance] = None,
    north: tuple[float, float] = Drawing().north,
) -> ReadProblem:
    """Snap drawn objects to the vertices and edges of the mesh.

    Parameters
    ----------
    name
        Name of the drawing.
    parts
        Meshes, which are joined.
    supports, creases, targets, constraints
        Functions that return drawn objects, with curves sampled to a given tolerance [L].
    units
        Name of the unit system.
    tolerance
        Distance below which points coincide [L].
    solved
        Law of every region of an earlier result.
    crease
        ``"trace"`` or ``"split"``.
    notes
        Notes so far.
    goals
        Function that returns drawn goals, like `constraints`.
    north
        Direction in plan.

    Raises
    ------
    FileError
        If the parts do not form a usable mesh.
    """
    unit = unit_suffix(units)
    reach = tolerance if np.isfinite(tolerance) and tolerance > 0 else 0.0
    joined = join_meshes(list(parts), reach, unit)
    snap = snap_distance(joined.vertices, joined.faces, reach, joined.rounding)
    fine = 0.25 * snap
    fixed, support_notes, support_diagnostics = find_supports(supports(fine), joined.vertices, snap, unit)
    laid = lay_creases(creases(fine), joined, fixed, snap, crease, unit)
    mesh = laid.mesh
    edges = np.unique(np.sort(np.array(path_edges(laid.paths), dtype=np.int64).reshape(-1, 2), axis=1), axis=0)
    K, laws, target_notes, target_diagnostics = find_laws(targets(fine), list(parts), solved or {}, mesh, edges, unit)
    drawn, constraint_diagnostics = find_constraints(constraints(fine), mesh.vertices, snap, unit)
    texts, text_diagnostics = _constraints_in_texts(parts, mesh)
    asked = find_goals(goals(fine) if goals is not None else [], mesh.vertices, snap)
    held = (*drawn, *asked.goals, *texts)
    problem = CGCProblem(
        mesh.vertices,
        mesh.faces,
        targets=_values_in_texts(parts, mesh, "target", K),
        s=_values_in_texts(parts, mesh, "s", laid.s),
        e=_values_in_texts(parts, mesh, "e", laid.e),
        creases=edges,
        goals=held,
        laws=laws,
        drawing=Drawing(name, units, tolerance, asked.places, north),
    )
    found = f"the drawing has {counted(len(held), 'constraint')} besides K"
    return ReadProblem(
        problem.with_supports(fixed.tolist()),
        (*notes, *joined.notes, *support_notes, *laid.notes, *target_notes, *([found] if held else [])),
        (*support_diagnostics, *laid.diagnostics, *target_diagnostics, *constraint_diagnostics, *asked.diagnostics, *text_diagnostics),
    )


def _values_in_texts(parts: Sequence[Part], mesh: JoinedMesh, name: str, drawn: FloatArray) -> FloatArray:
    """Return values of vertices (n,) from the user text of the meshes, or else the drawn values."""
    values = drawn.copy()
    for part, index in zip(parts, mesh.indices):
        own = vertex_values(part.text, len(index)).get(name)
        if own is not None:
            known = np.isfinite(own) & (index >= 0)
            values[index[known]] = own[known]
    return values


def _constraints_in_texts(parts: Sequence[Part], mesh: JoinedMesh) -> tuple[list[Constraint], list[Diagnostic]]:
    """Return the constraints in the user text of the meshes."""
    found: list[Constraint] = []
    diagnostics = []
    for part, index in zip(parts, mesh.indices):
        try:
            found += [constraint.renumbered(index) for constraint in text_constraints(part.text, len(index))]
        except ValueError as error:
            mend = "set the goals again, or delete the text (Rhino: Properties, Attribute User Text)"
            diagnostics.append(Diagnostic(f"user text {GOALS_KEY!r} of {part.label} cannot be used ({error}); {mend}"))
    return found, diagnostics
