"""Work counted, not timed, so that a search given up for it ends at the same place on every machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

__all__ = ["Work", "count", "is_spent", "rights", "spend", "until_spent"]

T = TypeVar("T")

CALL = 500  # unknowns that the least solve takes as long as, whatever its size


class Work:
    """So much work as a search may take, in unknowns times right sides solved for, see :func:`rights`.

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
        """Whether nothing is left."""
        return self.left < 0.0

    @contextmanager
    def counted(self) -> Iterator[None]:
        """Count the work within this context, besides that of the contexts around it."""
        token = _COUNTED.set((*_COUNTED.get(), self))
        try:
            yield
        finally:
            _COUNTED.reset(token)


class _Spent(Exception):
    """The work is used up."""


_COUNTED: ContextVar[tuple[Work, ...]] = ContextVar("work", default=())


def rights(number: float, unknowns: float) -> float:
    """Return the work of solving for so many right sides; small systems take what every call does.

    Examples
    --------
    >>> rights(2.0, 1500), rights(2.0, 0)
    (4000.0, 1000.0)
    """
    return number * (unknowns + CALL)


def count(amount: float) -> None:
    """Take an amount off what is left, wherever it is counted, for what is finished in any case."""
    for work in _COUNTED.get():
        work.left -= amount


def spend(amount: float) -> None:
    """Take an amount off what is left, wherever it is counted; the first that is too much ends the steps that it is for."""
    enough = not is_spent()
    count(amount)
    if enough and is_spent():
        raise _Spent


def is_spent() -> bool:
    """Return whether work that is counted is used up."""
    return any(work.spent for work in _COUNTED.get())


def until_spent(steps: Iterator[T]) -> Iterator[T]:
    """Pass on steps until the work that is counted is used up, be it by another search that they wait for."""
    if is_spent():
        return
    try:
        for step in steps:
            yield step
            if is_spent():
                return
    except _Spent:
        return
