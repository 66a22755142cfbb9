"""Method: a way to solve, as a value that every door reads."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple

from .settings import Settings

if TYPE_CHECKING:
    from ..model.constraints import Constraint
    from ..model.problem import CGCProblem
    from ..model.recorder import Callback
    from ..model.result import Solution

__all__ = ["Method"]


class Method(NamedTuple):
    """A way to solve.

    Parameters
    ----------
    name
        By which doors ask for it.
    text
        What it does and what for, in a sentence.
    settings
        Its class of settings.
    solve
        Its vertices are those of the problem, in its order.
    goals
        Those that it takes: ``none``, those of the ``whole`` surface, those for heights and ``places`` too, or ``any``.
    any_sign
        It reaches negative K̄.
    any_law
        It takes laws other than constant K.
    has_dummies
        It uses the drawn faces outside the surface, which the others are solved without.

    Examples
    --------
    >>> from compas_cgc.solvers import METHODS
    >>> METHODS["newton"].any_sign
    False
    """

    name: str
    text: str  # what it does and what for, in a sentence
    settings: type[Settings]
    solve: Callable[[CGCProblem, Any, Callback], Solution]  # its vertices are those of the problem, in its order
    goals: str = "none"  # those that it takes: none, those of the whole surface, those for heights and places too, or any
    any_sign: bool = False  # it reaches negative K̄
    any_law: bool = False  # it takes laws other than constant K
    has_dummies: bool = False  # it uses the drawn faces outside the surface

    def takes(self, goals: Iterable[Constraint]) -> bool:
        """Return whether it takes goals of these kinds."""
        # Loaded when it is used, so that help texts do not wait for compiled kernels.
        from ..model.constraints import Fixed
        from ..model.constraints import PositionConstraint
        from ..model.goals.inequalities import Bound
        from ..model.goals.wholes import is_of_whole

        if self.goals == "any":
            return True
        places = (PositionConstraint, Fixed, Bound) if self.goals == "places" else ()
        return all(self.goals != "none" and (is_of_whole(goal) or isinstance(goal, places)) for goal in goals)
