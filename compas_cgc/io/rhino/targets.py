"""Conversion of text dots and user text to laws of regions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing import Diagnostic
from ...meshing import face_regions
from ...meshing.point_location import face_at
from ...model.laws import ConstantCurvature
from ...model.laws import Law
from .meshes import JoinedMesh
from .sketch import Drawn
from .sketch import Part

__all__ = ["find_laws"]


def find_laws(
    dots: list[Drawn], parts: list[Part], solved: Mapping[int, Optional[Law]], mesh: JoinedMesh, creases: IntArray, unit: str
) -> tuple[FloatArray, dict[int, Law], list[str], list[Diagnostic]]:
    """Return the target of every vertex and the other laws of the regions.

    Sources in order of precedence: text dots and points inside the region, the regions of an
    earlier result, user text ``law`` or ``K`` of the mesh, the same of its layer.

    Parameters
    ----------
    dots
        Text dots such as ``K=0.03`` or ``H=0.1``, and points with user text ``K`` or ``law``.
    parts
        The objects from which the mesh was joined.
    solved
        Law of every region of an earlier result, empty if there is none.
    mesh
        The mesh.
    creases
        ``(c, 2)`` crease edges.
    unit
        Unit appended to lengths in messages.

    Returns
    -------
    targets (n,), laws, notes, diagnostics
        Targets are NaN where K is not prescribed; vertices on creases have the target of the last region that has one. Laws other than
        constant K are by region.
    """
    region = face_regions(mesh.faces, creases)
    count = int(region.max()) + 1
    laws: dict[int, Law] = {}
    notes = []
    for owner, part in reversed(list(enumerate(parts))):
        if part.law is not None:
            laws.update(dict.fromkeys(np.unique(region[mesh.owner == owner]).tolist(), part.law))
            notes.append(f"{part.label} prescribes {_shown(part.law)}")
    earlier = {r: law for r, law in solved.items() if law is not None} if set(solved) == set(range(count)) else {}
    laws.update(earlier)
    if solved and not earlier:
        notes.append("the regions of an earlier result do not match this mesh; their targets were ignored")
    by_dot: dict[int, Drawn] = {}
    diagnostics: list[str] = []
    for item in dots:
        if item.law is None:
            diagnostics.append(f"target {item.label} is neither a number nor a law; write K=0.03, with the curvature you want, or H=0.1")
            continue
        face, distance = face_at(item.points[0], mesh.vertices, mesh.faces)
        r = int(region[face])
        other = by_dot.setdefault(r, item)
        if other.law is not None and other.law != item.law:
            these = f"targets {item.label} ({_shown(item.law, '')}) and {other.label} ({_shown(other.law, '')})"
            diagnostics.append(f"{these} lie in the same region; delete one")
        if distance > 0.0:
            notes.append(f"target {item.label} lies {distance:.3g}{unit} off the mesh; it was assigned to the nearest region, {r}")
        laws[r] = item.law
    kept = [r for r in earlier if r not in by_dot]
    overruled = [r for r, item in by_dot.items() if r in earlier and item.law != earlier[r]]
    if kept:
        notes.append(f"targets of an earlier result were used for {len(kept)} {_regions(len(kept))} without other targets")
    if overruled:
        these = "this target" if len(overruled) == 1 else "these targets"
        count_text = f"{len(overruled)} {_regions(len(overruled))}"
        notes.append(
            f"an earlier result has other values than the targets drawn in {count_text}; the drawn ones were used. Delete {these} to keep "
            "the values of the result, or make K unknown again"
        )
    without = [r for r in range(count) if r not in laws] if laws else []
    notes += [f"region {r} (around face {int(np.argmax(region == r))}) has no target" for r in without]
    targets = np.full(len(mesh.vertices), np.nan)
    K = np.array([law.k if isinstance(law, ConstantCurvature) else np.nan for law in map(laws.get, range(count))], dtype=np.float64)
    for corner in range(3):
        value = K[region]
        known = np.isfinite(value)
        targets[mesh.faces[known, corner]] = value[known]
    others = {r: law for r, law in sorted(laws.items()) if not isinstance(law, ConstantCurvature)}
    return targets, others, notes, [Diagnostic(text) for text in diagnostics]


def _regions(count: int) -> str:
    return "region" if count == 1 else "regions"


def _shown(law: Law, space: str = " ") -> str:
    """Return a law in messages; constant K with six digits."""
    return f"K{space}={space}{law.k:g}" if isinstance(law, ConstantCurvature) else str(law)
