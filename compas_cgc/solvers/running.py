"""One method on one problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any
from typing import Optional

from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.recorder import show_arrived
from ..model.result import Solution
from ..model.verdict import verdict
from .method import Method
from .registry import method_of
from .registry import settings_of
from .settings import Settings

__all__ = ["judged", "run_method"]


def run_method(
    method: Method,
    problem: CGCProblem,
    *,
    settings: Optional[Settings] = None,
    options: Mapping[str, Any] = MappingProxyType({}),
    callback: Callback = None,
) -> Solution:
    """Solve a problem by one method, see :class:`Method`, with some options other than the defaults where the settings leave them open."""
    return method.solve(problem, _own_settings(method, settings, options), callback)._replace(method=method.name)


def _own_settings(method: Method, settings: Optional[Settings], options: Mapping[str, Any]) -> Any:
    """Return the settings of a method, with some options other than the defaults where the settings leave them open."""
    own = settings_of(method, settings)
    given = settings.to_dict() if settings is not None and method_of(settings) == "auto" else {}
    options = {name: value for name, value in options.items() if given.get(name) in (None, "auto")}
    return replace(own, **options) if options else own


def judged(solution: Solution, problem: CGCProblem, callback: Callback) -> Solution:
    """Return a solution of a problem with a verdict where it has arrived."""
    if solution.status != "converged":
        return solution._replace(verdict=None)
    asked = solution.with_found(problem)
    show_arrived(callback, solution.vertices)
    return solution._replace(verdict=solution.verdict or verdict(asked.with_vertices(solution.vertices), problem.vertices))
