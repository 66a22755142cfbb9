"""Measurements of meshes, cached for all components."""

from __future__ import annotations

import threading
from collections import OrderedDict
from typing import NamedTuple

from ...analysis import SurfaceReport
from ...analysis import analyse
from ...discrete.arrays import FloatArray
from ...model.problem import PosesProblem
from ...scene.figures import figures
from .fingerprint import problem_fingerprint

__all__ = ["Measured", "measure"]

CACHE_SIZE = 16  # number of meshes


class Measured(NamedTuple):
    """Measurement of a mesh."""

    figures: dict[str, FloatArray]  # (n,) quantities at the vertices, NaN where undefined
    report: SurfaceReport


_KNOWN: OrderedDict[str, Measured] = OrderedDict()
_LOCK = threading.Lock()


def measure(mesh: PosesProblem) -> Measured:
    """Return the measurement of a mesh."""
    name = problem_fingerprint(mesh)
    with _LOCK:
        known = _KNOWN.get(name)
    if known is not None:
        return known
    made = Measured(figures(mesh), analyse(mesh))
    with _LOCK:
        _KNOWN[name] = made
        while len(_KNOWN) > CACHE_SIZE:
            _KNOWN.popitem(last=False)
    return made
