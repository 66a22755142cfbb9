"""Recorder: history and callback of a solve, in model units."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from typing import Optional

from .._compiled import compile_seconds
from ..discrete.arrays import FloatArray
from .frame import Frame
from .result import History
from .result import SolveState

__all__ = ["Callback", "Recorder", "refuse_no_callback", "show_arrived"]

Callback = Optional[Callable[[SolveState], object]]


def refuse_no_callback(callback: object) -> None:
    """Refuse a callback that cannot be called with a state.

    Raises
    ------
    ValueError
        If it is neither None nor a function of one argument.
    """
    if callback is None:
        return
    if not callable(callback):
        raise ValueError(f"callback must be a function that is called after every step, such as print, not {callback!r:.60}")
    try:
        inspect.signature(callback).bind(None)
    except TypeError:
        raise ValueError("callback must be a function of one argument, the state after a step: lambda state: ...") from None
    except ValueError:  # Some functions in C have no signature.
        return


def show_arrived(callback: Callback, vertices: FloatArray) -> None:
    """Pass the vertices (n, 3) of a converged surface, before its verdict, to the method ``arrived`` of a callback if it has one."""
    arrived = getattr(callback, "arrived", None)
    if arrived is not None:
        arrived(vertices)


class Recorder:
    """Records every step of a solve in a local frame.

    Parameters
    ----------
    steps
        Largest number of steps.
    callback
        Called after every step; it cancels by returning True or raising ``StopIteration``.
    frame
        The local frame of the solve.
    to_model
        Converts local vertices (n, 3) to model vertices [L].
    length_power
        Dimension of the step length: n of L^n.
    """

    def __init__(
        self, steps: int, callback: Callback, frame: Frame, to_model: Callable[[FloatArray], FloatArray], length_power: int = 0
    ) -> None:
        self.started = _solving_time()
        self._steps, self._callback, self._to_model = steps, callback, to_model
        scale = frame.scale
        self._units = (scale, scale**-2, scale**-2, scale**length_power)
        self._rows: list[tuple] = []

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def seconds(self) -> float:
        """Wall time since the start, without the compilation of kernels [s]."""
        return _solving_time() - self.started

    @property
    def history(self) -> History:
        """One entry per step taken."""
        return History.from_rows(self._rows)

    def record(self, energy: float, error_norm: float, max_error: float, step_length: float, trials: int, accepted: bool = True) -> None:
        """Record a step; the values are in the local frame."""
        figures = (value * unit for value, unit in zip((energy, error_norm, max_error, step_length), self._units))
        self._rows.append((*figures, trials, accepted))

    def cancelled(self, vertices: FloatArray) -> bool:
        """Call the callback with the last step and its local vertices (n, 3), and return whether it cancels."""
        if self._callback is None:
            return False
        state = SolveState(len(self._rows), self._steps, *_figures(self._rows[-1]), self.seconds, self._to_model(vertices))
        try:
            return self._callback(state) is True
        except StopIteration:
            return True


def _solving_time() -> float:
    return time.perf_counter() - compile_seconds()


def _figures(row: tuple) -> tuple[float, float, float, float, int]:
    energy, error_norm, max_error, step_length, trials, _ = row
    return energy, error_norm, max_error, step_length, trials
