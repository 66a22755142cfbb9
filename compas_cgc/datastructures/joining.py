"""Joining and welding of meshes with supports, creases, targets and goals."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

import numpy as np
from compas.datastructures import Mesh
from compas.tolerance import TOL

from ..model.constraints import Constraint
from ..model.constraints import Height
from ..model.constraints import Mirror
from ..model.goals.binding import bind
from ..model.goals.binding import unknown_regions
from ..model.goals.inequalities import Bound
from ..model.goals.names import goal_name
from ..model.goals.places import EdgeInPlan
from ..model.goals.places import Level
from ..model.goals.wholes import Area
from ..model.goals.wholes import Rise
from ..model.goals.wholes import Unknown
from ..model.goals.wholes import Volume
from ..model.laws import Law

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["join", "weld"]


def join(mesh: CGCMesh, other: Mesh) -> None:
    """Add the vertices, faces, edge attributes and goals of another mesh, see :meth:`CGCMesh.join`.

    Raises
    ------
    ValueError
        If the meshes differ in their units or in a goal for the whole surface.
    """
    added = other if isinstance(other, type(mesh)) else type(mesh).from_mesh(other)
    _check_units(mesh, added)
    goals = _joined_goals(mesh, added)
    for name in ("default_vertex_attributes", "default_edge_attributes", "default_face_attributes"):
        getattr(mesh, name).update({own: value for own, value in getattr(added, name).items() if own not in getattr(mesh, name)})
    key_of = {}
    for key in list(added.vertices()):
        key_of[key] = mesh.add_vertex(
            attr_dict=_explicit(added.vertex[key], added.default_vertex_attributes, mesh.default_vertex_attributes)
        )
    for face in list(added.faces()):
        own = _explicit(added.facedata.get(face) or {}, added.default_face_attributes, mesh.default_face_attributes)
        mesh.add_face([key_of[key] for key in added.face_vertices(face)], attr_dict=own)
    for name, values in list(added.edgedata.items()):
        u, v = (int(end) for end in name.strip("()").split(","))
        if u in key_of and v in key_of:
            mesh.edge_attributes((key_of[u], key_of[v]), list(values), list(values.values()))
    for name in ("units", "tolerance"):
        if added.attributes.get(name) is not None:
            mesh.attributes.setdefault(name, added.attributes[name])
    mesh.origin = None
    mesh.set_goals(goals)


def _explicit(values: dict, defaults: dict, present: dict) -> dict:
    """Return attributes together with those defaults that differ from the present ones."""
    differing = {name: value for name, value in defaults.items() if present.get(name) != value}
    return {**differing, **values}


def _check_units(mesh: CGCMesh, other: CGCMesh) -> None:
    one, two = (own.attributes.get("units") for own in (mesh, other))
    if one and two and one != two:
        raise ValueError(f"the meshes are drawn in {one} and {two}; scale one of them and set its attribute 'units' before joining")


def _joined_goals(mesh: CGCMesh, other: CGCMesh) -> list[Constraint]:
    if not mesh.goals() and not other.goals():
        return []
    joined = _goals_of_part(mesh)
    vertices = mesh.number_of_vertices() + np.arange(other.number_of_vertices())
    regions = len(mesh.regions())
    for goal in _goals_of_part(other):
        moved = goal.renumbered(vertices).with_regions(lambda region: region + regions)
        twin = next((own for own in joined if _is_whole(own) and type(own) is type(moved)), None)
        if not _is_whole(moved):
            joined.append(moved)
        elif twin is None:
            joined.append(moved)
        elif twin != moved:
            raise ValueError(
                f"{goal_name(twin)} and {goal_name(moved)} of the two meshes cannot both hold for the joined surface; "
                "remove one before joining"
            )
    return joined


def _is_whole(goal: Constraint) -> bool:
    """Check whether a goal concerns the whole surface, however it is divided."""
    return isinstance(goal, (Area, Mirror, Rise, Volume)) or (isinstance(goal, Height) and isinstance(goal.vertices, str))


def _goals_of_part(mesh: CGCMesh) -> list[Constraint]:
    """Return the goals with words such as "all" and "free" replaced by the vertices and regions of this mesh."""
    found: list[Constraint] = []
    for goal in mesh.goals():
        words = isinstance(getattr(goal, "vertices", None), str)
        changed: dict[str, Any] = {}
        if isinstance(goal, Unknown):
            changed = {"regions": unknown_regions(mesh.to_problem().with_goals([goal], add=False))}
        elif words and isinstance(goal, (EdgeInPlan, Level)):
            bound = bind(mesh.to_problem().with_goals([goal], add=False)).places
            places = [place for place in bound if isinstance(place, (EdgeInPlan, Level))]
            found += [replace(place, points=np.asarray(place.points).tolist()) for place in places]
            continue
        elif words and isinstance(goal, Bound):
            changed = {"vertices": np.flatnonzero(mesh.to_problem().movable).tolist()}
        found.append(replace(goal, **changed) if changed else goal)
    return found


def weld(mesh: CGCMesh, precision: Optional[int]) -> None:
    """Merge coincident vertices, see :meth:`CGCMesh.weld`."""
    keys = list(mesh.vertices())
    first: dict[str, int] = {}
    kept = {key: first.setdefault(TOL.geometric_key(mesh.vertex_coordinates(key), precision=precision), key) for key in keys}
    merged = {key for key, survivor in kept.items() if key != survivor}
    if not merged:
        return
    law_of = _region_law_by_face(mesh)
    for key in merged:
        _merge(mesh.vertex[kept[key]], mesh.vertex[key])
    number = {key: i for i, key in enumerate(key for key in keys if key not in merged)}
    mesh.set_goals([goal.renumbered(np.array([number[kept[key]] for key in keys])) for goal in mesh.goals()])
    edges = {name: values for name, values in mesh.edgedata.items()}
    corners = {face: [kept[key] for key in mesh.face_vertices(face)] for face in mesh.faces()}
    mesh.vertex = {key: values for key, values in mesh.vertex.items() if key not in merged}
    mesh.halfedge = {key: {} for key in mesh.vertex}
    mesh.face, mesh.edgedata, data, mesh.facedata = {}, {}, mesh.facedata, {}
    for face, vertices in corners.items():
        if len(set(vertices)) == len(vertices):
            mesh.add_face(vertices, fkey=face, attr_dict=data.get(face))
    for name, values in edges.items():
        u, v = (kept[int(end)] for end in name.strip("()").split(","))
        if u != v and (v in mesh.halfedge[u] or u in mesh.halfedge[v]):
            mesh.edge_attributes((u, v), list(values), list(values.values()))
    survivors = {kept[key] for key in merged}
    for u in survivors:
        for v, face in mesh.halfedge[u].items():
            across = mesh.halfedge[v].get(u)
            if u < v and v in survivors and face is not None and across is not None and law_of.get(face) != law_of.get(across):
                mesh.edge_attribute((u, v), "is_crease", True)
    mesh.origin = None
    mesh.update_roles()


def _region_law_by_face(mesh: CGCMesh) -> dict[int, Optional[Law]]:
    return {face: law for number, faces in enumerate(mesh.regions()) for law in [mesh.region_law(number)] for face in faces}


def _merge(kept: dict, merged: dict) -> None:
    """Add to the attributes of a vertex those of one at the same place: a support stays a support."""
    if merged.get("role") == "fixed":
        kept["role"] = "fixed"
    for name, value in merged.items():
        if kept.get(name) is None:
            kept[name] = value
