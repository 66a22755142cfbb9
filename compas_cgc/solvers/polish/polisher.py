"""The surface of least bending and folding energy with the curvature prescribed, by mid-edge normals."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ...discrete import energy
from ...discrete import face_areas
from ...discrete.arrays import EPS
from ...discrete.arrays import FloatArray
from ...errors import HALVED
from ...errors import ProblemError
from ...errors import Sentence
from ...errors import allow_more_steps
from ...errors import joined
from ...errors import names_what_was_meant
from ...errors import use_method
from ...linalg.work import is_spent
from ...linalg.work import until_spent
from ...model.constraints import Constraint
from ...model.constraints import Height
from ...model.frame import Frame
from ...model.goals.contradictions import refuse_impossible
from ...model.goals.inequalities import Bound
from ...model.goals.wholes import Whole
from ...model.laws import Law
from ...model.measures import MID_EDGE
from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.recorder import Recorder
from ...model.result import Branch
from ...model.result import Solution
from ...model.roles import DUMMY
from ...model.tolerances import DRAWING_ACCURACY
from ...model.tolerances import NEGLIGIBLE
from ...model.verdict import Verdict
from ...model.verdict import verdict
from ..coarse import Coarse
from ..coarse import laid_out_anew
from ..constants import EVEN_VERTICES
from ..constants import MEDIUM_MESH
from ..constants import TWIN_ENERGIES
from .lagrangian import Lagrangian
from .lagrangian import State
from .least_area import least_area
from .optimiser import steps
from .posed import pair_laws
from .posed import posed
from .posed import takes_goals
from .settings import PolishSettings
from .starts import Lifted
from .starts import from_surface
from .starts import is_kept
from .starts import over_its_plate
from .starts import saddles
from .starts import starts

__all__ = ["Found", "Posed", "begun_from", "fairest", "keeps_shape", "places", "plates", "polish", "posed_as_set"]

# lengths of even curvature over √area that are tried where K̄ < 0; least bending first, then without branch points (docs/method.md)
EVEN = (0.0, 0.55, 0.4)
EVENLY = "evenness = {:g} was used, because the surface of least bending has branch points"
ENERGY_DIGITS = 9  # compared digits of energies; so that rounding errors do not order mirror twins
ROUNDING = 64.0  # rounding errors of a coordinate that residuals contain at least; second differences over an edge of an eighth of the size
FIRST = 0.25  # first fraction of the way by which supports are lowered; four steps if none fails
GROWTH = 1.5  # factor on this fraction after a success; two successes make up for one failure, which halves it
SHORTEST = 0.03  # smallest such fraction; a branch that needs shorter steps ends
WAVES = 0.2  # wavelength over √area below which waves of a kept drawing are smoothed; five waves across a roof


TURNED_OVER = (
    "it meets its goals only on the side of the supports opposite to the drawing; with a smaller curvature it may meet "
    "them on the drawn side"
)
OTHER_GOALS = Sentence(
    "the method bending moves vertices along fixed directions, and such moves cannot meet all of these goals; use the method "
    "projection, or auto",
    [use_method("projection")],
)
WITH_LAWS = (
    "with laws other than constant K vertices move along fixed directions, and such moves cannot meet all of these goals; remove goals "
    "for edges in plan and mirrors"
)


@names_what_was_meant()
def polish(
    problem: CGCProblem,
    *,
    settings: Optional[PolishSettings] = None,
    start: Optional[FloatArray] = None,
    callback: Callback = None,
) -> Solution:
    r"""Return the surface that bends and folds least among those with the curvature prescribed.

    .. math:: \min \int |II|^2 \, dA + \frac1\ell \int \vartheta^2 \, ds \quad \text{subject to} \quad K = \bar K
              \text{ in every region, up to its creases and free edges,}

    by mid-edge normals: one move per vertex along a fixed direction, one angle per edge and two per crease edge.

    Parameters
    ----------
    problem
        Vertices, faces, roles, creases and targets. Vertices on free edges stay over their drawn lines.
    settings
        Parameters.
    start
        ``(n, 3)`` surface for other targets over the same drawing, to go on from [L]. Default: all starts that are found.
    callback
        Called with a :class:`~compas_cgc.model.result.SolveState` after every step. To cancel,
        return True or raise ``StopIteration``.

    Returns
    -------
    Solution
        With the fair surface of least energy, and all others in its branches. ``step_length`` in its history is the part of the
        full step that was taken.

    Raises
    ------
    ProblemError
        If a vertex where K is prescribed has no target, or there are goals that moves along fixed directions cannot meet.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("canopy.3dm")).to_problem()
    >>> polish(plan).status
    'converged'
    """
    if problem.goals:
        refuse_impossible(problem)
        if not takes_goals(problem):
            raise ProblemError([WITH_LAWS if problem.laws else OTHER_GOALS])
    without = np.flatnonzero(problem.asked & ~np.isfinite(problem.targets))
    if len(without):
        raise ProblemError([f"vertex {int(without[0])} has no target; set the K̄ of its region"])
    settings = settings or PolishSettings()
    return fairest(problem, settings, None if start is None else [start], callback).told(settings)


class Found(NamedTuple):
    """A surface, and how evenly its curvature varies."""

    solution: Solution
    evenness: float  # against the square root of the area
    unknowns: list[FloatArray]  # (u,) moves and angles in the frame of each branch, else of the surface

    def told(self, settings: PolishSettings) -> Solution:
        """Return the surface; its message states the evenness where the settings do not."""
        said = [EVENLY.format(self.evenness)] if self.evenness and settings.evenness is None else []
        return self.solution._replace(message=joined([self.solution.message, *said]), evenness=self.evenness)


def fairest(problem: CGCProblem, settings: PolishSettings, begun: Optional[list[FloatArray]], callback: Callback) -> Found:
    """Return the first fair surface for ever more even curvature, the least first, else the least rough.

    Where the mesh is large this is settled on fewer and even triangles over the same drawing. Begun from surfaces of other targets,
    vertices (n, 3) or moves and angles (u,), it is the least.
    """
    hyperbolic = (problem.types[problem.asked] < 0).any() or any(law.type == "hyperbolic" for law in problem.laws.values())
    tried = EVEN if hyperbolic and not begun else EVEN[:1]
    if settings.evenness is not None:
        tried = (settings.evenness,)
    small = begun or len(problem.vertices) <= MEDIUM_MESH or (problem.roles == DUMMY).any()
    coarse = None if small else laid_out_anew(problem, EVEN_VERTICES)
    if coarse is not None:
        kept = keeps_shape(problem) if settings.keep == "auto" else settings.keep == "shape"
        settings = replace(settings, keep="shape" if kept else "plan")
        before = _evenly(coarse.problem, settings, tried, [], _carried(callback, coarse, not kept))
        surfaces = [branch.vertices for branch in before.solution.branches] or [before.solution.vertices]
        begun, tried = [coarse.carried(vertices, anew=not kept) for vertices in surfaces], (before.evenness,)
    return _evenly(problem, settings, tried, begun or [], callback)


def _evenly(problem: CGCProblem, settings: PolishSettings, tried: tuple[float, ...], begun: list[FloatArray], callback: Callback) -> Found:
    """Return the first fair surface for one length of even curvature after another, else the least rough."""
    found: list[Found] = []
    for evenness, lifted in [(own, False) for own in tried] + [(own, True) for own in tried[1:2]]:
        least = _least_energy(problem, replace(settings, evenness=evenness), begun, callback, lifted)
        if least is None:
            break
        found.append(Found(least[0], evenness, least[1]))
        if found[-1].solution.status == "cancelled" or found[-1].solution.is_fair:
            return found[-1]
        if is_spent():
            break
    judged = [own.solution.verdict for own in found]
    roughness = [math.inf if own is None else own.roughness for own in judged]
    return found[int(np.argmin(roughness))]


def _carried(callback: Callback, coarse: Coarse, anew: bool) -> Callback:
    """Return what shows the surfaces of a coarser mesh on the mesh itself."""
    if callback is None:
        return None
    return lambda state: callback(state._replace(vertices=coarse.carried(state.vertices, anew=anew)))


def _least_energy(
    problem: CGCProblem, settings: PolishSettings, surfaces: list[FloatArray], callback: Callback, lifted: bool
) -> Optional[tuple[Solution, list[FloatArray]]]:
    """Return the fair surface of least energy to which surfaces lead, or all starts that are found without any, and unknowns (u,).

    Starts are plates over the supports, or saddles over lifted supports; None where there are no such saddles.
    """
    lagrangian, local, frame, size = posed_as_set(problem, settings)
    moved = np.flatnonzero(problem.roles != DUMMY)[local.movable]
    kept = bool(np.isfinite(lagrangian.waves))

    def to_model(vertices: FloatArray) -> FloatArray:
        result = problem.vertices.copy()
        result[moved] = frame.to_model(vertices[local.movable])
        return result

    @functools.cache
    def judged(end: _End) -> Verdict:
        return verdict(problem.with_vertices(to_model(lagrangian.vertices(end.state.unknowns))), problem.vertices)

    recorder = Recorder(settings.steps, callback, frame, to_model)
    search = _Search(lagrangian, local, size, settings, recorder)
    begun: Iterable[Union[State, Lifted]] = starts(lagrangian) if not lifted else saddles(lagrangian) if not kept else ()
    if surfaces:
        real = problem.roles != DUMMY
        begun = [begun_from(lagrangian, frame, one[real] if one.ndim > 1 else one) for one in surfaces]
    ends: list[_End] = []
    starting: list[State] = []
    missed = math.inf  # by the saddle with which the search may end; another one that misses the supports by as much is its equal
    for start in begun:
        own = start.state if isinstance(start, Lifted) else start
        if isinstance(start, Lifted) and start.missed > (1.0 + DRAWING_ACCURACY) * missed:
            break
        twin = next((end for first, end in zip(starting, ends) if _mirrors(lagrangian, first, own)), None)
        if twin is not None:
            ends.append(_End(lagrangian.at(-twin.state.unknowns), twin.status))
        else:
            ends.append(search.lowered(start) if isinstance(start, Lifted) else search.ended(start))
        starting.append(own)
        # Without hyperbolic laws such as K̄ < 0 the first side is the one that the drawing or its normals say; sheets have several ways.
        enough = kept or lifted or bool(surfaces) or (bool((lagrangian.types >= 0.0).all()) and not lagrangian.is_parabolic)
        if ends[-1].status == "cancelled" or (ends[-1].status == "step_limit" and not lagrangian.is_parabolic) or (lifted and is_spent()):
            break
        if ends[-1].arrived and enough and judged(ends[-1]).fair:
            if not isinstance(start, Lifted):
                break
            missed = min(missed, start.missed)
    if not ends:
        return None
    found = _distinct([end for end in ends if end.arrived], lagrangian, size)
    found.sort(key=lambda end: not judged(end).fair)
    # Of mirror twins the one that rises along the normals comes first.
    twins = {id(end) for end in found if _alike(end, found[0]) and judged(end).fair == judged(found[0]).fair}
    moments = {id(end): lagrangian.moments(-end.state.unknowns, end.state.operators.areas) for end in found}
    found.sort(key=lambda end: (id(end) not in twins, moments[id(end)] if id(end) in twins else ()))
    best = found[0] if found else min(ends, key=lambda end: _error(lagrangian, end.state))
    _, _, H, K = lagrangian.curvatures(best.state.operators)
    law = pair_laws(problem.without_dummies(), lagrangian.mesh)[1]
    errors = law.largest(H / frame.scale, K / frame.scale**2)
    first = [next(k for k, other in enumerate(found) if _alike(end, other)) for end in found]
    branches = tuple(
        Branch(to_model(lagrangian.vertices(end.state.unknowns)), end.state.energy, judged(end).fair, twin if twin != k else None)
        for k, (end, twin) in enumerate(zip(found, first))
    )
    said = [_message(best.status, len(recorder), errors, branches)]
    if best.arrived and _is_turned_over(lagrangian, best.state, problem.goals):
        said.append(TURNED_OVER)
    solution = Solution(
        to_model(lagrangian.vertices(best.state.unknowns)),
        best.status,
        joined(said),
        len(recorder),
        recorder.seconds,
        max(error for _, error in errors),
        recorder.history,
        measure=MID_EDGE,
        verdict=judged(best) if found else None,
        branches=branches,
    )
    return solution, [end.state.unknowns for end in found or [best]]


def begun_from(lagrangian: Lagrangian, frame: Frame, surface: FloatArray) -> State:
    """Return the state of a surface of other targets, given by vertices (n, 3) [L] or by moves and angles (u,)."""
    return lagrangian.at(surface.copy()) if surface.ndim == 1 else from_surface(lagrangian, frame.to_local(surface))


def _is_turned_over(lagrangian: Lagrangian, state: State, goals: Sequence[Constraint]) -> bool:
    """Return whether limits alone, which say nothing of a side, made a dome hang below its supports, or a bowl rise above them."""
    if not any(isinstance(goal, Bound) for goal in goals) or any(isinstance(goal, (Whole, Height)) for goal in goals):
        return False
    return bool((lagrangian.types > 0.0).all()) and lagrangian.side * lagrangian.volume(state.unknowns, state.operators.areas) < 0.0


def plates(problem: CGCProblem) -> list[FloatArray]:
    """Return the initial surfaces (n, 3) of :func:`polish` over the plan of a drawing, the likeliest first."""
    lagrangian, local, frame, _ = posed_as_set(problem, PolishSettings(keep="plan"))
    moved = np.flatnonzero(problem.roles != DUMMY)[local.movable]
    found = []
    for state in starts(lagrangian):
        vertices = problem.vertices.copy()
        vertices[moved] = frame.to_model(lagrangian.vertices(state.unknowns)[local.movable])
        found.append(vertices)
    return found


class Posed(NamedTuple):
    """A problem in its local frame, without dummies, with its energy and equations."""

    lagrangian: Lagrangian
    problem: CGCProblem
    frame: Frame
    size: float  # square root of the area, in the frame


def posed_as_set(problem: CGCProblem, settings: PolishSettings) -> Posed:
    """Return energy and equations of a problem, with what settings keep of its drawing."""
    local, frame = problem.without_dummies().local()
    size = math.sqrt(float(face_areas(local.vertices, local.faces).sum()))
    lagrangian = posed(local, settings.fold_length)
    if lagrangian.is_minimal and not lagrangian.has_plan:
        # Of several minimal surfaces the one of least area is found, whatever is drawn.
        local = local.with_vertices(least_area(local.vertices, local.faces, local.movable))
        lagrangian = posed(local, settings.fold_length)
    if settings.keep == "shape" or (settings.keep == "auto" and is_kept(lagrangian)):
        lagrangian = lagrangian.keeping(WAVES * size)
    else:
        lagrangian = over_its_plate(lagrangian)
    if settings.evenness:
        lagrangian = lagrangian.evener(settings.evenness)
    return Posed(lagrangian, local, frame, size)


def keeps_shape(problem: CGCProblem) -> bool:
    """Return whether a drawing has a shape that is kept."""
    local = problem.without_dummies().local()[0]
    heights = local.vertices - local.vertices.mean(axis=0)
    if float(np.linalg.svd(heights, compute_uv=False)[2]) <= ROUNDING * EPS:
        return False
    return is_kept(posed(local, PolishSettings().fold_length))


@dataclass(frozen=True, eq=False)
class _End:
    """Where a search ended."""

    state: State
    status: str

    @property
    def arrived(self) -> bool:
        return self.status == "converged"


class _Search:
    """From an initial surface to one where energy is least."""

    def __init__(self, lagrangian: Lagrangian, problem: CGCProblem, size: float, settings: PolishSettings, recorder: Recorder):
        self.lagrangian, self.size, self.settings, self.recorder = lagrangian, size, settings, recorder
        self.faces, self.weights = problem.faces, np.nan_to_num(problem.face_targets())
        self.centre, self.places = problem.vertices.mean(axis=0), places(lagrangian)

    def ended(self, start: State) -> _End:
        """Return the surface that a start leads to, else the one with the least error of K."""
        own, best, taken = self.lagrangian, start, 0
        goal = self.settings.tolerance * own.scales * own.cells
        for step in until_spent(steps(own, start, self.places, self.size)):
            here, V = step.state, own.vertices(step.state.unknowns)
            error, taken = _error(own, here), taken + 1
            self.recorder.record(energy(V - self.centre, self.faces, self.weights), error, error, step.length, step.trials)
            best = min(best, here, key=lambda state: _error(own, state))
            status = "stalled"
            if step.settled and not here.met.is_met:
                break
            if step.settled and (np.abs(here.residuals) <= np.maximum(goal, _rounding(own, here))).all():
                best, status = here, "converged"
            elif taken == self.settings.steps:
                status = "step_limit"
            if self.recorder.cancelled(V) and status == "stalled":
                status = "cancelled"
            if status != "stalled":
                return _End(best, status)
        return _End(best, "stalled")

    def lowered(self, start: Lifted) -> _End:
        """Return the surface that a start leads to when its supports are lowered to their places."""
        end, left, step = self.ended(start.state), 1.0, FIRST
        while end.arrived and left > 0.0:
            step = min(step, left)
            there = self.ended(self._with_supports_at(left - step, end.state.unknowns - step * start.lift))
            if there.arrived:
                end, left, step = there, left - step, GROWTH * step
            elif there.status == "cancelled" or step <= SHORTEST:
                end = there
            else:
                step /= 2.0
        if end.arrived:
            return end
        return _End(self._with_supports_at(0.0, end.state.unknowns), "cancelled" if end.status == "cancelled" else "stalled")

    def _with_supports_at(self, lift: float, unknowns: FloatArray) -> State:
        """Return the state for unknowns (u,), with supports in their places where nothing is left of their lift."""
        if lift == 0.0:
            unknowns[self.lagrangian.held] = 0.0
        return self.lagrangian.at(unknowns)


def _distinct(ends: list[_End], lagrangian: Lagrangian, size: float) -> list[_End]:
    """Return different surfaces by increasing energy."""
    found: list[_End] = []
    for end in sorted(ends, key=lambda end: round(end.state.energy, ENERGY_DIGITS)):
        V = lagrangian.vertices(end.state.unknowns)
        if all(float(np.abs(V - lagrangian.vertices(other.state.unknowns)).max()) > DRAWING_ACCURACY * size for other in found):
            found.append(end)
    return found


def _mirrors(lagrangian: Lagrangian, first: State, second: State) -> bool:
    """Return whether two starts are mirror images at the drawing that lead to mirror images, as those of flat drawings do."""
    if lagrangian.conditions.count or np.abs(first.unknowns + second.unknowns).max() > NEGLIGIBLE * np.abs(first.unknowns).max():
        return False
    image = lagrangian.at(-first.unknowns)
    same = np.abs(image.residuals - first.residuals).max(initial=0.0) <= NEGLIGIBLE * np.abs(first.residuals).max(initial=0.0)
    return bool(same) and abs(image.energy - first.energy) <= NEGLIGIBLE * first.energy


def _alike(end: _End, other: _End) -> bool:
    return abs(end.state.energy - other.state.energy) <= TWIN_ENERGIES * other.state.energy


def _error(lagrangian: Lagrangian, state: State) -> float:
    """Return the largest |K - K̄|."""
    return float(np.abs(state.residuals / lagrangian.cells).max(initial=0.0))


def _rounding(lagrangian: Lagrangian, state: State) -> FloatArray:
    """Return what residuals (r,) are by the rounding of coordinates at unit size."""
    T, A, H, K = lagrangian.curvatures(state.operators)
    by_H, by_K = lagrangian.law.first_derivatives(H, K)
    return np.asarray(ROUNDING * EPS * (np.abs(by_H) + np.abs(by_K) * np.sqrt((T**2).sum(axis=1)) / A))


def places(lagrangian: Lagrangian) -> FloatArray:
    """Return the places (q + r + k, 3) of unknowns and equations on the drawing."""
    V, mesh = lagrangian.drawing, lagrangian.mesh
    unknowns = np.vstack([V, V[mesh.angles.ends].mean(axis=1)])
    return np.vstack([unknowns[lagrangian.free], V[mesh.pairs[lagrangian.rows, 0]], V[lagrangian.conditions.vertices[:, 0]]])


def _message(status: str, steps: int, errors: list[tuple[Law, float]], branches: tuple[Branch, ...]) -> str:
    reached = f"largest {', '.join(f'{law.words} {error:.3g}' for law, error in errors)} in the mid-edge measure"
    if status == "converged":
        twins = sum(branch.twin_of == 0 for branch in branches)
        others = len(branches) - 1 - twins
        kinds = [f"{twins} mirror image{'s' * (twins > 1)} of it"] * bool(twins) + [f"{others} with more energy"] * bool(others)
        also = f"; result.branches has {' and '.join(kinds)}" if kinds else ""
        return f"converged in {steps} steps: {reached}{also}"
    if status == "cancelled":
        return f"cancelled after {steps} steps: {reached}"
    if status == "step_limit":
        return allow_more_steps(f"not converged in {steps} steps: {reached}", steps)
    text = "no surface with this curvature was found over these supports; choose a smaller curvature, or free an edge"
    return Sentence(f"stalled: {text}; {reached}", [HALVED])
