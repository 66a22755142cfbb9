"""Initial surfaces: plates that would bend by themselves to the curvature prescribed, over the supports of the drawing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete import edge_faces
from ...discrete.arrays import TINY
from ...discrete.arrays import FloatArray
from ...discrete.measured_curvature import even_angles
from ...discrete.mid_edge import OCCURRENCES
from ...discrete.mid_edge import TRACE
from ...linalg import factorise
from ...model.laws import Shape
from ...model.tolerances import DRAWING_ACCURACY
from ..constants import GROUND
from ..constants import SHAPE_KEPT
from ..constants import SIDE_SHARE
from .lagrangian import Lagrangian
from .lagrangian import State
from .patterns import DIRECTIONS
from .patterns import Patterns

__all__ = ["Lifted", "from_surface", "is_kept", "over_its_plate", "plate", "saddles", "starts"]

# median over mean of the squared curvature of a drawing, below which it bends beside supports alone; half and twice it select the same
MOST_PLACES = 0.02
# slope beside supports over that elsewhere, above which supports were pulled out of a sheet; half and twice it select the same
PULLED = 2.0
FLAT_FACE = 1e-8  # squared curvature times area below which a drawing is flat; a sagitta of 1e-5 of the size is invisible
FLAT = 3e-5  # curvature relative to the largest below which it is zero; as FLAT_FACE, for K


class _Plate:
    """The linear response of the plate over the supports to curvature of its own."""

    def __init__(self, lagrangian: Lagrangian):
        self.lagrangian, self.here = lagrangian, plate(lagrangian)
        stiffness = _stiffness(lagrangian, self.here)
        q = lagrangian.size
        self._solver = factorise(_firm(stiffness[:q, :q]), symmetric=True)

    def load(self, own: FloatArray) -> FloatArray:
        """Return the forces (q,) of curvature of its own (m, 6) [1/L]."""
        mesh, operators = self.lagrangian.mesh, self.here.operators
        pull = np.einsum("me,mek->mk", 2.0 * OCCURRENCES * own, operators.tensor_slopes)
        whole = np.asarray(np.bincount(mesh.columns.ravel(), pull.ravel(), mesh.unknowns), dtype=np.float64)
        return whole[self.lagrangian.free]

    def responses(self, loads: FloatArray) -> FloatArray:
        """Return the steps (k, q) that forces (k, q) cause."""
        return self._solver.solve(np.ascontiguousarray(loads.T)).T


def starts(lagrangian: Lagrangian) -> Iterator[State]:
    """Return initial surfaces that do not depend on the triangles, the likeliest first.

    The plate wants to bend to the shape operators of the laws: alike in all directions, first to one side, where K̄ > 0; as a
    saddle, turned to where bending energy is least, up and down, where K̄ < 0; where H is prescribed, alike in all directions to
    its side. Where H = 0 it bends over its supports, and where K̄ = 0 to a cylinder through them.
    """
    if np.isfinite(lagrangian.waves) or not lagrangian.has_plan:
        yield from_surface(lagrangian, lagrangian.drawing)
        if not lagrangian.has_plan:
            return
    own = _Plate(lagrangian)
    steady, parts, patterns = _posed(lagrangian, own)
    found = patterns.found()
    steps = [steady + np.einsum("ra,raq->q", pattern, parts) for pattern in found]
    if patterns.turned:
        # Of mirror twins the one that rises along the normals comes first.
        ranks = patterns.ranks(found)
        moments = [_moments(lagrangian, own.here, -step) for step in steps]
        order = sorted(range(len(found)), key=lambda k: (ranks[k], moments[k]))
        steps = [steps[k] for k in order]
    for step in steps:
        yield _with_even_angles(lagrangian, own.here, step)


class Lifted(NamedTuple):
    """An initial surface whose supports are not in their places, and by what it moves when they are lifted by as much as they are."""

    state: State
    lift: FloatArray  # (u,)
    missed: float  # largest distance of a support from its place [L]


def saddles(lagrangian: Lagrangian) -> Iterator[Lifted]:
    """Return the saddles of one region without supports, turned to where they pass near to these; none with creases or domes.

    Over supports of any heights the plate has several valleys, which meet in branch points. A saddle has none, and keeps to that
    while its supports are lowered to their places.
    """
    mesh, V, shape = lagrangian.mesh, lagrangian.drawing, _face_shapes(lagrangian)
    flat = FLAT * max(float(np.abs(part).max(initial=0.0)) for part in shape)
    if not lagrangian.has_plan or not (shape.saddle > flat).all() or np.ptp(mesh.pairs[:, 1]) > 0:
        return
    up = mesh.directions[0]
    along = _main_direction(lagrangian)
    along = along - (along @ up) * up
    along /= np.linalg.norm(along)
    x, y = ((V - V.mean(axis=0)) @ axis for axis in (along, np.cross(up, along)))
    heights, fixed = V @ up, lagrangian.held
    plane, bowl = np.column_stack([np.ones_like(x), x, y]), -0.5 * shape.mean.mean() * (x**2 + y**2)
    turns = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    forms = 0.5 * shape.saddle.mean() * (np.outer(np.cos(2.0 * turns), x**2 - y**2) + np.outer(np.sin(2.0 * turns), 2.0 * x * y))
    tilts = np.linalg.lstsq(plane[fixed], (heights - bowl - forms)[:, fixed].T, rcond=None)[0]
    lifts = bowl + forms + (plane @ tilts).T - heights
    missed = np.abs(lifts[:, fixed]).max(axis=1)
    nearest = np.flatnonzero((missed <= np.roll(missed, 1)) & (missed < np.roll(missed, -1)))
    for turn in nearest[np.argsort(missed[nearest], kind="stable")]:
        unknowns = np.append(lifts[turn], np.zeros(len(mesh.angles.ends)))
        unknowns[len(V) :] = even_angles(mesh, lagrangian.vertices(unknowns))
        yield Lifted(lagrangian.at(unknowns), bent_by_supports(lagrangian, lifts[turn]), float(missed[turn]))


def _moments(lagrangian: Lagrangian, here: State, step: FloatArray) -> tuple[float, ...]:
    """Return the volume under the moves of a step (q,), and its second moments."""
    moves = np.zeros(len(lagrangian.drawing))
    moves[lagrangian.free[: lagrangian.moves]] = step[: lagrangian.moves]
    return lagrangian.moments(moves, here.operators.areas)


def _posed(lagrangian: Lagrangian, own: _Plate) -> tuple[FloatArray, FloatArray, Patterns]:
    """Return the step (q,) to the curvature that no region has a choice of, those (r, 3, q) for each choice, and their energies."""
    mesh, shape = lagrangian.mesh, _face_shapes(lagrangian)
    region = mesh.pairs[mesh.pair_of[:, 0], 1]
    labels, region = np.unique(region, return_inverse=True)
    round_, along, across = _tensors(lagrangian)
    flat = FLAT * max(float(np.abs(part).max(initial=0.0)) for part in shape)
    # Over level supports a sheet stays flat.
    sheets = lagrangian.is_parabolic and float(own.here.operators.bending.sum()) > FLAT_FACE
    wanted = np.stack([shape.round[:, None] * round_, shape.saddle[:, None] * along, shape.saddle[:, None] * across])
    steady = shape.mean[:, None] * round_
    held = [shape.round > flat, shape.saddle > flat]
    domes, saddles = (np.bincount(region[some], minlength=len(labels)) > 0 for some in held)
    if sheets:
        wanted = np.stack([round_, along, across])
    used = np.column_stack([domes | sheets, saddles | sheets, saddles | sheets])
    r, kind = np.nonzero(used)
    count = len(r)
    curvatures = np.where((region == r[:, None])[..., None], wanted[kind], 0.0)
    loads = np.array([own.load(one) for one in curvatures]).reshape(count, lagrangian.size)
    steps = own.responses(loads)
    weight = np.sqrt(own.here.operators.areas[:, None] * OCCURRENCES)
    rows = (weight * curvatures).reshape(count, round_.size)
    base = (weight * (steady - _present(own.here))).ravel()
    force = own.load(steady)
    first = own.responses(force[None])[0]
    gram, slope = np.zeros((len(labels), 3, len(labels), 3)), np.zeros((len(labels), 3))
    gram[r[:, None], kind[:, None], r, kind] = rows @ rows.T - 0.5 * loads @ steps.T
    slope[r, kind] = rows @ base - 0.5 * steps @ force
    parts = np.zeros((len(labels), 3, lagrangian.size))
    parts[r, kind] = steps
    constant = float(base @ base - 0.5 * force @ first)
    bent = float(((weight * (round_ + along)) ** 2).sum()) if sheets else 0.0
    return first, parts, Patterns(gram, slope, constant, domes, saddles, bent, lagrangian.side)


def _with_even_angles(lagrangian: Lagrangian, here: State, step: FloatArray) -> State:
    """Return the state with the moves of a step (q,), and the angles for which its shape operators vary most evenly."""
    unknowns = here.unknowns.copy()
    unknowns[lagrangian.free[: lagrangian.moves]] += step[: lagrangian.moves]
    unknowns[len(lagrangian.drawing) :] = even_angles(lagrangian.mesh, lagrangian.vertices(unknowns))
    return lagrangian.at(unknowns)


def from_surface(lagrangian: Lagrangian, vertices: FloatArray) -> State:
    """Return the state whose vertices (n, 3) are as near to a surface as their directions allow."""
    unknowns = np.zeros(lagrangian.mesh.unknowns)
    moved = lagrangian.free[: lagrangian.moves]
    unknowns[moved] = np.einsum("ni,ni->n", vertices - lagrangian.drawing, lagrangian.mesh.directions)[moved]
    unknowns[len(vertices) :] = even_angles(lagrangian.mesh, lagrangian.vertices(unknowns))
    return lagrangian.at(unknowns)


def over_its_plate(lagrangian: Lagrangian) -> Lagrangian:
    """Return the problem over the plate through its supports, so that heights of the drawing say nothing but the side of domes.

    A drawing lies on the other side where most of it bends away from the normals, or where its volume over the plate says so. The
    volume says nothing where supports were pulled out of a sheet.
    """
    mesh, V = lagrangian.mesh, lagrangian.drawing
    if not lagrangian.has_plan or np.ptp(np.einsum("ni,ni->n", V, mesh.directions)) <= FLAT_FACE:
        return lagrangian
    here, drawn = plate(lagrangian), from_surface(lagrangian, V)
    curvature = _face_shapes(lagrangian).round
    trace = [own.operators.tensors @ TRACE / own.operators.areas for own in (drawn, here)]
    areas = here.operators.areas
    against = curvature.any() and float(areas[trace[0] - trace[1] < -SIDE_SHARE * 2.0 * curvature].sum()) > 0.5 * float(areas.sum())
    edges = edge_faces(mesh.faces)[:, :2]
    fixed = np.ones(len(V), bool)
    fixed[lagrangian.free[: lagrangian.moves]] = False
    step = V[edges[:, 1]] - V[edges[:, 0]]
    slope = np.abs(np.einsum("ex,ex->e", step, mesh.directions[edges[:, 0]])) / np.linalg.norm(step, axis=1)
    beside = fixed[edges].any(axis=1)
    pulled = slope[beside].max(initial=0.0) > PULLED * slope[~beside].max(initial=0.0)
    under = lagrangian.volume(here.unknowns, areas)
    against = against or (not pulled and under > SIDE_SHARE * float(curvature @ areas) * float(areas.sum()) / 4.0)
    return lagrangian.over(lagrangian.vertices(here.unknowns), -1.0 if against else 1.0)


def is_kept(lagrangian: Lagrangian) -> bool:
    """Return whether the shape of a drawing is kept.

    It is not where the laws and the supports determine the surface. Else it is where the drawing has no plan, or bends in most
    places far more than its supports make it. Over a plan with elliptic laws,
    such as K̄ > 0 or constant H, the supports alone determine the dome, and the drawing says its side.
    """
    if lagrangian.is_determined:
        return False
    if not lagrangian.has_plan:
        return True
    if (lagrangian.types > 0.0).all():
        return False
    typical, mean = _density(from_surface(lagrangian, lagrangian.drawing))
    return typical > max(MOST_PLACES * mean, FLAT_FACE) and typical > SHAPE_KEPT * _density(plate(lagrangian))[0]


def _density(state: State) -> tuple[float, float]:
    """Return the median and the mean of the squared curvature of faces times the area of the mesh: half of the area bends less."""
    own = state.operators
    density = own.bending / own.areas
    order = np.argsort(density)
    below = np.cumsum(own.areas[order])
    return float(density[order[np.searchsorted(below, 0.5 * below[-1])]] * below[-1]), float(own.bending.sum())


def plate(lagrangian: Lagrangian) -> State:
    """Return the surface over the supports that bends least, whatever its curvature.

    Over a plan it is a linear plate, whose heights at the supports are those of the drawing. A drawing without a plan stands for itself.
    """
    mesh, V = lagrangian.mesh, lagrangian.drawing
    heights = np.einsum("ni,ni->n", V, mesh.directions)
    at = np.zeros(mesh.unknowns)
    if lagrangian.has_plan:
        moved = lagrangian.free[: lagrangian.moves]
        at[moved] = (bent_by_supports(lagrangian, heights)[: len(V)] - heights)[moved]
    at[len(V) :] = even_angles(mesh, lagrangian.vertices(at))
    return lagrangian.at(at)


def bent_by_supports(lagrangian: Lagrangian, heights: FloatArray) -> FloatArray:
    """Return moves and angles (u,) of the flat plate over a plan whose supports are lifted to heights, of which (n,) are given."""
    mesh, V, free = lagrangian.mesh, lagrangian.drawing, lagrangian.free
    flat = lagrangian.on(V - np.einsum("ni,ni->n", V, mesh.directions)[:, None] * mesh.directions)
    stiffness = _stiffness(flat, flat.at(np.zeros(mesh.unknowns)))
    fixed = lagrangian.held
    level = float(heights[fixed].mean()) if len(fixed) else 0.0
    moves, lifted = np.zeros(mesh.unknowns), heights[fixed] - level
    moves[fixed] = lifted
    if np.abs(lifted).max(initial=0.0) > 0.0:
        moves[free] = factorise(_firm(stiffness[free][:, free]), symmetric=True).solve(-(stiffness[free][:, fixed] @ lifted))
    # Turns of the plate, which bend nothing, are those that rounding leaves.
    moves[: len(V)] = lagrangian.turns.taken_out(moves[: len(V)]) + level
    return moves


def _stiffness(lagrangian: Lagrangian, here: State) -> sparse.csr_matrix:
    """Return the second derivatives (q, q) of the energy by the free unknowns, without those that may be negative."""
    pattern, q = lagrangian.pattern, lagrangian.size
    model = lagrangian.model(here, np.zeros(lagrangian.count))
    return sparse.csr_matrix((model.convex, pattern.indices, pattern.indptr), shape=(pattern.size, pattern.size))[:q, :q].tocsr()


def _firm(stiffness: sparse.csr_matrix) -> sparse.csr_matrix:
    return (stiffness + GROUND * sparse.diags(stiffness.diagonal())).tocsr()


def _present(state: State) -> FloatArray:
    return np.asarray(state.operators.tensors / state.operators.areas[:, None])


def _face_shapes(lagrangian: Lagrangian) -> Shape:
    """Return shape operators of the faces (m,) that obey the laws, means over their equations, zero without any."""
    onto = lagrangian.mesh.incidence[lagrangian.rows].T
    count = np.maximum(onto @ np.ones(len(lagrangian.rows)), 1.0)
    return Shape(*((onto @ part) / count for part in lagrangian.law.shape()))


def _tensors(lagrangian: Lagrangian) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return, packed, the identity of the tangent plane of each face and the two unit saddles in it, in one frame for all (m, 6)."""
    mesh = lagrangian.mesh
    normals = mesh.directions[mesh.faces].sum(axis=1)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    first = _main_direction(lagrangian)
    t = first - (normals @ first)[:, None] * normals
    t /= np.maximum(np.linalg.norm(t, axis=1), TINY)[:, None]
    b = np.cross(normals, t)
    pack = [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]
    tt, bb, tb = (np.einsum("mx,my->mxy", p, q)[:, pack[0], pack[1]] for p, q in ((t, t), (b, b), (t, b)))
    bt = np.einsum("mx,my->mxy", b, t)[:, pack[0], pack[1]]
    return tt + bb, tt - bb, tb + bt


def _main_direction(lagrangian: Lagrangian) -> FloatArray:
    """Return the direction (3,) in which the drawing extends farthest; if it extends alike, that of a coordinate axis in its plane."""
    V = lagrangian.drawing[np.unique(lagrangian.mesh.faces)]
    _, lengths, axes = np.linalg.svd(V - V.mean(axis=0), full_matrices=False)
    if lengths[1] < (1.0 - DRAWING_ACCURACY) * lengths[0]:
        return np.asarray(axes[0])
    axis = np.eye(3)[np.argmin(np.round(np.abs(axes[2]), 6))]
    return np.asarray(axis - (axis @ axes[2]) * axes[2])
