"""Method: a way to solve, as a value that every door reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple

from .settings import Settings

if TYPE_CHECKING:
    from ..model.problem import CGCProblem
    from ..model.recorder import Callback
    from ..model.result import Solution

__all__ = ["Method"]


class Method(NamedTuple):
    """A way to solve."""

    name: str
    text: str  # what it does and what for, in a sentence
    settings: type[Settings]
    solve: Callable[[CGCProblem, Any, Callback], Solution]  # its vertices are those of the problem, in its order
    holds_constraints: bool = False  # it holds what is asked besides K
    any_sign: bool = False  # it reaches negative K̄
