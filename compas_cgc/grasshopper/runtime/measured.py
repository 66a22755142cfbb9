"""Measurements of meshes, cached for all components."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

from ..._compiled import watch_compilation
from ...analysis import SurfaceReport
from ...analysis import analyse
from ...discrete.arrays import FloatArray
from ...model.problem import PosesProblem
from ...scene.figures import figures
from .progress import Progress
from .progress import Report
from .wire_mesh import problem_fingerprint

__all__ = ["Measured", "known_measures", "measure"]

CACHE_SIZE = 16  # number of meshes


class Measured(NamedTuple):
    """Measurement of a mesh."""

    figures: dict[str, FloatArray]  # (n,) quantities at the vertices, NaN where undefined
    report: SurfaceReport


_KNOWN: OrderedDict[str, Measured] = OrderedDict()
_LOCK = threading.Lock()


def known_measures(mesh: PosesProblem) -> Optional[Measured]:
    """Return the cached measurement of a mesh, or None."""
    with _LOCK:
        return _KNOWN.get(problem_fingerprint(mesh))


def measure(mesh: PosesProblem) -> Callable[[Report], Measured]:
    """Return a function that measures a mesh, for a background task. The mesh must not be changed meanwhile."""

    def run(report: Report) -> Measured:
        name = problem_fingerprint(mesh)
        with _LOCK:
            known = _KNOWN.get(name)
        if known is not None:
            return known
        with watch_compilation(lambda state: report(Progress(compiling=state.part))):
            made = Measured(figures(mesh), analyse(mesh))
        with _LOCK:
            _KNOWN[name] = made
            while len(_KNOWN) > CACHE_SIZE:
                _KNOWN.popitem(last=False)
        return made

    return run
