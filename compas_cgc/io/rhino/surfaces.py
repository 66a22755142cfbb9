"""Surfaces of Rhino without a mesh (NURBS, Breps, extrusions, SubD) to even meshes with creases at their joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing.polyline import arc_lengths
from ...meshing.surface_mesh import FaceMesh
from ...meshing.surface_mesh import mesh_face
from ._types import Geometry
from .archive import Item
from .archive import rhino3dm_module
from .curves import curve_points
from .parametric import JOINT
from .parametric import ParametricSurface
from .parametric import angle_between
from .sketch import Drawn
from .sketch import Part
from .user_text import user_target

__all__ = ["MeshedSurface", "default_edge_length", "rounded_length", "surface_part"]

EDGES = 30  # along the diagonal of a surface, where no edge length is asked for
KINK = np.radians(20.0)  # turn of an edge from which it has a vertex there
LEVELS = 5  # of subdivision at most
ATTEMPTS = 3  # each with edges half as long


# Vertices (n, 3), triangles (m, 3), lines along sharp joints, and the largest deviation [L].
Meshed = tuple[FloatArray, IntArray, list[FloatArray], float]


class MeshedSurface(NamedTuple):
    """A mesh made of a surface."""

    part: Part
    creases: list[Drawn]  # joints of faces that meet at an angle
    notes: list[str]


def default_edge_length(items: Sequence[Item]) -> float:
    """Return an edge length for surfaces of this size [L]."""
    boxes = [item.geometry.GetBoundingBox() for item in items]
    low = np.min([(box.Min.X, box.Min.Y, box.Min.Z) for box in boxes], axis=0)
    high = np.max([(box.Max.X, box.Max.Y, box.Max.Z) for box in boxes], axis=0)
    return rounded_length(np.array([low, high]))


def rounded_length(points: FloatArray) -> float:
    """Return a round edge length for what is as large as points (k, 3) [L]."""
    return float(f"{np.linalg.norm(np.ptp(points, axis=0)) / EDGES:.1g}")


def surface_part(item: Item, edge_length: float, tolerance: float, unit: str = "") -> MeshedSurface:
    """Mesh a surface evenly.

    The edges of a Brep are divided first, so that faces meet in the same vertices. A SubD is subdivided and its vertices put
    where its limit surface has them.

    Parameters
    ----------
    item
        A Brep, an extrusion or a SubD.
    edge_length
        Length of edges aimed at [L].
    tolerance
        Absolute tolerance of the file [L].
    unit
        What lengths are followed by in the notes.

    Raises
    ------
    FileError
        If it cannot be meshed; the sentence says what to do in Rhino.
    """
    rhino3dm = rhino3dm_module()

    geometry = item.geometry
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(True)
    elif isinstance(geometry, rhino3dm.Surface):
        geometry = rhino3dm.Brep.CreateFromSurface(geometry)
    (vertices, faces, creases, deviation), length = _attempted(item, geometry, edge_length, tolerance)
    text = f"{item.label} was meshed with edges of about {length:g}{unit}, within {deviation:.2g}{unit} of the surface"
    if length < edge_length:
        text += f"; with {edge_length:g}{unit} its edges would cross"
    if creases:
        text += f"; {len(creases)} joint{'s' if len(creases) > 1 else ''} where it bends sharply became creases"
    drawn = [Drawn(f"a joint of {item.label}", "curve", line, None, {}) for line in creases]
    target = user_target({**item.layer_text, **item.text})
    return MeshedSurface(Part(item.label, vertices, np.column_stack([faces, faces[:, 2]]), 0.0, target, item.text), drawn, [text])


def _attempted(item: Item, geometry: Geometry, edge_length: float, tolerance: float) -> tuple[Meshed, float]:
    """Return the mesh of a surface, and the edge length: edges that touch when they are divided coarsely come apart when finely."""
    reason = ""
    for attempt in range(ATTEMPTS):
        length = edge_length * 0.5**attempt
        try:
            return _meshed(geometry, length, tolerance), length
        except MeshError as error:
            reason = str(error)
            if "install" in reason:
                break
    mend = "run Rhino's command Mesh on it, and put the mesh on the layer"
    raise FileError(f"{item.label} cannot be meshed ({reason}); {mend}")


def _meshed(geometry: Geometry, edge_length: float, tolerance: float) -> Meshed:
    rhino3dm = rhino3dm_module()

    if isinstance(geometry, rhino3dm.SubD):
        return _subdivided(geometry, edge_length)
    if isinstance(geometry, rhino3dm.Brep) and len(geometry.Faces):
        return _faces_of_brep(geometry, edge_length, tolerance)
    raise MeshError("it has no faces")


def _faces_of_brep(brep: Geometry, edge_length: float, tolerance: float) -> Meshed:
    """Return vertices, faces, sharp joints and the largest deviation."""
    fine = max(0.25 * tolerance, 1e-6 * edge_length)
    edges = [_divided(curve_points(brep.Edges[i], min(fine, 0.02 * edge_length)), edge_length) for i in range(len(brep.Edges))]
    vertices, faces, count, deviation = [], [], 0, 0.0
    kinks: list[FloatArray] = []
    normals: dict[int, list[FloatArray]] = {}
    for i in range(len(brep.Faces)):
        made, ends = _face(brep.Faces[i], brep, edges, edge_length)
        vertices.append(made.vertices)
        faces.append(made.faces + count)
        count += len(made.vertices)
        deviation = max(deviation, made.deviation)
        kinks.extend(made.kinks)
        for edge, normal in ends.items():
            normals.setdefault(edge, []).append(normal)
    sharp = [edge for edge, found in normals.items() if len(found) == 2 and angle_between(*found) > JOINT]
    return np.concatenate(vertices), np.concatenate(faces), [edges[edge] for edge in sorted(sharp)] + kinks, deviation


def _face(face: Any, brep: Geometry, edges: Sequence[FloatArray], edge_length: float) -> tuple[FaceMesh, dict[int, FloatArray]]:
    """Return the mesh of a face, and its normal half way along every edge."""
    surface = ParametricSurface(face.UnderlyingSurface())
    sense = -1.0 if face.OrientationIsReversed else 1.0
    loops, points, normals = [], [], {}
    order = sorted(range(len(face.Loops)), key=lambda k: face.Loops[k].LoopType != rhino3dm_module().BrepLoopType.Outer)
    for k in order:
        own, places = [], []
        for trim in (face.Loops[k].Trims[t] for t in range(face.Loops[k].TrimCount)):
            if trim.EdgeIndex < 0:  # a pole, where two corners of the parameters are one point
                continue
            line = edges[trim.EdgeIndex][::-1] if trim.IsReversed else edges[trim.EdgeIndex]
            uv = surface.pulled_back(line, 0.05 * edge_length)
            own.append(uv)
            places.append(line)
            normals[trim.EdgeIndex] = sense * surface.normal(uv[len(uv) // 2])
        if own:
            uv, place = _without_repeats(np.concatenate(own), np.concatenate(places), surface.domain)
            loops.append(uv)
            points.append(place)
    if not loops:
        raise MeshError("it has a face without edges")
    made = mesh_face(surface.at, *surface.snapped_to_kinks(loops, points), edge_length, surface.kinks)
    return (made._replace(faces=made.faces[:, ::-1]) if sense < 0 else made), normals


def _without_repeats(uv: FloatArray, places: FloatArray, domain: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a loop without parameters that follow themselves."""
    reach = 1e-6 * (domain[:, 1] - domain[:, 0])
    fresh = (np.abs(uv - np.roll(uv, 1, axis=0)) > reach).any(axis=1)
    return uv[fresh], places[fresh]


