"""Checks of mesh data that arrays cannot represent."""

from __future__ import annotations

import math

from compas.datastructures import Mesh

from ..meshing import Diagnostic
from ..meshing.checks import listed
from ..model.checks import dropped_faces
from ..model.checks import lost_creases

__all__ = ["diagnostics_of_keys"]


def diagnostics_of_keys(mesh: Mesh) -> list[Diagnostic]:
    """Return diagnostics for data that arrays cannot represent: non-finite numbers, dropped faces, polygons, stale creases."""
    problems = []
    broken = [v for v, own in mesh.vertex.items() if not all(math.isfinite(own[axis]) for axis in "xyz")]
    if broken:
        problems.append(Diagnostic(f"vertices {listed(broken)} have coordinates that are not finite numbers; correct them"))
    dropped = mesh.attributes.get("dropped_faces") or []
    if dropped:
        problems.append(dropped_faces([key for key, _ in dropped]))
    large = [face for face, corners in mesh.face.items() if len(corners) > 3]
    if large:
        problems.append(Diagnostic(f"faces {listed(large)} have more than three corners; triangulate them (mesh.triangulate())"))
    lost = [tuple(int(v) for v in name.strip("()").split(",")) for name, values in mesh.edgedata.items() if values.get("is_crease")]
    lost = [(u, v) for u, v in lost if u not in mesh.vertex or v not in mesh.vertex]
    if lost:
        problems.append(lost_creases(lost))
    wrong = {v: own["target"] for v, own in mesh.vertex.items() if not _is_target(own.get("target")) and own.get("role") == "internal"}
    if wrong:
        values = listed([repr(value) for value in list(wrong.values())[:3]])
        problems.append(Diagnostic(f"the targets of vertices {listed(list(wrong))} are not finite numbers ({values}); set finite targets"))
    return problems


def _is_target(value: object) -> bool:
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value))
