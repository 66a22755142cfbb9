"""Warm starts that change nothing: surfaces between two that were solved on their own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from typing import Optional
from typing import Union

import numpy as np

from ..datastructures import SolveResult
from ..model.checks import check
from ..model.checks import refuse
from ..model.problem import CGCProblem
from ..model.verdict import verdict
from .projection.branch import Branch
from .projection.branch import branch_through
from .registry import METHODS
from .registry import settings_of
from .run import chosen_settings
from .settings import Settings

__all__ = ["Between", "between", "leads_on"]

SAME = 1e-9  # distance of two surfaces, against their size, that are one


class Between:
    """The surfaces of problems between two, on the branch that both lie on.

    Parameters
    ----------
    branch
        Through the surface of the first.
    ends
        ``(2, n)`` targets of both [1/L^2].
    settings
        That both were solved with.
    """

    def __init__(self, branch: Branch, ends: np.ndarray, settings: Optional[Settings]):
        self._branch, self._settings = branch, settings
        self._least, self._most = np.fmin(*ends), np.fmax(*ends)

    def solve(self, problem: CGCProblem) -> Optional[SolveResult]:
        """Return the result of a problem that differs from both by targets between theirs; None where it has to be solved on its own.

        Raises
        ------
        ProblemError
            With the fatal sentences of :func:`compas_cgc.check`.
        """
        asked, targets = problem.asked, problem.targets
        if not ((targets >= self._least) & (targets <= self._most))[asked].all():
            return None
        remarks = check(problem)
        refuse(remarks)
        found = self._branch.to(targets)
        if found is None:
            return None
        judged = verdict(problem.with_vertices(found.vertices), problem.vertices)
        if not judged.fair:
            return None
        return SolveResult.from_solution(problem, found._replace(method="projection", verdict=judged), self._settings, None, remarks)


def leads_on(result: SolveResult, method: str = "auto", settings: Union[Settings, Mapping[str, Any], None] = None) -> Optional[Branch]:
    """Return the branch that the surface of a result lies on, None where others are not found from it.

    Parameters
    ----------
    result
        Of :func:`compas_cgc.solve`.
    method, settings
        With which it was solved.
    """
    if method not in ("auto", "projection") or result.method != "projection" or not _is_fair(result) or result.start is None:
        return None
    own = settings_of(METHODS["projection"], chosen_settings(method, settings))
    branch = branch_through(result.problem.with_vertices(result.start), result.vertices, own)  # type: ignore[arg-type]
    return branch if branch is not None and _reaches(branch, result) else None


def between(branch: Branch, first: SolveResult, last: SolveResult, settings: Optional[Settings]) -> Optional[Between]:
    """Return what solves the problems between two of the same drawing, None where their surfaces do not lie on one branch.

    From the surface of the first the targets are changed to those of the last. Where that comes to the last one's surface, which was
    found on its own, the surfaces between are taken for those that are found on their own, too.

    Parameters
    ----------
    branch
        That the surface of the first lies on.
    first, last
        Results of the same method and settings.
    settings
        These.
    """
    if last.method != "projection" or not _is_fair(last) or not _reaches(branch, last):
        return None
    return Between(branch, np.array([own.problem.targets for own in (first, last)]), settings)


def _is_fair(result: SolveResult) -> bool:
    return result.converged and result.verdict.fair


def _reaches(branch: Branch, result: SolveResult) -> bool:
    """Return whether a branch comes to the surface of a result."""
    found = branch.to(result.problem.targets)
    size = float(np.ptp(result.vertices, axis=0).max())
    return found is not None and bool(np.abs(found.vertices - result.vertices).max() <= SAME * size)
