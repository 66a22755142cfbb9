"""Membrane forces of surfaces of constant K, and a discrete state in equilibrium.

The cofactor of the shape operator S is divergence-free on any surface, so ``N = p / (2 K) cof S`` balances a uniform
pressure p wherever K is constant and not 0: ``N1 = p k2 / (2 K)`` and ``N2 = p k1 / (2 K)`` along the principal
directions. Its discrete counterpart is a force ``p fold / (2 K)`` in every edge (Schläfli's formula).
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete import vertex_normals
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..model.given import checked_number
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.roles import FIXED
from ..model.verdict import verdict
from .balance import in_balance
from .balance import mean_size
from .balance import pull_of
from .closing import closed
from .closing import closed_anew
from .closing import closed_with_edges
from .layout import among
from .loads import nodal_load
from .materials import metres_per_unit
from .membrane_fields import principal_forces
from .membrane_fields import stress_by_formula
from .membrane_fields import stress_of_bars
from .solved import solved_problem

__all__ = ["EdgeLoads", "MembraneState", "forces_at_vertices", "membrane"]

FLAT_CURVATURE = 1e-9  # K times area below which a region counts as K = 0
BALANCE_TOLERANCE = 1e-9  # residual relative to the load above which no equilibrium state exists
MAX_CORRECTION = 0.05  # relative correction of edge forces up to which they agree with the formula
MIN_IMPROVEMENT = 0.5  # a slid mesh must reduce the correction to at most this fraction


class EdgeLoads(NamedTuple):
    """Line loads of regions on their boundaries."""

    edges: Edges  # (e, 2) edges along boundaries and creases
    kind: IntArray  # (e,) 0 support, 1 crease, 2 free edge
    load: Vectors  # (e, 3) force of the surface on the line per length [F/L]


@dataclass(frozen=True, eq=False)
class MembraneState:
    """Membrane state of a surface under a load; tension is positive.

    Parameters
    ----------
    problem
        The surface.
    pressure
        Load along the normals [F/L^2].
    weight
        Downward load per area of the surface [F/L^2].
    forces
        (m, 2) principal forces N1 and N2 of every face, N1 the larger [F/L].
    directions
        (m, 2, 3) unit vectors of N1 and N2.
    edges
        (b, 2) edges inside regions.
    edge_forces
        (b,) edge forces in equilibrium [F].
    reactions
        (n, 3) forces on the surface at vertices around regions, 0 elsewhere [F].
    edge_loads
        Line loads along the boundaries of regions.
    out_of_balance
        Median residual of the forces by the formula, relative to the load; NaN with weight.
    correction
        Relative change of the edge forces for equilibrium; NaN with weight.
    imbalance
        Largest residual of the equilibrium state, relative to the load.
    remarks
        Notes in sentences.
    moved
        Largest displacement of a vertex by sliding [L].

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import membrane
    >>> state = membrane(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), pressure=0.3)
    >>> state.imbalance < 1e-9
    True
    """

    problem: CGCProblem
    pressure: float  # along the normals [F/L^2]
    weight: float  # downwards, per area of the surface [F/L^2]
    forces: FloatArray  # (m, 2) N1 and N2 of every face, N1 the larger [F/L]
    directions: FloatArray  # (m, 2, 3) unit vectors of N1 and N2
    edges: Edges  # (b, 2) edges inside regions
    edge_forces: FloatArray  # (b,) edge forces in equilibrium [F]
    reactions: Vectors  # (n, 3) forces on the surface at vertices around regions, 0 elsewhere [F]
    edge_loads: EdgeLoads  # line loads along the boundaries of regions
    out_of_balance: float  # median residual of the formula relative to the load; NaN with weight
    correction: float  # relative change of the edge forces for equilibrium; NaN with weight
    imbalance: float  # largest residual relative to the load
    remarks: tuple[str, ...]  # notes in sentences
    moved: float = 0.0  # largest displacement of a vertex by sliding [L]

    @property
    def load(self) -> Vectors:
        """Load at every vertex (n, 3) [F]."""
        return nodal_load(self.problem.vertices, self.problem.faces, self.pressure, self.weight)

    @property
    def totals(self) -> tuple[Vectors, Vectors]:
        """Sums of the loads and of the reactions, (3,) each [F]."""
        return self.load.sum(axis=0), self.reactions.sum(axis=0)

    @property
    def _size(self) -> float:
        return float(np.linalg.norm(self.load, axis=1).sum())

    def summary(self) -> str:
        """Return lines of text with the forces."""
        N1, N2 = self.forces.T
        lines = [
            f"N1 {N1.min():.4g} to {N1.max():.4g} (median {np.median(N1):.4g}), N2 {N2.min():.4g} to {N2.max():.4g}; tension is positive; "
            "units are force per length, with the load in force per area"
        ]
        for kind, name in enumerate(("supports", "creases", "free edges")):
            load = np.linalg.norm(self.edge_loads.load[self.edge_loads.kind == kind], axis=1)
            if len(load):
                lines.append(f"line load on {name}: up to {load.max():.4g}, median {np.median(load):.4g}")
        if np.isfinite(self.out_of_balance):
            change = f"corrected by changing edge forces by {100 * self.correction:.2g} %"
            lines.append(f"residual of the formula: {100 * self.out_of_balance:.2g} % of the load (median), {change}")
        sums = [", ".join(f"{x:.5g}" for x in np.where(np.abs(total) < 1e-9 * self._size, 0.0, total)) for total in self.totals]
        lines.append(
            f"equilibrium to {self.imbalance:.1g} of the load; total load ({sums[0]}), reactions of supports, creases, beams ({sums[1]})"
        )
        return "\n".join([*lines, *self.remarks])

    __str__ = summary


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
        Whether to slide inner vertices along the surface until triangles close as with the measure exact, where edge forces by
        the formula are far from equilibrium under pressure, as on irregular meshes. A remark gives the distance. If sliding
        fails, edges inside regions are flipped too, so that the mesh of the state has other faces.
    rough
        Whether to accept a surface with the verdict rough, see :class:`compas_cgc.analysis.Verdict`.

    Returns
    -------
    MembraneState

    Raises
    ------
    CGCError
        If the surface is rough, the load is zero or not finite, a region has K = 0, or no equilibrium state exists with the given
        supports and beams.

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
        raise CGCError("the load is zero; give a pressure, a weight or both")
    _check(problem, problem.region_targets())
    state = _state(problem, pressure, weight, edge_beams)
    if state.imbalance > BALANCE_TOLERANCE:
        # Far from a balance, another mesh does not help.
        nearby = closed_with_edges(problem) if close and state.imbalance < MAX_CORRECTION else None
        exact = _state(nearby, pressure, weight, edge_beams) if nearby is not None and (rough or verdict(nearby).fair) else state
        if exact.imbalance > BALANCE_TOLERANCE:
            raise CGCError(_no_state(exact.imbalance, edge_beams))
        return _slid(exact, state)
    if not (close and state.correction > MAX_CORRECTION):
        return state
    for close_triangles in (closed, closed_anew):
        nearby = close_triangles(problem)
        if nearby is not None and (rough or verdict(nearby).fair):
            exact = _state(nearby, pressure, weight, edge_beams)
            if exact.imbalance <= BALANCE_TOLERANCE and exact.correction <= MIN_IMPROVEMENT * state.correction:
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
        f"vertices were slid by up to {unit * far:.3g} mm along the surface, and by up to {unit * away:.2g} mm off it, until triangles "
        f"close as with the measure exact{_turned(problem.faces, slid.faces)}; {without}"
    )
    return replace(exact, moved=far, remarks=(said, *exact.remarks))


def _turned(before: Faces, after: Faces) -> str:
    """Return the part of the remark about remeshed triangles."""
    count = int((np.sort(before, axis=1) != np.sort(after, axis=1)).any(axis=1).sum())
    return f", and {count} of {len(after)} triangles were replaced" if count else ""


def _state(problem: CGCProblem, pressure: float, weight: float, edge_beams: bool) -> MembraneState:
    """Return the membrane state of a surface without sliding, which may be out of balance."""
    V, F = problem.vertices, problem.faces
    targets, label = problem.region_targets(), problem.regions()
    bars, on = _bars(problem)
    curvature = np.array([0.0 if K is None else K for K in targets])
    folds = _folds(V, F, bars)
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
        bars, start = np.vstack([bars, _rim_bars(F, rim)]), np.r_[start, np.zeros(len(rim))]
    forces, before, after = in_balance(V, F, bars, start, load, balanced)
    size = mean_size(load)
    tensors = stress_of_bars(V, F, bars, forces)
    if weight == 0.0:
        tensors = stress_by_formula(problem, label, curvature, pressure)
    values, vectors = principal_forces(tensors, face_normals(V, F))
    pull = pull_of(V, bars, forces)
    reactions = np.where((~balanced)[:, None], -(pull + load), 0.0)
    own_load = _edge_loads(V, F, on, tensors)
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
        _remarks(own_load, edge_beams, changed),
    )


def _check(problem: CGCProblem, targets: list[Optional[float]]) -> None:
    label, areas = problem.regions(), face_areas(problem.vertices, problem.faces)
    for region, K in enumerate(targets):
        if K is None:
            raise CGCError(f"region {region} has no single target K, which determines the forces; set one and solve first")
        if abs(K) * areas[label == region].sum() < FLAT_CURVATURE:
            raise CGCError(
                f"region {region} has K = 0, where curvature does not determine the membrane forces; export the mesh for a "
                "finite-element analysis, or give the region a small curvature"
            )


def _bars(problem: CGCProblem) -> tuple[Edges, EdgeLoads]:
    """Return the edges inside regions with their faces (b, 4), and the edges around regions."""
    V, F = problem.vertices, problem.faces
    edges = edge_faces(F)
    around = (edges[:, 3] < 0) | among(edges[:, :2], problem.creases, len(V))
    rim = edges[around]
    fixed = problem.roles == FIXED
    held = fixed[rim[:, :2]].all(axis=1)
    kind = np.where(held, 0, np.where(rim[:, 3] >= 0, 1, 2))
    return edges[~around], EdgeLoads(rim[:, :2], kind, np.zeros((len(rim), 3)))


def _rim_bars(F: Faces, rim: Edges) -> Edges:
    edges = edge_faces(F)
    return edges[among(edges[:, :2], rim, int(F.max()) + 1)]


def _folds(V: Vertices, F: Faces, bars: Edges) -> FloatArray:
    """Return the fold angles of edges, positive where convex (b,) [rad]."""
    u, v, left, right = bars.T
    normals = face_normals(V, F)
    along = V[v] - V[u]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    sine = np.einsum("ij,ij->i", np.cross(normals[left], normals[right]), along)
    return np.arctan2(sine, np.einsum("ij,ij->i", normals[left], normals[right]))


def _no_state(rest: float, edge_beams: bool) -> str:
    if not edge_beams:
        return (
            f"without edge beams, membrane forces cannot balance this load (residual {100 * rest:.2g} % of the load); "
            "support the free edges or give them "
            "edge beams (edge_beams=True), whose line loads are reported"
        )
    return (
        f"no membrane state carries this load (residual {100 * rest:.2g} % of the load); support the surface along its whole boundary, "
        "or use a finite-element analysis with bending"
    )


def _edge_loads(V: Vertices, F: Faces, on: EdgeLoads, corners: FloatArray) -> EdgeLoads:
    """Return the line loads on the boundaries of regions: -N nu, summed over both sides of a crease."""
    edges = edge_faces(F)
    edges = edges[among(edges[:, :2], on.edges, len(V))]
    normals = face_normals(V, F)
    along = V[edges[:, 1]] - V[edges[:, 0]]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    load = np.zeros((len(edges), 3))
    for side, sign in ((2, 1.0), (3, -1.0)):
        face = edges[:, side]
        outward = sign * np.cross(along, normals[face])
        ends = [corners[face, np.argmax(F[face] == edges[:, k, None], axis=1)] for k in (0, 1)]
        load += np.where((face >= 0)[:, None], -np.einsum("eij,ej->ei", 0.5 * (ends[0] + ends[1]), outward), 0.0)
    return EdgeLoads(edges[:, :2], on.kind, load)


def _remarks(loads: EdgeLoads, edge_beams: bool, correction: float) -> tuple[str, ...]:
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


def forces_at_vertices(state: MembraneState) -> FloatArray:
    """Return N1 and N2 at every vertex, the mean of its faces (n, 2) [F/L]."""
    F, n = state.problem.faces, len(state.problem.vertices)
    count = np.maximum(np.bincount(F.ravel(), minlength=n), 1)
    return np.column_stack([np.bincount(F.ravel(), np.repeat(state.forces[:, k], 3), n) / count for k in (0, 1)])
