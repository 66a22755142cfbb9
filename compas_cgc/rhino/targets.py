"""Text dots and user text to a target for every vertex."""

from __future__ import annotations

import json
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing import face_regions
from ..meshing.locate import face_at
from .objects import Item
from .shell import Shell
from .supports import item_points
from .texts import dot_target
from .texts import user_number
from .texts import user_target

__all__ = ["VERTEX_KEY", "read_targets", "read_vertex_values"]

# User text on a mesh: values of single vertices, where they are not the same all over a region.
VERTEX_KEY = "cgc vertices"


def read_targets(
    dots: list[Item], meshes: list[Item], solved: list[Item], shell: Shell, creases: IntArray, unit: str
) -> tuple[FloatArray, list[str], list[str]]:
    """Give every vertex the target of its region.

    In this order, later ones first: text dots and points inside of the region, the
    regions of an earlier result, user text ``K`` on the mesh, user text ``K`` on its layer.

    Parameters
    ----------
    dots
        Text dots such as ``K=0.03``, and points with user text ``K``.
    meshes
        The objects that the mesh was made of.
    solved
        Region meshes of an earlier result.
    shell
        The mesh.
    creases
        ``(c, 2)`` crease edges.
    unit
        What lengths are followed by in sentences.

    Returns
    -------
    targets (n,), notes, problems
        NaN where there is none; on creases the target of the last region that has one.
    """
    region = face_regions(shell.faces, creases)
    count = int(region.max()) + 1
    K = np.full(count, np.nan)
    own = [user_target({**item.layer_text, **item.text}) for item in meshes]
    for owner, value in reversed(list(enumerate(own))):
        if value is not None:
            K[np.unique(region[shell.owner == owner])] = value
    notes = [f"{item.label} asks for K = {value:g}" for item, value in zip(meshes, own) if value is not None]
    earlier = {user_number(item.text, "region"): user_target(item.text) for item in solved}
    if earlier and set(earlier) == set(range(count)):
        for number, value in earlier.items():
            if value is not None:
                K[int(number)] = value
        notes.append(f"the targets of an earlier result hold where nothing else is said: {count} regions")
    elif earlier:
        notes.append("the regions of an earlier result are not those of this mesh; their targets were left out")
    by_dot: dict[int, tuple[float, Item]] = {}
    problems = []
    for item in dots:
        value = _target(item)
        if value is None:
            problems.append(f"target {item.label} does not say a number; write K=0.03, with the number you want")
            continue
        face, distance = face_at(_place(item), shell.vertices, shell.faces)
        r = int(region[face])
        other = by_dot.setdefault(r, (value, item))
        if other[0] != value:
            problems.append(f"targets {item.label} (K={value:g}) and {other[1].id} (K={other[0]:g}) lie in the same region; delete one")
        if distance > 0.0:
            notes.append(f"target {item.label} lies {distance:.3g}{unit} off the mesh; it was given to the nearest region, {r}")
        K[r] = value
    notes += [f"region {r} (around face {int(np.argmax(region == r))}) has no target" for r in np.flatnonzero(np.isnan(K)) if count > 1]
    targets = np.full(len(shell.vertices), np.nan)
    for corner in range(3):
        value = K[region]
        known = np.isfinite(value)
        targets[shell.faces[known, corner]] = value[known]
    return targets, notes, problems


def read_vertex_values(meshes: list[Item], shell: Shell) -> dict[str, FloatArray]:
    """Return the values of single vertices in the user text of a mesh: ``target``, ``s``, ``e``, each (n,), NaN where none.

    Empty unless the file has one mesh whose vertices are as they were written.
    """
    text = meshes[0].text.get(VERTEX_KEY) if len(meshes) == 1 else None
    if text is None:
        return {}
    n = len(shell.vertices)
    try:
        found = {
            name: np.array([np.nan if x is None else x for x in values], dtype=np.float64) for name, values in json.loads(text).items()
        }
    except (AttributeError, TypeError, ValueError):
        return {}
    return {name: values for name, values in found.items() if name in ("target", "s", "e") and values.shape == (n,)}


def _target(item: Item) -> Optional[float]:
    own = user_target(item.text)
    return own if own is not None or item.kind != "text dot" else dot_target(item.geometry.Text)


def _place(item: Item) -> FloatArray:
    if item.kind == "point":
        return item_points(item)[0]
    p = item.geometry.Point
    return np.array([p.X, p.Y, p.Z])
