"""Subdivision of meshes with supports, creases, targets and goals."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING
from typing import Any

import numpy as np
from compas.datastructures import Mesh
from compas.datastructures.mesh.subdivision import mesh_subdivide

from ..errors import did_you_mean
from ..model.constraints import Constraint
from ..model.goals.places import EdgeInPlan
from ..model.goals.places import Level
from ..model.goals.wholes import Length

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["SCHEMES", "subdivided"]

SCHEMES = ("catmullclark", "corner", "loop", "quad", "tri")
SMOOTH = ("catmullclark", "loop")  # schemes that move vertices, except the `fixed` ones
Pair = tuple[int, int]


def subdivided(mesh: CGCMesh, scheme: str, k: int, **options: Any) -> CGCMesh:
    """Return a mesh subdivided `k` times, see :meth:`CGCMesh.subdivided`.

    Raises
    ------
    ValueError
        If the scheme does not keep the vertices.
    """
    if scheme not in SCHEMES:
        raise ValueError(
            f"the scheme must be one of {', '.join(SCHEMES)}, not {scheme!r}{did_you_mean(scheme, SCHEMES)}; "
            "other schemes of COMPAS do not keep creases: subdivide mesh.copy(cls=Mesh) with them"
        )
    for _ in range(k):
        mesh = _subdivided_once(mesh, scheme, options)
    return mesh


def _subdivided_once(mesh: CGCMesh, scheme: str, options: dict) -> CGCMesh:
    plain = Mesh.from_vertices_and_faces(
        {key: mesh.vertex_coordinates(key) for key in mesh.vertices()}, {face: mesh.face_vertices(face) for face in mesh.faces()}
    )
    given = {**options, "fixed": [*mesh.supports(), *(options.get("fixed") or ())]} if scheme in SMOOTH else options
    fine = mesh_subdivide(plain, scheme, k=1, **given)
    parents = _parents(mesh, fine)
    middle = {pair: key for key, pair in parents.items() if len(pair) == 2}
    made = type(mesh).from_vertices_and_faces(
        {key: fine.vertex_coordinates(key) for key in fine.vertices()}, {face: fine.face_vertices(face) for face in fine.faces()}
    )
    for key in mesh.vertices():
        own = {name: value for name, value in mesh.vertex[key].items() if name not in ("x", "y", "z")}
        made.vertex[key].update(own)
    _set_new_vertices(made, mesh, parents)
    for name, values in mesh.edgedata.items():
        u, v = (int(end) for end in name.strip("()").split(","))
        w = middle.get(_pair(u, v))
        for edge in [(u, v)] if w is None else [(u, w), (w, v)]:
            made.edge_attributes(edge, list(values), list(values.values()))
    made.default_vertex_attributes.update(mesh.default_vertex_attributes)
    made.attributes.update({name: value for name, value in mesh.attributes.items() if name not in ("goals", "dropped_faces")})
    made.name = mesh.name
    made.set_goals(_refined_goals(mesh, made, middle))
    made.update_roles()
    made._set_laws(mesh._laws())
    return made


def _parents(mesh: CGCMesh, fine: Mesh) -> dict[int, tuple[int, ...]]:
    """Return the ends of the edge, or the corners of the face, in which every new vertex lies."""
    neighbours = {key: set(fine.vertex_neighbors(key)) for key in fine.vertices() if key not in mesh.vertex}
    on_edges = {key: _pair(*near) for key, around in neighbours.items() if len(near := [k for k in around if k in mesh.vertex]) == 2}
    in_faces = {
        key: tuple(sorted({corner for near in around for corner in on_edges.get(near, (near,))}))
        for key, around in neighbours.items()
        if key not in on_edges
    }
    return {**on_edges, **in_faces}


def _set_new_vertices(made: CGCMesh, mesh: CGCMesh, parents: dict[int, tuple[int, ...]]) -> None:
    """Set role, target, s and e of the new vertices."""
    held = _not_a_chord(mesh)
    target_of_face = _face_targets(mesh)
    for key, corners in parents.items():
        roles = [mesh.vertex_role(corner) for corner in corners]
        own = made.vertex[key]
        if "dummy" in roles:
            own["role"] = "dummy"
        elif len(corners) == 2 and set(roles) == {"fixed"} and held(corners):
            # The drawn edge stays where it is, also where the scheme smooths.
            own.update(zip("xyz", _mean([mesh.vertex_coordinates(corner) for corner in corners])), role="fixed")
        targets = [mesh.vertex_target(corner) for corner, role in zip(corners, roles) if role == "internal"]
        if not targets:
            around = {mesh.halfedge[u].get(v) for u in corners for v in corners if u != v} - {None}
            targets = [target_of_face[face] for face in around if set(corners) <= set(mesh.face_vertices(face))]
        known = [target for target in targets if target is not None and target == target]
        if known:
            own["target"] = _average(known)
        for name, rounded in (("s", float), ("e", round)):
            values = [mesh.vertex_attribute(corner, name) for corner in corners]
            if len(corners) == 2 and None not in values:
                own[name] = rounded(sum(values) / 2)


def _face_targets(mesh: CGCMesh) -> dict[int, float]:
    """Return the mean target of the internal corners of every face, or of its region if it has none."""
    problem = mesh.to_problem()
    asked = problem.asked & np.isfinite(problem.targets)
    label, within = problem.regions(), {}
    for region in range(int(label.max(initial=-1)) + 1):
        corners = np.unique(problem.faces[label == region])
        within[region] = _average(problem.targets[corners[asked[corners]]].tolist())
    of_corners = [_average([float(problem.targets[v]) for v in face if asked[v]]) for face in problem.faces.tolist()]
    return {face: within[region] if K != K else K for face, K, region in zip(mesh.faces(), of_corners, label.tolist())}


def _average(values: Sequence[float]) -> float:
    """Return the mean of numbers, free of rounding if they are equal, NaN if there are none."""
    return float(values[0] if len(set(values)) == 1 else np.mean(values)) if values else np.nan


def _not_a_chord(mesh: CGCMesh) -> Callable[[Sequence[int]], bool]:
    """Return a check that an edge shares what its ends share, which an edge between two boundary points across a face does not."""
    rim = {key for key in mesh.vertices() if None in mesh.halfedge[key].values()}
    creases = {_pair(*edge) for edge in mesh.crease_edges()}

    def follows(edge: Sequence[int]) -> bool:
        u, v = edge
        inner = mesh.halfedge[u].get(v) is not None and mesh.halfedge[v].get(u) is not None
        return not inner or _pair(u, v) in creases or not (u in rim and v in rim)

    return follows


def _refined_goals(mesh: CGCMesh, made: CGCMesh, middle: dict[Pair, int]) -> list[Constraint]:
    """Return the goals with the vertices of the fine mesh: those of an edge follow a goal if both of its ends do."""
    keys = list(mesh.vertices())
    index = {key: i for i, key in enumerate(made.vertices())}
    follows = _not_a_chord(mesh)
    goals = []
    for goal in mesh.goals():
        named = getattr(goal, "vertices", None)
        if named is None or isinstance(named, str):
            goals.append(goal)
            continue
        own = [keys[i] for i in named]
        if isinstance(goal, (EdgeInPlan, Length, Level)):
            goals.append(_refined_path(goal, own, middle, index))
            continue
        members = set(own)
        new = [key for pair, key in middle.items() if members.issuperset(pair) and follows(pair)]
        changed: dict[str, Any] = {"vertices": [index[key] for key in own + new]}
        goals.append(replace(goal, **changed))
    return goals


def _refined_path(goal: Constraint, path: Sequence[int], middle: dict[Pair, int], index: dict[int, int]) -> Constraint:
    places = getattr(goal, "points", None) if isinstance(goal, Level) else None
    vertices, points = [path[0]], [] if places is None else [places[0]]
    around = [*path, path[0]] if isinstance(goal, Level) else path
    for at, (u, v) in enumerate(zip(around, around[1:])):
        w, last = middle.get(_pair(u, v)), at + 1 == len(path)
        if w is not None and w not in vertices:
            vertices.append(w)
            if places is not None:
                points.append(_mean([places[at], places[0 if last else at + 1]]))
        if not last:
            vertices.append(v)
            if places is not None:
                points.append(places[at + 1])
    changed: dict[str, Any] = {"vertices": [index[key] for key in vertices]}
    if places is not None:
        changed["points"] = points
    return replace(goal, **changed)


def _pair(u: int, v: int) -> Pair:
    return (u, v) if u < v else (v, u)


def _mean(points: Iterable[Sequence[float]]) -> list[float]:
    return np.mean(list(points), axis=0).tolist()
