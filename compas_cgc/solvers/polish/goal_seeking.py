"""Unknown K or constants of laws of regions: Newton's method along the branch of least bending until the goals are met."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete import face_areas
from ...discrete import face_normals
from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...errors import Sentence
from ...errors import joined
from ...errors import use_method
from ...linalg.work import is_spent
from ...linalg.work import until_spent
from ...model.checks import GENTLE_TOTAL_CURVATURE
from ...model.goals.binding import Equation
from ...model.goals.binding import equations_for_constants
from ...model.goals.binding import finds_constants
from ...model.goals.binding import has_constants
from ...model.goals.binding import unknown_constants
from ...model.goals.binding import unknown_regions
from ...model.goals.binding import without_constants
from ...model.goals.contradictions import refuse_impossible
from ...model.goals.guess import allowed
from ...model.goals.guess import drawn_constant
from ...model.goals.guess import factors
from ...model.goals.guess import guessed
from ...model.goals.names import listed
from ...model.goals.wholes import Rise
from ...model.laws import ConstantCurvature
from ...model.laws import Law
from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.result import Solution
from ...model.tolerances import DRAWING_ACCURACY
from ...model.tolerances import ROUNDING
from ..constants import DECREASE
from ..constants import LARGEST_FACTOR
from ..constants import MAX_STEPS
from ..constants import SHORTEST
from .derivatives import Rate
from .derivatives import rates_by_constants
from .polisher import Found
from .polisher import fairest
from .posed import takes_goals
from .settings import PolishSettings

__all__ = ["seek"]

FIRST = 8  # halvings of drawn constants until a first surface is found; the last one is 256 times smaller, nearly a plate
MOST_CURVED = 2.0 * math.pi  # largest total curvature of a guess [rad]; that of a half sphere, beyond which a cap has no plan
# distance to a surface over that to the one after twice the step, above which it is on another branch; on a branch it follows the step
JUMP = 0.9
MOST_STARTS = 2  # constants with fair surfaces, first those drawn, from which goals are sought; each takes seconds where there is no way
ENDED = ("infeasible", "step_limit")  # statuses after which other ways to the goals are tried
NEAR_ENOUGH = 0.1  # part of the distance from a goal from which Newton's method goes on; then its steps stay between the two surfaces


class _Here(NamedTuple):
    """A surface for some constants, and by how much it misses the goals."""

    logs: FloatArray  # (k,) log of the constant over that drawn
    found: Found
    missing: FloatArray  # (e,) values less those wanted, over the power of the size

    @property
    def solution(self) -> Solution:
        return self.found.solution

    @property
    def unknowns(self) -> FloatArray:
        return self.found.unknowns[0]

    @property
    def distance(self) -> float:
        return float(np.linalg.norm(self.missing))


def seek(problem: CGCProblem, settings: PolishSettings, callback: Callback = None) -> Solution:
    """Return the surface of least bending whose unknown constants, K or those of laws such as H of H = 0.1, meet the goals.

    The sign of a constant is that drawn. With fewer goals than unknown constants these change as little as possible, by factors. Every
    step solves for the change of their logarithms with the exact derivatives of the surface, and follows the branch from there.

    Parameters
    ----------
    problem
        With heights of vertices or goals of the whole surface, and regions of unknown constants, drawn as the initial guess. Other
        goals hold on every surface.
    settings
        As for :func:`polish`.
    callback
        Called after every step of every surface.

    Raises
    ------
    ProblemError
        If there are more of these goals than unknown constants, or others that moves along fixed directions cannot meet.
    """
    refuse_impossible(problem)
    if not finds_constants(problem) or not takes_goals(without_constants(problem)):
        kinds = "at most one height or goal of the whole surface for each region of unknown K, and needs a drawn K as initial guess"
        raise ProblemError(
            [Sentence(f"the method bending accepts {kinds}; use the method projection, or auto", [use_method("projection")])]
        )
    return _Seeker(problem, settings, callback).run()


class _Seeker:
    """Surfaces for ever other constants."""

    def __init__(self, problem: CGCProblem, settings: PolishSettings, callback: Callback):
        self.settings, self.callback = settings, callback
        self.equations: list[Equation] = equations_for_constants(problem)
        self.size = math.sqrt(float(face_areas(problem.vertices, problem.faces).sum()))
        drawn = allowed(problem) if has_constants(problem) else guessed(problem)
        self.unknown = unknown_constants(problem)
        with np.errstate(divide="ignore"):
            self.bounds = np.log(np.array([factors(drawn, constant) for constant in self.unknown])).T
        self.problem, self.below = without_constants(drawn), _is_against_normals(problem)
        self.numbers = unknown_regions(problem)
        self.steps, self.seconds = 0, 0.0
        self.nearest: Optional[_Here] = None  # the fair surface that misses the goals least

    def run(self) -> Solution:
        found: Optional[Solution] = None
        for branches in islice(self._starts(), MOST_STARTS):
            here = branches[0]
            if here.solution.status != "converged":
                stopped = self._ended(here, here.solution.status, here.solution.message)
                return stopped if found is None or stopped.status == "cancelled" else found
            last = [self._given_up(here), *until_spent(self._approached(here))][-1]
            if last.status in ENDED and len(self.unknown) == 1:
                last = [last, *until_spent(self._crossed(branches))][-1]
            if last.status not in ENDED:
                return last
            found = found or last
            if is_spent():
                break
        assert found is not None, "there is at least one start"
        if found.status == "infeasible" and self.nearest is not None:
            return self._ended(self.nearest, "infeasible", self._unreachable(self.nearest))
        return found

    def _crossed(self, firsts: list[_Here]) -> Iterator[Solution]:
        """Yield the first surface that meets a goal between two on the branches of given ones.

        A rise may grow with a constant and then fall again, so that the nearest way to it ends beside one that is not reached.
        """
        for first in firsts:
            for way in (-1.0, 1.0):
                before = first
                for there in self._along(first, way):
                    if there.solution.status == "cancelled":
                        yield self._ended(there, "cancelled", there.solution.message)
                        return
                    if before.missing[0] * there.missing[0] <= 0.0:
                        for found in self._between(before, there):
                            if found.status in ("converged", "cancelled"):
                                yield found
                                return
                    before = there

    def _between(self, one: _Here, other: _Here) -> Iterator[Solution]:
        """Yield surfaces that come ever nearer to a goal between two, whose interval is halved until Newton's method is near enough."""
        near = NEAR_ENOUGH * max(one.distance, other.distance)
        while np.abs(one.logs - other.logs).max() > SHORTEST:
            nearer = min(one, other, key=lambda here: here.distance)
            if nearer.distance <= near:
                yield from self._approached(nearer)
                return
            middle = self._at(0.5 * (one.logs + other.logs), nearer.unknowns, nearer.found.evenness)
            if middle.solution.status == "cancelled":
                yield self._ended(middle, "cancelled", middle.solution.message)
            if not middle.solution.is_fair:
                return
            one, other = (middle, other) if middle.missing[0] * one.missing[0] > 0.0 else (one, middle)

    def _along(self, here: _Here, way: float) -> Iterator[_Here]:
        """Yield the fair surfaces on the branch of one, for ever smaller or larger constants, or one that was cancelled."""
        least, largest = np.maximum(self.bounds[0], here.logs - FIRST * LARGEST_FACTOR), self.bounds[1]
        while here.solution.is_fair:
            logs = np.clip(here.logs + way * LARGEST_FACTOR, least, largest)
            if (logs == here.logs).all():
                return
            here = self._at(logs, here.unknowns, here.found.evenness)
            if here.solution.is_fair or here.solution.status == "cancelled":
                yield here

    def _approached(self, here: _Here) -> Iterator[Solution]:
        """Yield surfaces that come ever nearer to the goals."""
        for _ in range(MAX_STEPS):
            if np.abs(here.missing).max() <= DRAWING_ACCURACY:
                here = self._landed(here)
                said = here.found.told(self.settings).message
                yield self._ended(here, "converged", joined([f"{self._found(here)}, to meet {self._names()}", said]))
                return
            after = self._stepped(here)
            if after is None and is_spent():
                return
            if after is None:
                yield self._ended(here, "infeasible", self._unreachable(here))
                return
            if after.solution.status == "cancelled":
                yield self._ended(after, "cancelled", after.solution.message)
                return
            here = after
            yield self._given_up(here)
        yield self._ended(here, "step_limit", f"the unknown constants were not found in {MAX_STEPS} steps: {self._reached(here)}")

    def _given_up(self, here: _Here) -> Solution:
        return self._ended(here, "stalled", f"the search for the unknown constants was given up: {self._reached(here)}")

    def _at(self, logs: FloatArray, start: Optional[FloatArray], evenness: Optional[float]) -> _Here:
        """Return the surface for logarithms of the constants (k,), from the moves and angles of another (u,) if there is one."""
        settings = replace(self.settings, evenness=evenness)
        found = fairest(self._rising(logs), settings, None if start is None else [start], self.callback)
        self.steps, self.seconds = self.steps + found.solution.iterations, self.seconds + found.solution.seconds
        here = _Here(logs, found, self._missing(found.solution.vertices))
        if here.solution.is_fair and (self.nearest is None or here.distance < self.nearest.distance):
            self.nearest = here
        return here

    def _branches(self, here: _Here) -> list[_Here]:
        """Return the branches that were found with a surface, the nearest to the goals first: these say which one is sought."""
        fair = [own for own, branch in zip(here.found.unknowns, here.solution.branches) if branch.fair]
        others = [self._at(here.logs, own, here.found.evenness) for own in fair[1:]]
        return sorted([here, *(other for other in others if other.solution.is_fair)], key=lambda branch: branch.distance)

    def _starts(self) -> Iterator[list[_Here]]:
        """Yield the fair surfaces for the constants drawn, then for ever smaller ones; the first that arrives if none is fair."""
        total = float(np.abs(np.nan_to_num(self.problem.face_targets())) @ face_areas(self.problem.vertices, self.problem.faces))
        # A guess in other units may be wrong by powers of ten; it then says nothing but the sign.
        factor = GENTLE_TOTAL_CURVATURE / total if total > MOST_CURVED else 1.0
        tried: list[_Here] = []
        for halvings in range(FIRST):
            logs = np.maximum(np.full(len(self.unknown), math.log(factor) - halvings * LARGEST_FACTOR), self.bounds[0])
            if tried and (logs == tried[-1].logs).all():
                break
            tried.append(self._at(logs, None, self.settings.evenness))
            if tried[-1].solution.status == "cancelled":
                yield tried[-1:]
                return
            if tried[-1].solution.is_fair:
                yield self._branches(tried[-1])
        if not any(here.solution.is_fair for here in tried):
            yield [next((here for here in tried if here.solution.status == "converged"), tried[-1])]

    def _change(self, here: _Here) -> tuple[FloatArray, list[Rate]]:
        """Return the changes of the logarithms (k,) by Newton's method, zero where goals do not depend on them, and the rates of each."""
        posed, V = self._rising(here.logs), here.solution.vertices
        constants = {number: constant for number, (_, constant) in zip(self.numbers, self._constants(posed))}
        rates = rates_by_constants(posed, replace(self.settings, evenness=here.found.evenness), here.unknowns, self.numbers)
        by_log = []
        for own in self.unknown:
            parts = [rates[number].times(constants[number]) for number in own.regions]
            by_log.append(Rate(np.sum([part.moves for part in parts], axis=0), np.sum([part.unknowns for part in parts], axis=0)))
        J = np.array([[float((own.gradient(V) * rate.moves).sum()) / self.size**own.power for rate in by_log] for own in self.equations])
        change = np.zeros(len(by_log))
        if np.abs(J).max() > ROUNDING:
            inside, (least, largest) = np.ones(len(change), bool), self.bounds - here.logs
            while inside.any():
                # Constants that would pass a bound stop there, and the others make up for it.
                change[inside] = -np.linalg.pinv(J[:, inside]) @ (here.missing + J[:, ~inside] @ change[~inside])
                beyond = inside & ((change < least) | (change > largest))
                if not beyond.any():
                    break
                change[beyond] = np.clip(change, least, largest)[beyond]
                inside &= ~beyond
        return change, by_log

    def _landed(self, here: _Here) -> _Here:
        """Return the surface that meets the goals to rounding; it is nearer than what is left of waves where energy hardly changes."""
        change, by_log = self._change(here)
        vertices = here.solution.vertices + sum(part * rate.moves for part, rate in zip(change, by_log))
        branches = tuple(one._replace(vertices=vertices) for one in here.solution.branches)  # the one that was followed
        solution = here.solution._replace(vertices=vertices, branches=branches)
        return here._replace(logs=here.logs + change, found=here.found._replace(solution=solution), missing=self._missing(vertices))

    def _stepped(self, here: _Here) -> Optional[_Here]:
        """Return the surface after the first of ever shorter steps that comes nearer to the goals; None without any."""
        change, by_log = self._change(here)
        responds = change.any()
        if not responds:
            # A rise does not depend on K where a support is the crown, until a larger one makes the surface rise above it.
            change = np.clip(self.bounds[1] - here.logs, 0.0, LARGEST_FACTOR)
        if not change.any():
            return None
        change *= min(1.0, LARGEST_FACTOR / float(np.abs(change).max()))
        before = math.inf
        while np.abs(change).max() >= SHORTEST * min(1.0, here.distance):
            start = here.unknowns + sum(part * rate.unknowns for part, rate in zip(change, by_log))
            there = self._at(here.logs + change, start, here.found.evenness)
            if there.solution.status == "cancelled":
                return there
            # Beyond a fair surface another may be as high, with folds.
            sound = there.solution.status == "converged" and (there.solution.is_fair or not here.solution.is_fair)
            nearer = there.distance <= (1.0 - DECREASE) * here.distance
            if sound and (nearer or not (responds or np.isfinite(before))):
                return there
            moved = float(np.abs(there.solution.vertices - here.solution.vertices).max())
            if sound and moved > JUMP * before and there.solution.branches[0].energy < here.solution.branches[0].energy:
                return there  # on another branch, with less energy however short the step is
            before, change = moved, 0.5 * change
        return None

    def _posed(self, logs: FloatArray) -> CGCProblem:
        factor, laws = np.ones(len(self.problem.targets)), dict(self.problem.laws)
        for log, constant in zip(logs.tolist(), self.unknown):
            for number in constant.regions:
                if number in laws:
                    laws[number] = laws[number].with_constant(_constant(laws[number]) * math.exp(log))
                else:
                    factor[self.problem.region_vertices(number)] = math.exp(log)
        return replace(self.problem, targets=factor * self.problem.targets, laws=laws)

    def _rising(self, logs: FloatArray) -> CGCProblem:
        """Return the problem with normals on the side to which the surface is to rise."""
        posed = self._posed(logs)
        return posed.with_opposite_normals() if self.below else posed

    def _constants(self, posed: CGCProblem) -> list[tuple[str, float]]:
        """Return the names and values of the unknown constants."""
        found = []
        for number in self.numbers:
            law = posed.laws.get(number) or ConstantCurvature(drawn_constant(posed, number))
            found.append((law.constant_name, _constant(law)))
        return found

    def _missing(self, vertices: FloatArray) -> FloatArray:
        return np.array([(own.value(vertices) - own.wanted) / self.size**own.power for own in self.equations])

    def _ended(self, here: _Here, status: str, message: str) -> Solution:
        posed = self._posed(here.logs)
        judged = here.solution.verdict if status == "converged" else None
        return here.solution._replace(
            status=status,
            message=message,
            iterations=self.steps,
            seconds=self.seconds,
            targets=posed.targets,
            laws=posed.laws,
            verdict=judged,
            evenness=here.found.evenness,
        )

    def _names(self) -> str:
        return " and ".join(own.name for own in self.equations)

    def _found(self, here: _Here) -> str:
        found = self._constants(self._posed(here.logs))
        if len(found) == 1:
            name, value = found[0]
            return f"{name} = {value:.6g} was found for region {self.numbers[0]}"
        if len({name for name, _ in found}) > 1:
            each = [f"{name} = {value:.4g} for region {number}" for number, (name, value) in zip(self.numbers, found)]
            return f"{listed(each)} were found"
        values = [value for _, value in found]
        return f"{found[0][0]} from {min(values):.4g} to {max(values):.4g} was found for {len(found)} regions"

    def _reached(self, here: _Here) -> str:
        values = ", ".join(f"{own.value(here.solution.vertices):.6g} instead of {own.wanted:.6g}" for own in self.equations)
        constants = ", ".join(f"{name} = {value:.4g}" for name, value in self._constants(self._posed(here.logs)))
        return f"for {self._names()} the surface reaches {values}, with {constants}"

    def _unreachable(self, here: _Here) -> str:
        name, value = self._constants(self.problem)[0]
        sign = f"{name} {'>' if value > 0.0 else '<'} 0"
        stopped = here.logs[:, None] == self.bounds.T
        other = "or widen its bounds" if stopped.any() else f"or draw {name} with the other sign"
        mend = f"prescribe a value that is reached, {other}"
        return f"no surface over these supports with {sign} was found that meets the goals: {self._reached(here)}; {mend}"


def _constant(law: Law) -> float:
    assert law.constant is not None, "laws without a constant have been refused"
    return law.constant


def _is_against_normals(problem: CGCProblem) -> bool:
    """Return whether a rise lies on the other side of the drawing than its normals."""
    rises = [own.rise for own in problem.goals if isinstance(own, Rise)]
    normal = float(face_areas(problem.vertices, problem.faces) @ face_normals(problem.vertices, problem.faces)[:, 2])
    return any(rise * normal < 0.0 for rise in rises)
