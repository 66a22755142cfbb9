"""What keeps a CGCMesh from being solved."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..meshing import Problem
from ..meshing import existence_problems
from ..meshing import face_regions
from ..meshing import mesh_problems
from ..meshing.checks import listed
from ..meshing.checks import plane_of

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["check"]


def check(mesh: CGCMesh) -> list[Problem]:
    """List the problems of a mesh: first of its geometry, then of what is asked of it."""
    problems = _polygon_problems(mesh)
    if any(problem.fatal for problem in problems):
        return problems
    vertices, faces = mesh.arrays(dummies=True)
    names = np.array(list(mesh.vertices()), dtype=np.int64)
    problems += mesh_problems(vertices, faces, names, np.array(list(mesh.faces()), dtype=np.int64))
    sound = not any(problem.fatal for problem in problems)
    problems += _role_problems(mesh) + _target_problems(mesh)
    if sound and not any(problem.fatal for problem in problems):
        problems += _existence_problems(mesh)
    return problems


def _polygon_problems(mesh: CGCMesh) -> list[Problem]:
    problems = []
    dropped = mesh.attributes.get("dropped_faces") or []
    if dropped:
        named = listed([key for key, _ in dropped])
        problems.append(Problem(f"faces {named} of the input have fewer than three different corners, they are degenerate; remove them"))
    large = [face for face, corners in mesh.face.items() if len(corners) > 3]
    if large:
        problems.append(Problem(f"faces {listed(large)} have more than three corners; triangulate them (mesh.triangulate() does)"))
    return problems


def _role_problems(mesh: CGCMesh) -> list[Problem]:
    problems = []
    if not mesh.supports():
        mend = "mesh.set_supports('boundary') or --supports boundary fixes the whole edge"
        problems.append(Problem(f"the mesh has no support, nothing holds it; fix vertices ({mend})"))
    lost = [tuple(int(v) for v in name.strip("()").split(",")) for name, values in mesh.edgedata.items() if values.get("is_crease")]
    lost = [(u, v) for u, v in lost if u not in mesh.halfedge or v not in mesh.halfedge or v not in mesh.halfedge[u]]
    if lost:
        problems.append(Problem(f"the creases {listed(lost)} do not follow edges of the mesh; set the creases again (mesh.set_creases)"))
    if not any(mesh.vertex_role(v) in ("internal", "free") for v in mesh.vertices()):
        problems.append(
            Problem("there is no internal vertex, so no curvature to ask for; refine the mesh or free some supports or creases")
        )
    return problems


def _target_problems(mesh: CGCMesh) -> list[Problem]:
    problems = []
    # With a dummy ring, or for a method that adds one, K is asked for on free edges too.
    asked = [v for v in mesh.vertices() if mesh.vertex_role(v) == "internal"]
    missing = [v for v in asked if mesh.vertex_target(v) is None]
    wrong = [v for v in asked if mesh.vertex_target(v) is not None and not _is_number(mesh.vertex_target(v))]
    if missing and len(missing) == len(asked):
        problems.append(Problem("no target is set; say which Gaussian curvature is wanted (mesh.set_target(K), or --target K)"))
    elif missing:
        problems.append(Problem(f"vertices {listed(missing)} have no target; set one for their region (mesh.set_target(K, region=r))"))
    if wrong:
        values = listed([repr(mesh.vertex_target(v)) for v in wrong[:3]])
        problems.append(Problem(f"the targets of vertices {listed(wrong)} are not finite numbers ({values}); set numbers"))
    return problems


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _existence_problems(mesh: CGCMesh) -> list[Problem]:
    """Check every piece: that it is held, whether it is closed, and, without creases, what its fixed edges allow."""
    keys = [v for v in mesh.vertices() if not mesh.is_dummy(v)]
    index = {key: i for i, key in enumerate(keys)}
    vertices, faces = mesh.arrays()
    piece = face_regions(faces, np.empty((0, 2), dtype=np.int64))
    creased = {index[v] for edge in mesh.crease_edges() for v in edge}
    loops = [[index[v] for v in loop] for loop in mesh.boundary_loops()]
    problems = []
    for p in range(piece.max() + 1):
        corners = faces[piece == p]
        own = set(np.unique(corners).tolist())
        if not any(mesh.vertex_role(keys[v]) == "fixed" for v in own):
            held = f"the piece of vertex {keys[min(own)]} has no support, nothing holds it; fix one of its vertices or remove it"
            problems.append(Problem(held))
            continue
        around = [loop for loop in loops if loop[0] in own]
        if not around:
            closed = "the mesh is closed; the only closed smooth surface of constant K is a sphere"
            problems.append(Problem(closed, fatal=False))
        targets = [mesh.vertex_target(keys[v]) for v in own if mesh.vertex_role(keys[v]) == "internal"]
        held = all(mesh.vertex_role(keys[v]) == "fixed" for loop in around for v in loop)
        if own & creased or not held or not targets or min(targets) <= 0:
            continue
        up = face_normals(vertices, corners).sum(axis=0)
        concave = [keys[v] for loop in around for v in np.array(loop)[_turns_inwards(vertices[loop], up)]]
        if concave:
            text = "where a surface of positive K needs a crease; lead creases to them if the solve fails"
            problems.append(Problem(f"the edge is concave at vertices {listed(np.array(concave))}, {text}", fatal=False))
        if len(around) == 1:
            problems += existence_problems(vertices, corners, np.array(around[0]), min(targets))
    return problems


def _turns_inwards(loop: FloatArray, up: FloatArray) -> np.ndarray:
    """Tell where a plane loop, with the surface to its left, turns right by more than 10 degrees (b,).

    The normal curvature along a plane edge would have to change its sign there, which
    it cannot with K > 0.
    """
    _, reach = plane_of(loop)
    if reach > 1e-6:
        return np.zeros(len(loop), bool)
    ahead = np.roll(loop, -1, axis=0) - loop
    behind = np.roll(ahead, 1, axis=0)
    left = np.cross(behind, ahead) @ (up / np.linalg.norm(up))
    return np.arctan2(left, np.einsum("ij,ij->i", behind, ahead)) < -np.radians(10)
