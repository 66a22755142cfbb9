"""Parts of a mesh, and goals that name vertices of a part."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Set
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from compas.datastructures import Mesh

from ..model.constraints import Constraint
from ..model.goals.inequalities import Clearance
from ..model.goals.wholes import Length
from ..model.goals.wholes import Unknown

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["drop_from_goals", "part_of"]


def drop_from_goals(mesh: CGCMesh, lost: Set[int]) -> None:
    """Remove vertices that are about to be deleted from the goals, and goals that have no vertex left."""
    goals = mesh.goals()
    if not lost or not any(_names_vertices(goal) for goal in goals):
        return
    kept = np.array([key not in lost for key in mesh.vertices()])
    index = np.where(kept, np.cumsum(kept) - 1, -1)
    mesh.set_goals([goal.renumbered(index) for goal in goals if _survives(goal, kept)])


def part_of(mesh: CGCMesh, keys: Collection[int]) -> CGCMesh:
    """Return the part of a mesh with these vertices, which has all faces at them."""
    part = mesh._duplicate()
    inside = set(keys)
    lost = {key for key in mesh.vertices() if key not in inside}
    old = {faces[0]: number for number, faces in enumerate(mesh.regions())}
    drop_from_goals(part, lost)
    for key in lost:
        Mesh.delete_vertex(part, key)
    new = {old[faces[0]]: number for number, faces in enumerate(part.regions())}
    part.set_goals([own for goal in part.goals() for own in _in_regions(goal, new)])
    return part


def _in_regions(goal: Constraint, new: dict[int, int]) -> list[Constraint]:
    """Return the goal with new numbers of its regions, or nothing if it names none of them."""
    if isinstance(goal, Unknown) and not isinstance(goal.regions, str):
        regions = [new[region] for region in goal.regions if region in new]
        return [replace(goal, regions=regions)] if regions else []
    if isinstance(goal, Clearance) and isinstance(goal.where, (int, np.integer)):
        return [goal.with_regions(new.__getitem__)] if int(goal.where) in new else []
    return [goal]


def _names_vertices(goal: Constraint) -> bool:
    return not isinstance(getattr(goal, "vertices", ""), str)


def _survives(goal: Constraint, kept: np.ndarray) -> bool:
    """Check whether a goal still makes sense: a path needs all of its vertices, other goals one."""
    if not _names_vertices(goal):
        return True
    own = kept[np.asarray(goal.vertices, dtype=np.int64)]  # type: ignore[attr-defined]
    return bool(own.all() if isinstance(goal, Length) else own.any())
