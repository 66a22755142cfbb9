"""Measurements of meshes, cached for all components."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

from ..._compiled import watch_compilation
from ...analysis import SurfaceReport
from ...analysis import analyse
from ...datastructures import CGCMesh
from ...discrete.arrays import FloatArray
from ...scene.figures import figures
from .progress import Progress
from .progress import Report

__all__ = ["Measured", "known_measures", "measure", "mesh_fingerprint"]

CACHE_SIZE = 16  # number of meshes


class Measured(NamedTuple):
    """Measurement of a mesh."""

    figures: dict[str, FloatArray]  # (n,) quantities at the vertices, NaN where undefined
    report: SurfaceReport


_KNOWN: OrderedDict[str, Measured] = OrderedDict()
_LOCK = threading.Lock()


def mesh_fingerprint(mesh: CGCMesh) -> str:
    """Return a text that is equal for equal meshes, also of different objects."""
    parts = (mesh.default_vertex_attributes, mesh.vertex, mesh.face, mesh.crease_edges())
    return hashlib.sha1(repr(parts).encode("utf-8")).hexdigest()


def known_measures(mesh: CGCMesh) -> Optional[Measured]:
    """Return the cached measurement of a mesh, or None."""
    with _LOCK:
        return _KNOWN.get(mesh_fingerprint(mesh))


def measure(mesh: CGCMesh) -> Callable[[Report], Measured]:
    """Return a function that measures a mesh, for a background task. The mesh must not be changed meanwhile."""

    def run(report: Report) -> Measured:
        name = mesh_fingerprint(mesh)
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
