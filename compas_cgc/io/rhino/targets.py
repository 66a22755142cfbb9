"""Conversion of text dots and user text to targets of vertices."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing import Diagnostic
from ...meshing import face_regions
from ...meshing.point_location import face_at
from .meshes import JoinedMesh
from .sketch import Drawn
from .sketch import Part

__all__ = ["find_targets"]


def find_targets(
    dots: list[Drawn], parts: list[Part], solved: Mapping[int, Optional[float]], mesh: JoinedMesh, creases: IntArray, unit: str
) -> tuple[FloatArray, list[str], list[Diagnostic]]:
    """Return the target of every vertex from the targets of the regions.

    Sources in order of precedence: text dots and points inside the region, the regions of an
    earlier result, user text ``K`` of the mesh, user text ``K`` of its layer.

    Parameters
    ----------
    dots
        Text dots such as ``K=0.03``, and points with user text ``K``.
    parts
        The objects from which the mesh was joined.
    solved
        Target of every region of an earlier result, empty if there is none.
    mesh
        The mesh.
    creases
        ``(c, 2)`` crease edges.
    unit
        Unit appended to lengths in messages.

    Returns
    -------
    targets (n,), notes, diagnostics
        NaN where K is not prescribed; vertices on creases have the target of the last region that has one.
    """
    region = face_regions(mesh.faces, creases)
    count = int(region.max()) + 1
    K = np.full(count, np.nan)
    notes = []
    for owner, part in reversed(list(enumerate(parts))):
        if part.target is not None:
            K[np.unique(region[mesh.owner == owner])] = part.target
            notes.append(f"{part.label} prescribes K = {part.target:g}")
    if set(solved) == set(range(count)):
        known = [r for r, value in solved.items() if value is not None]
        K[known] = [solved[r] for r in known]
        notes.append(f"targets of an earlier result were used for {count} region{'' if count == 1 else 's'} without other targets")
    elif solved:
        notes.append("the regions of an earlier result do not match this mesh; their targets were ignored")
    by_dot: dict[int, Drawn] = {}
    diagnostics: list[str] = []
    for item in dots:
        if item.target is None:
            diagnostics.append(f"target {item.label} is not a number; write K=0.03, with the curvature you want")
            continue
        face, distance = face_at(item.points[0], mesh.vertices, mesh.faces)
        r = int(region[face])
        other = by_dot.setdefault(r, item)
        if other.target != item.target:
            diagnostics.append(
                f"targets {item.label} (K={item.target:g}) and {other.label} (K={other.target:g}) lie in the same region; delete one"
            )
        if distance > 0.0:
            notes.append(f"target {item.label} lies {distance:.3g}{unit} off the mesh; it was assigned to the nearest region, {r}")
        K[r] = item.target
    without = np.flatnonzero(np.isnan(K) & np.isfinite(K).any())
    notes += [f"region {r} (around face {int(np.argmax(region == r))}) has no target" for r in without]
    targets = np.full(len(mesh.vertices), np.nan)
    for corner in range(3):
        value = K[region]
        known = np.isfinite(value)
        targets[mesh.faces[known, corner]] = value[known]
    return targets, notes, [Diagnostic(text) for text in diagnostics]
