"""Fingerprint of inputs: a text that is equal for equal values, also of different objects."""

from __future__ import annotations

import hashlib
from typing import Any

from ...model.constraint_data import constraint_data
from ...model.constraints import Constraint
from ...model.problem import PosesProblem

__all__ = ["fingerprint", "problem_fingerprint"]


def fingerprint(*values: Any) -> str:
    """Return the fingerprint of values on wires: problems, constraints, Rhino geometry, settings, numbers, texts, and lists of them."""
    return repr([_of(value) for value in values])


def problem_fingerprint(given: PosesProblem) -> str:
    """Return the fingerprint of a problem."""
    problem = given.to_problem()
    columns = [problem.vertices, problem.faces, problem.roles, problem.targets, problem.s, problem.e, problem.creases]
    if problem.origin is not None:
        columns += [problem.origin.vertices, problem.origin.drawn.vertices, problem.origin.drawn.targets]
    goals = repr([*(constraint_data(goal) for goal in problem.goals), dict(problem.laws)])
    parts = [goals.encode("utf-8"), *(part for own in columns for part in (repr(own.shape).encode("utf-8"), own.tobytes()))]
    # One call, as every call on large data gives the lock of the interpreter to other threads.
    return hashlib.blake2b(b"".join(parts), digest_size=20).hexdigest()


def _of(value: Any) -> Any:
    if hasattr(value, "to_problem"):
        return problem_fingerprint(value)
    if isinstance(value, Constraint):
        return constraint_data(value)
    if isinstance(value, (list, tuple)) and not hasattr(value, "_fields"):
        return [_of(one) for one in value]
    content = getattr(value, "DataCRC", None)
    if content is not None:
        return type(value).__name__, content(0)
    axes = [axis for axis in ("Origin", "XAxis", "YAxis", "ZAxis", "X", "Y", "Z") if hasattr(value, axis)]
    return (type(value).__name__, [_of(getattr(value, axis)) for axis in axes]) if axes else value
