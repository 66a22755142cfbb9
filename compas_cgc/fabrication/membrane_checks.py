"""Whether a membrane state can be relied on.

The sign of K decides the type of the equations of equilibrium. Where K > 0 they are elliptic: all edges are stretched by moves of
neighbouring vertices in opposite directions, and edge forces are in proportion to the load. Where K < 0 they are hyperbolic, and
forces run along asymptotic curves from rim to rim. Edges along these curves hardly resist such moves, and on regular meshes the
smallest singular value of the equations decreases exponentially with the number of rows. Then even a small part of the load that
alternates from vertex to vertex is balanced only by huge forces, or not at all.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete import face_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vectors
from ..errors import CGCError
from ..model.problem import CGCProblem
from .membrane_edges import EdgeLoads
from .membrane_state import MembraneState

__all__ = ["BALANCE_TOLERANCE", "MAX_CORRECTION", "amplification_of", "check_targets", "judged", "remarks_on"]

FLAT_CURVATURE = 1e-9  # K times area below which a region counts as K = 0
BALANCE_TOLERANCE = 1e-9  # residual relative to the load up to which a state is in equilibrium
# Residual relative to the load that is accepted with a remark: nodal loads represent a distributed load less accurately.
MAX_RESIDUAL = 1e-4
MAX_CORRECTION = 0.05  # relative correction of edge forces up to which they agree with the formula
# Edge forces per width, relative to load times size: .6 to 1.6 for K > 0 and for K < 0 on irregular meshes, up to 2.2 with slender
# triangles; for K < 0 along the mesh 3.3 to 7.5, growing as the mesh is refined, and 14 to 1,000 with asymptotic diagonals.
AMPLIFICATION_REMARK = 3.0
MAX_AMPLIFICATION = 10.0
HYPERBOLIC = (
    "where K < 0, forces run along asymptotic curves, and edges of a regular mesh along these curves do not resist moves of neighbouring "
    "vertices in opposite directions; mesh the plan with irregular triangles, as from an outline"
)


def check_targets(problem: CGCProblem) -> None:
    """Refuse regions without a single target K other than 0."""
    label, areas = problem.regions(), face_areas(problem.vertices, problem.faces)
    for region, K in enumerate(problem.region_targets()):
        if K is None:
            raise CGCError(f"region {region} has no single target K, which determines the forces; set one and solve first")
        if abs(K) * areas[label == region].sum() < FLAT_CURVATURE:
            raise CGCError(
                f"region {region} has K = 0, where curvature does not determine the membrane forces; export the mesh for a "
                "finite-element analysis, or give the region a small curvature"
            )


def amplification_of(problem: CGCProblem, bars: Edges, forces: FloatArray, load: Vectors) -> float:
    """Return the root mean square of edge forces (b,) per width, relative to the load per area times the size.

    The size is the root of the area, or the radius 1 / sqrt(abs(K)) where this is larger, as the forces of shallow surfaces grow with it.
    """
    V = problem.vertices
    areas = np.r_[face_areas(V, problem.faces), 0.0]
    squares = ((V[bars[:, 1]] - V[bars[:, 0]]) ** 2).sum(axis=1)
    stress = float(np.sqrt((3.0 * forces**2 * squares / (areas[bars[:, 2]] + areas[bars[:, 3]])).sum() / areas.sum()))
    radius = max(abs(K) ** -0.5 for K in problem.region_targets() if K)
    size = max(float(areas.sum()) ** 0.5, radius)
    return stress * float(areas.sum()) / (float(np.linalg.norm(load, axis=1).sum()) * size)


def judged(state: MembraneState, edge_beams: bool) -> MembraneState:
    """Return a state with a remark where its equations are ill-conditioned, or refuse it where the forces are of no use."""
    # Where K > 0, forces at corners and straight held rims are large because the curvature is unbounded there.
    hyperbolic = any(K is not None and K < 0.0 for K in state.problem.region_targets())
    if state.imbalance > MAX_RESIDUAL or (hyperbolic and state.amplification > MAX_AMPLIFICATION):
        raise CGCError(_refusal(state, edge_beams, hyperbolic))
    remarks = list(state.remarks)
    if hyperbolic and state.amplification > AMPLIFICATION_REMARK:
        remarks.append(
            f"ill-conditioned: edge forces per width are {state.amplification:.3g} times load times size, where 1 is usual, and grow as "
            f"the mesh is refined: {HYPERBOLIC}"
        )
    if state.imbalance > BALANCE_TOLERANCE:
        cause = f": {HYPERBOLIC}" if hyperbolic else ""
        remarks.append(f"edge forces balance the load up to {100 * state.imbalance:.2g} % of it{cause}")
    return replace(state, remarks=tuple(remarks))


def _refusal(state: MembraneState, edge_beams: bool, hyperbolic: bool) -> str:
    rest, elements = f"residual {100 * state.imbalance:.2g} % of the load", "or use a finite-element analysis with bending"
    if hyperbolic and edge_beams:
        return (
            f"the membrane forces are not reliable ({rest}, edge forces per width {state.amplification:.3g} times load times size, where 1 "
            f"is usual): {HYPERBOLIC}, {elements}"
        )
    if not edge_beams:
        return (
            f"without edge beams, membrane forces cannot balance this load ({rest}); support the free edges or give them edge beams "
            "(edge_beams=True), whose line loads are reported"
        )
    return f"no membrane state carries this load ({rest}); support the surface along its whole boundary, {elements}"


def remarks_on(loads: EdgeLoads, edge_beams: bool, correction: float) -> tuple[str, ...]:
    """Return remarks on what equilibrium does not determine, on beams, and on edge forces far from the formula."""
    free = np.linalg.norm(loads.load[loads.kind == 2], axis=1)
    held = int((loads.kind == 0).sum())
    creases = np.linalg.norm(loads.load[loads.kind == 1], axis=1)
    remarks = []
    if held > 3:
        remarks.append(
            f"statically indeterminate: {held} edges are held in all directions, so that equilibrium alone does not determine the forces; "
            "these forces need supports that take exactly the line loads given here, and elastic finite elements differ from them"
        )
    if len(free) and edge_beams:
        remarks.append(f"free edges need edge beams for line loads of up to {free.max():.4g}; membrane forces do not vanish there")
    if len(creases):
        remarks.append(f"creases must carry line loads of up to {creases.max():.4g} to the supports")
    if len(creases) or (len(free) and edge_beams):
        remarks.append(
            "statically indeterminate with elastic beams: these forces belong to beams along free edges and creases that take exactly the "
            "line loads given here; finite elements with beams that deflect find other forces, by the stiffness of the beams"
        )
    if correction > MAX_CORRECTION:
        remarks.append(
            f"edge forces deviate from the formula by {100 * correction:.3g} % because the mesh is irregular; N1, N2 and line loads are "
            "not affected; solve with the measure exact to reduce this"
        )
    return tuple(remarks)
