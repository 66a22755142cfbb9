"""Membrane forces of surfaces of constant K, and a discrete state in equilibrium.

The cofactor of the shape operator S is divergence-free on any surface, so ``N = p / (2 K) cof S`` balances a uniform
pressure p wherever K is constant and not 0: ``N1 = p k2 / (2 K)`` and ``N2 = p k1 / (2 K)`` along the principal
directions. Its discrete counterpart is a force ``p fold / (2 K)`` in every edge (Schläfli's formula).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete import face_normals
from ..discrete import vertex_normals
from ..discrete.arrays import Faces
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..model.given import checked_number
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.verdict import verdict
from .balance import in_balance
from .balance import mean_size
from .balance import pull_of
from .closing import closed
from .closing import closed_anew
from .closing import closed_with_edges
from .loads import nodal_load
from .materials import metres_per_unit
from .membrane_checks import BALANCE_TOLERANCE
from .membrane_checks import MAX_CORRECTION
from .membrane_checks import amplification_of
from .membrane_checks import check_targets
from .membrane_checks import judged
from .membrane_checks import remarks_on
from .membrane_edges import edges_of_regions
from .membrane_edges import fold_angles
from .membrane_edges import line_loads
from .membrane_edges import rim_edges
from .membrane_fields import principal_forces
from .membrane_fields import stress_by_formula
from .membrane_fields import stress_of_bars
from .membrane_state import MembraneState
from .solved import solved_problem

__all__ = ["membrane"]

MIN_IMPROVEMENT = 0.5  # a slid mesh must reduce the correction to at most this fraction


@names_what_was_meant()
def membrane(
    surface: PosesProblem,
    pressure: float = 0.0,
    weight: float = 0.0,
    *,
    edge_beams: bool = True,
    close: bool = True,
    rough: bool = False,
) -> MembraneState:
    """Return the membrane forces of a solved surface, and edge forces in exact equilibrium with its load.

    Parameters
    ----------
    surface
        Solved result, mesh or problem with one target K per region.
    pressure
        Load along the normals, positive outwards [F/L^2].
    weight
        Load per area of the surface, along -z [F/L^2].
    edge_beams
        Whether free edges have beams that carry the forces of the surface. Few surfaces are in equilibrium without beams.
    close
        Whether to slide inner vertices along the surface until the equations of the measure exact are satisfied. This is done if the
        edge forces by the formula are far from equilibrium under pressure, as on irregular meshes. A remark gives the distance. If
        sliding fails, edges inside regions are flipped too, so that the mesh of the state has other faces.
    rough
        Whether to accept a surface with the verdict rough, see :class:`compas_cgc.analysis.Verdict`.

    Returns
    -------
    MembraneState

    Raises
    ------
    CGCError
        If the surface is rough, the load is zero or not finite, a region has K = 0, no equilibrium state exists with the given
        supports and beams, or the forces are out of proportion to the load, as on meshes along asymptotic curves.

    Examples
    --------
    >>> import compas_cgc
    >>> state = membrane(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), pressure=0.3)
    >>> state.pressure, state.imbalance < 1e-9
    (0.3, True)
    """
    problem = solved_problem(surface, rough)
    pressure, weight = checked_number(pressure, "pressure"), checked_number(weight, "weight")
    if not np.isfinite([pressure, weight]).all():
        raise CGCError(
            f"loads must be finite, not a pressure of {pressure:g} and a weight of {weight:g}; give finite values in model units"
        )
    if pressure == 0.0 and weight == 0.0:
        raise CGCError("membrane forces need a load; give a pressure, a weight or both (snow and wind in .inp files are added to these)")
    check_targets(problem)
    state = _state(problem, pressure, weight, edge_beams)
    return judged(_closed(state, edge_beams, rough) if close else state, edge_beams)


def _closed(state: MembraneState, edge_beams: bool, rough: bool) -> MembraneState:
    """Return the state of a nearby surface whose triangles close, where this improves the edge forces; else the given one."""
    if state.imbalance > BALANCE_TOLERANCE:
        # Far from a balance, another mesh does not help.
        methods = [closed_with_edges] if state.imbalance < MAX_CORRECTION else []
    else:
        methods = [closed, closed_anew] if state.correction > MAX_CORRECTION else []
    for close_triangles in methods:
        nearby = close_triangles(state.problem)
        if nearby is None or not (rough or verdict(nearby).fair):
            continue
        exact = _state(nearby, state.pressure, state.weight, edge_beams)
        improved = state.imbalance > BALANCE_TOLERANCE or exact.correction <= MIN_IMPROVEMENT * state.correction
        if exact.imbalance <= BALANCE_TOLERANCE and improved:
            return _slid(exact, state)
    return state


def _slid(exact: MembraneState, state: MembraneState) -> MembraneState:
    """Return a state with slid vertices, with a remark about the displacements."""
    problem = state.problem
    slid = exact.problem
    move = slid.vertices - problem.vertices
    # Use the mean of the normals at both ends, because a displacement along a curve leaves both tangent planes.
    normals = vertex_normals(problem.vertices, problem.faces) + vertex_normals(slid.vertices, slid.faces)
    off = 0.5 * np.abs(np.einsum("ij,ij->i", move, normals))
    unit = 1e3 * metres_per_unit(problem.drawing.units)
    far, away = float(np.linalg.norm(move, axis=1).max()), float(off.max())
    if state.imbalance > BALANCE_TOLERANCE:
        without = f"before, no edge forces balanced the load (residual {100 * state.imbalance:.2g} % of it); free edges moved as well"
    else:
        without = f"without sliding, equilibrium needs edge forces that deviate from the formula by {100 * state.correction:.3g} %"
    said = (
        f"vertices were slid by up to {unit * far:.3g} mm along the surface, and by up to {unit * away:.2g} mm off it, to satisfy "
        f"the equations of the measure exact{_turned(problem.faces, slid.faces)}; {without}"
    )
    return replace(exact, moved=far, remarks=(said, *exact.remarks))


def _turned(before: Faces, after: Faces) -> str:
    """Return the part of the remark about remeshed triangles."""
    count = int((np.sort(before, axis=1) != np.sort(after, axis=1)).any(axis=1).sum())
    return f", and {count} of {len(after)} triangles were replaced" if count else ""


def _state(problem: CGCProblem, pressure: float, weight: float, edge_beams: bool) -> MembraneState:
    """Return the membrane state of a surface without sliding, which may be out of balance."""
    V, F = problem.vertices, problem.faces
    label = problem.regions()
    bars, on = edges_of_regions(problem)
    curvature = np.array([0.0 if K is None else K for K in problem.region_targets()])
    folds = fold_angles(V, F, bars)
    start = pressure * folds / (2.0 * curvature[label[bars[:, 2]]])
    load = nodal_load(V, F, pressure, weight)
    inner = np.ones(len(V), bool)
    inner[np.unique(on.edges)] = False
    # Without beams the vertices on free edges must be in equilibrium too.
    free = np.zeros(len(V), bool)
    free[np.unique(on.edges[on.kind == 2])] = True
    free[np.unique(on.edges[on.kind != 2])] = False
    balanced = inner | (free & (not edge_beams))
    if not edge_beams:
        rim = on.edges[on.kind == 2]
        bars, start = np.vstack([bars, rim_edges(F, rim)]), np.r_[start, np.zeros(len(rim))]
    forces, before, after = in_balance(V, F, bars, start, load, balanced)
    size = mean_size(load)
    tensors = stress_of_bars(V, F, bars, forces)
    if weight == 0.0:
        tensors = stress_by_formula(problem, label, curvature, pressure)
    values, vectors = principal_forces(tensors, face_normals(V, F))
    pull = pull_of(V, bars, forces)
    reactions = np.where((~balanced)[:, None], -(pull + load), 0.0)
    own_load = line_loads(V, F, on, tensors)
    small = float(np.median(np.linalg.norm(before[inner], axis=1)) / size) if weight == 0.0 else float("nan")
    changed = float(np.linalg.norm(forces - start) / np.linalg.norm(start)) if weight == 0.0 else float("nan")
    return MembraneState(
        problem,
        pressure,
        weight,
        values,
        vectors,
        bars[:, :2],
        forces,
        reactions,
        own_load,
        small,
        changed,
        after,
        remarks_on(own_load, edge_beams, changed),
        amplification=amplification_of(problem, bars, forces, load),
    )
