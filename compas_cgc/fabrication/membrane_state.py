"""Membrane forces of surfaces of constant K, and a discrete state in balance.

The cofactor of the shape operator S has no divergence on any surface, so ``N = p / (2 K) cof S`` balances a uniform
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
from ..discrete.arrays import PerFace
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
from .layout import among
from .loads import nodal_load
from .materials import metres_per_unit
from .membrane_fields import principal_forces
from .membrane_fields import stress_by_formula
from .membrane_fields import stress_of_bars
from .solved import solved_problem

__all__ = ["EdgeLoads", "MembraneState", "forces_at_vertices", "membrane", "stress_at_vertices"]

FLAT = 1e-9  # K against one over the area, below which a region counts as flat
BALANCED = 1e-9  # out of balance, against the load, of a state that is none
NEAR = 0.05  # correction of edge forces, against them, up to which these are those of the formula
BETTER = 0.5  # part of the correction that a move has to leave at most


class EdgeLoads(NamedTuple):
    """What regions ask of the lines around them."""

    edges: Edges  # (e, 2) along open edges and creases
    kind: IntArray  # (e,) 0 support, 1 crease, 2 free edge
    load: Vectors  # (e, 3) force of the surface on the line, for each length of it [F/L]


@dataclass(frozen=True, eq=False)
class MembraneState:
    """Forces in a surface under a load, tension positive.

    Parameters
    ----------
    problem
        The surface.
    pressure
        Along the normals [F/L^2].
    weight
        Downwards, for each area of the surface [F/L^2].
    forces
        (m, 2) N1 and N2 of every face, N1 the larger [F/L].
    directions
        (m, 2, 3) unit vectors of N1 and N2.
    edges
        (b, 2) edges inside of regions.
    edge_forces
        (b,) force in each, in balance [F].
    reactions
        (n, 3) force on the surface at vertices around regions, 0 elsewhere [F].
    edge_loads
        What lines around regions have to carry.
    out_of_balance
        Of the forces by the formula, median over the vertices, against the load; NaN with weight.
    correction
        Change of the edge forces that brings balance, against them; NaN with weight.
    imbalance
        Of the balanced state, against the load.
    remarks
        What is to be said of it, in sentences.
    moved
        Farthest that a vertex was slid from where it was given, so that triangles close [L].

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
    weight: float  # downwards, for each area of the surface [F/L^2]
    forces: FloatArray  # (m, 2) N1 and N2 of every face, N1 the larger [F/L]
    directions: FloatArray  # (m, 2, 3) unit vectors of N1 and N2
    edges: Edges  # (b, 2) edges inside of regions
    edge_forces: FloatArray  # (b,) force in each, in balance [F]
    reactions: Vectors  # (n, 3) force on the surface at vertices around regions, 0 elsewhere [F]
    edge_loads: EdgeLoads
    out_of_balance: float  # of the forces by the formula, median over the vertices, against the load; NaN with weight
    correction: float  # change of the edge forces that brings balance, against them; NaN with weight
    imbalance: float  # of the balanced state, against the load
    remarks: tuple[str, ...]
    moved: float = 0.0  # farthest that a vertex was slid from where it was given, so that triangles close [L]

    @property
    def load(self) -> Vectors:
        """Load at every vertex (n, 3) [F]."""
        return nodal_load(self.problem.vertices, self.problem.faces, self.pressure, self.weight)

    @property
    def totals(self) -> tuple[Vectors, Vectors]:
        """The sums of the load and of the reactions, (3,) each [F]."""
        return self.load.sum(axis=0), self.reactions.sum(axis=0)

    @property
    def _size(self) -> float:
        return float(np.linalg.norm(self.load, axis=1).sum())

    def summary(self) -> str:
        """Return the forces in lines."""
        N1, N2 = self.forces.T
        lines = [
            f"N1 {N1.min():.4g} to {N1.max():.4g} (median {np.median(N1):.4g}), N2 {N2.min():.4g} to {N2.max():.4g}, tension positive, "
            "in force per length as the load is in force per area"
        ]
        for kind, name in enumerate(("supports", "creases", "free edges")):
            load = np.linalg.norm(self.edge_loads.load[self.edge_loads.kind == kind], axis=1)
            if len(load):
                lines.append(f"line load on {name}: up to {load.max():.4g}, median {np.median(load):.4g}")
        if np.isfinite(self.out_of_balance):
            mend = f"put right by {100 * self.correction:.2g} % of the forces"
            lines.append(f"the formula is out of balance by {self.out_of_balance:.2g} of the load, {mend}")
        sums = [", ".join(f"{x:.5g}" for x in np.where(np.abs(total) < 1e-9 * self._size, 0.0, total)) for total in self.totals]
        lines.append(
            f"balanced to {self.imbalance:.1g} of the load, in all ({sums[0]}); supports, creases and beams take it with ({sums[1]})"
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
    """Return the membrane forces of a solved surface, and edge forces that balance its load exactly.

    Parameters
    ----------
    surface
        A problem, a mesh, or what has ``to_problem()``, of one target K for each region.
    pressure
        Along the normals, positive when it pushes outwards [F/L^2].
    weight
        For each area of the surface, along -z [F/L^2].
    edge_beams
        Whether free edges have beams that take the forces of the surface. Without, the surface has to be in balance
        without them, which few are.
    close
        Whether vertices inside of regions are slid along the surface where edge forces by the formula are far from balance under
        pressure, as on irregular meshes: until the triangles close as with the measure exact. How far is said.
        Where they leave no room for it edges inside of regions are turned too, and the state is of a mesh of other faces.
    rough
        Whether a rough surface (see :class:`compas_cgc.analysis.Verdict`) is taken as it is.

    Returns
    -------
    MembraneState

    Raises
    ------
    CGCError
        If the surface is rough, or there is no such state: no load or an endless one, a region of K = 0, no support or beam around a
        region, a free edge that cannot be left unloaded.

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
        raise CGCError(f"a load must be finite, not a pressure of {pressure:g} and a weight of {weight:g}; give it in units of the model")
    if pressure == 0.0 and weight == 0.0:
        raise CGCError("there is no load; give a pressure, a weight or both")
    _check(problem, problem.region_targets())
    state = _state(problem, pressure, weight, edge_beams)
    if not (close and state.correction > NEAR):
        return state
    for close_triangles in (closed, closed_anew):
        nearby = close_triangles(problem)
        if nearby is not None and (rough or verdict(nearby).fair):
            exact = _state(nearby, pressure, weight, edge_beams)
            if exact.correction <= BETTER * state.correction:
                return _slid(exact, state)
    return state


def _slid(exact: MembraneState, state: MembraneState) -> MembraneState:
    """Return a state of vertices that were slid, with a sentence that says so."""
    problem = state.problem
    slid = exact.problem
    move = slid.vertices - problem.vertices
    # Between the normals at both ends, as a move along a bend leaves the plane at either.
    normals = vertex_normals(problem.vertices, problem.faces) + vertex_normals(slid.vertices, slid.faces)
    off = 0.5 * np.abs(np.einsum("ij,ij->i", move, normals))
    unit = 1e3 * metres_per_unit(problem.drawing.units)
    far, away = float(np.linalg.norm(move, axis=1).max()), float(off.max())
    said = (
        f"vertices were slid along the surface, by up to {unit * far:.3g} mm and off it by up to {unit * away:.2g} mm, until triangles "
        f"close as with the measure exact{_turned(problem.faces, slid.faces)}; before, edge forces had to be "
        f"{100 * state.correction:.3g} % off the formula for balance"
    )
    return replace(exact, moved=far, remarks=(said, *exact.remarks))


def _turned(before: Faces, after: Faces) -> str:
    """Return what is said where triangles were laid out anew."""
    count = int((np.sort(before, axis=1) != np.sort(after, axis=1)).any(axis=1).sum())
    return f", on triangles of which {count} of {len(after)} were laid out anew" if count else ""


def _state(problem: CGCProblem, pressure: float, weight: float, edge_beams: bool) -> MembraneState:
    """Return the forces in a surface as it is."""
    V, F = problem.vertices, problem.faces
    targets, label = problem.region_targets(), problem.regions()
    bars, on = _bars(problem)
    curvature = np.array([0.0 if K is None else K for K in targets])
    folds = _folds(V, F, bars)
    start = pressure * folds / (2.0 * curvature[label[bars[:, 2]]])
    load = nodal_load(V, F, pressure, weight)
    inner = np.ones(len(V), bool)
    inner[np.unique(on.edges)] = False
    # Without beams the vertices along free edges have to balance too.
    free = np.zeros(len(V), bool)
    free[np.unique(on.edges[on.kind == 2])] = True
    free[np.unique(on.edges[on.kind != 2])] = False
    balanced = inner | (free & (not edge_beams))
    if not edge_beams:
        rim = on.edges[on.kind == 2]
        bars, start = np.vstack([bars, _rim_bars(F, rim)]), np.r_[start, np.zeros(len(rim))]
    forces, before, after = in_balance(V, F, bars, start, load, balanced)
    size = mean_size(load)
    if after > BALANCED:
        raise CGCError(_no_state(after, edge_beams))
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
            raise CGCError(f"region {region} has no one target K; the forces follow from one, so set it and solve first")
        if abs(K) * areas[label == region].sum() < FLAT:
            raise CGCError(
                f"region {region} has K = 0, where curvature alone does not tell the forces: they follow from how its edges are held; "
                "export the mesh for finite elements, or give the region a little curvature"
            )


def _bars(problem: CGCProblem) -> tuple[Edges, EdgeLoads]:
    """Return the edges inside of regions with their faces (b, 4), and those around regions."""
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
    """Return the angle over every edge, positive where convex [rad] (b,)."""
    u, v, left, right = bars.T
    normals = face_normals(V, F)
    along = V[v] - V[u]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    sine = np.einsum("ij,ij->i", np.cross(normals[left], normals[right]), along)
    return np.arctan2(sine, np.einsum("ij,ij->i", normals[left], normals[right]))


def _no_state(rest: float, edge_beams: bool) -> str:
    if not edge_beams:
        return (
            f"no membrane state leaves the free edges unloaded ({rest:.2g} of the load stays): give them edge beams, "
            "or support them; their line loads come with edge_beams=True"
        )
    return (
        f"no membrane state carries this load ({rest:.2g} of it stays): hold the surface along all of its edge, or leave the load to "
        "finite elements with bending"
    )


def _edge_loads(V: Vertices, F: Faces, on: EdgeLoads, corners: FloatArray) -> EdgeLoads:
    """Return the force of the surface on the lines around regions: -N nu, of both sides of a crease."""
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
    creases = np.linalg.norm(loads.load[loads.kind == 1], axis=1)
    remarks = []
    if len(free) and edge_beams:
        remarks.append(f"free edges need an edge beam for a line load of up to {free.max():.4g}; no membrane leaves them unloaded")
    if len(creases):
        remarks.append(f"creases have to carry line loads of up to {creases.max():.4g} to the supports")
    if correction > NEAR:
        remarks.append(
            f"single edge forces are {100 * correction:.3g} % off the formula, as the layout of an irregular mesh asks for; N1, N2 and "
            "line loads are not; solve with the measure exact to have them near it"
        )
    return tuple(remarks)


def stress_at_vertices(state: MembraneState) -> FloatArray:
    """Return N of every vertex in space, the mean over its faces by area (n, 3, 3) [F/L]."""
    V, F = state.problem.vertices, state.problem.faces
    areas: PerFace = face_areas(V, F)
    tensors = np.einsum("mk,mki,mkj->mij", state.forces, state.directions, state.directions)
    total, area = np.zeros((len(V), 3, 3)), np.zeros(len(V))
    for k in range(3):
        np.add.at(total, F[:, k], tensors * areas[:, None, None])
        np.add.at(area, F[:, k], areas)
    return total / np.maximum(area, np.finfo(float).tiny)[:, None, None]


def forces_at_vertices(state: MembraneState) -> FloatArray:
    """Return N1 and N2 at every vertex (n, 2), the mean over its faces [F/L]."""
    F, n = state.problem.faces, len(state.problem.vertices)
    count = np.maximum(np.bincount(F.ravel(), minlength=n), 1)
    return np.column_stack([np.bincount(F.ravel(), np.repeat(state.forces[:, k], 3), n) / count for k in (0, 1)])
