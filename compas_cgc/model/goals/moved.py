"""Goals after a motion of the surface."""

from __future__ import annotations

from collections.abc import Sequence

from ..constraint_data import constraint_data
from ..constraint_data import constraint_of
from ..constraints import Constraint
from ..motion import Motion
from .names import goal_name

__all__ = ["moved_goals"]


def moved_goals(goals: Sequence[Constraint], motion: Motion) -> tuple[Constraint, ...]:
    """Return goals after a motion, as plain numbers and lists.

    Raises
    ------
    ValueError
        If a goal refers to the vertical and cannot follow the motion.
    """
    fixed = next((goal for goal in goals if not goal.admits(motion.up)), None)
    if fixed is not None:
        turn = "turns upside down" if motion.up else "tilts"
        raise ValueError(
            f"{goal_name(fixed)} refers to the vertical, which this transformation {turn}; "
            "remove the goal, or rotate about a vertical axis only"
        )
    return tuple(constraint_of(constraint_data(goal.transformed(motion))) for goal in goals)