def _divided(line: FloatArray, edge_length: float) -> FloatArray:
    """Return points spread evenly along a curve between its kinks and ends; three pieces at least where it is closed."""
    at = arc_lengths(line)
    closed = bool((line[0] == line[-1]).all()) or np.linalg.norm(line[0] - line[-1]) <= 1e-9 * at[-1]
    ahead = np.diff(line, axis=0)
    turn = np.arctan2(np.linalg.norm(np.cross(ahead[:-1], ahead[1:]), axis=1), np.einsum("ij,ij->i", ahead[:-1], ahead[1:]))
    stops = np.concatenate([[0], np.flatnonzero(turn > KINK) + 1, [len(line) - 1]])
    least = (6 if float(at[-1]) < 3 * edge_length else 3) if closed and len(stops) == 2 else 1
    t = [at[0]]
    for first, last in zip(at[stops[:-1]], at[stops[1:]]):
        t.extend(np.linspace(first, last, max(least, round(float(last - first) / edge_length)) + 1)[1:])
    return np.column_stack([np.interp(t, at, line[:, k]) for k in range(3)])


def _subdivided(subd: Geometry, edge_length: float) -> Meshed:
    """Return the mesh of a SubD's limit points."""
    rhino3dm = rhino3dm_module()

    fine = subd.Duplicate()
    for _ in range(LEVELS):
        V, F = _control_net(rhino3dm, fine)
        longest = np.median(np.linalg.norm(V[F[:, 1]] - V[F[:, 0]], axis=1))
        if longest <= 1.5 * edge_length or not fine.Subdivide(1):
            break
    V, F = _control_net(rhino3dm, fine)
    sharp = [edge for edge in fine.Edges if edge.IsCrease and edge.FaceCount == 2]
    limit = np.array([(p.X, p.Y, p.Z) for p in (vertex.SurfacePoint for vertex in fine.Vertices)]).reshape(-1, 3)
    net = np.array([(p.X, p.Y, p.Z) for p in (vertex.ControlNetPoint for vertex in fine.Vertices)]).reshape(-1, 3)
    if len(limit) == len(V) and np.array_equal(net, V) and np.isfinite(limit).all():
        V = limit
    # Along edges of the mesh that is made, wherever its vertices have been put.
    ends = np.array([[_place(edge.Vertex(k).ControlNetPoint) for k in range(2)] for edge in sharp]).reshape(-1, 3)
    creases = list(V[cKDTree(net).query(ends)[1]].reshape(-1, 2, 3)) if len(net) == len(V) else []
    triangles = np.concatenate([F[:, :3], F[F[:, 2] != F[:, 3]][:, [0, 2, 3]]])
    sides = V[triangles]
    sagitta = np.linalg.norm(net - limit, axis=1).max(initial=0.0) if len(limit) == len(net) else np.linalg.norm(np.ptp(sides, axis=1))
    return V, triangles, creases, float(sagitta)


def _place(point: Any) -> tuple[float, float, float]:
    return point.X, point.Y, point.Z


def _control_net(rhino3dm: Any, subd: Geometry) -> tuple[FloatArray, IntArray]:
    from .meshes import mesh_to_arrays

    mesh = rhino3dm.Mesh.CreateFromSubDControlNet(subd, False)
    if mesh is None or not len(mesh.Faces):
        raise MeshError("it has no faces")
    return mesh_to_arrays(mesh)
