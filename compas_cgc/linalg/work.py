"""Budgets of work: counted instead of timed, so that a search stops at the same step on every machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

__all__ = ["Work", "count", "is_spent", "rights", "spend", "until_spent"]

T = TypeVar("T")

CALL_OVERHEAD = 500  # overhead of one solve, in unknowns


class Work:
    """A budget of work for a search, in unknowns times right-hand sides, see :func:`rights`.

    Examples
    --------
    >>> work = Work(10.0)
    >>> with work.counted():
    ...     steps = list(until_spent(iter([spend(4.0), spend(4.0)])))
    >>> work.left, work.spent
    (2.0, False)
    """

    def __init__(self, left: float):
        self.left = left

    @property
    def spent(self) -> bool:
        """Whether the budget is used up."""
        return self.left < 0.0

    @contextmanager
    def counted(self) -> Iterator[None]:
        """Take the work within this context off this budget, and off those of the contexts around it."""
        token = _COUNTED.set((*_COUNTED.get(), self))
        try:
            yield
        finally:
            _COUNTED.reset(token)


class _Spent(Exception):
    """The work is used up."""


_COUNTED: ContextVar[tuple[Work, ...]] = ContextVar("work", default=())


def rights(number: float, unknowns: float) -> float:
    """Return the work of solving for a number of right-hand sides, with the overhead of each call.

    Examples
    --------
    >>> rights(2.0, 1500), rights(2.0, 0)
    (4000.0, 1000.0)
    """
    return number * (unknowns + CALL_OVERHEAD)


def count(amount: float) -> None:
    """Take an amount off all open budgets without stopping the search."""
    for work in _COUNTED.get():
        work.left -= amount


def spend(amount: float) -> None:
    """Take an amount off all open budgets; stop the search when the first budget is used up."""
    enough = not is_spent()
    count(amount)
    if enough and is_spent():
        raise _Spent


def is_spent() -> bool:
    """Check whether an open budget is used up."""
    return any(work.spent for work in _COUNTED.get())


def until_spent(steps: Iterator[T]) -> Iterator[T]:
    """Yield steps until an open budget is used up, possibly by a nested search."""
    if is_spent():
        return
    try:
        for step in steps:
            yield step
            if is_spent():
                return
    except _Spent:
        return
