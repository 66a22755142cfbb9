"""Meshing of Rhino surfaces (NURBS, Breps, extrusions, SubD) to even meshes with creases at their joints."""

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
from ...meshing.kinks import KINK_ANGLE
from ...meshing.kinks import angles_between
from ...meshing.polyline import arc_lengths
from ...meshing.polyline import nearest_on_polyline
from ...meshing.polyline import point_at
from ...meshing.polyline import resample_all
from ...meshing.surface_mesh import FaceMesh
from ...meshing.surface_mesh import mesh_face
from ._types import Geometry
from .archive import Item
from .archive import box_around
from .archive import rhino3dm_module
from .archive import size_of
from .curves import LARGEST
from .curves import curve_points
from .parametric import ParametricSurface
from .sketch import Drawn
from .sketch import Part
from .user_text import user_law

__all__ = ["MeshedSurface", "default_edge_length", "rounded_length", "surface_part"]

EDGES = 30  # default number of edges along the diagonal of a surface
MAX_EDGES = 2000  # along the size of a surface
KINK = np.radians(20.0)  # turning angle of an edge above which it gets a vertex
SIDE_TOLERANCE = 0.05  # distance within which an edge follows a side of its surface, relative to the edge length
COINCIDENCE = 1e-3  # distance within which two points on an edge coincide, relative to the edge length
MAX_LEVELS = 5  # of subdivision
MAX_ATTEMPTS = 3  # each halves the edge length


class Meshed(NamedTuple):
    """Mesh of a surface as arrays."""

    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    joints: list[FloatArray]  # (k, 3) lines along sharp joints [L]
    deviation: float  # largest deviation [L]
    creases: list[FloatArray]  # (k, 3) mesh edges along drawn creases [L]; empty if they are not laid


class MeshedSurface(NamedTuple):
    """Mesh of a surface."""

    part: Part
    creases: list[Drawn]  # sharp joints of faces, and drawn creases if they are laid
    notes: list[str]
    laid: bool = False  # whether the mesh has edges along all drawn creases


def default_edge_length(items: Sequence[Item]) -> float:
    """Return the default edge length for surfaces [L]."""
    return rounded_length(box_around(item.geometry for item in items))


def rounded_length(points: FloatArray) -> float:
    """Return a rounded edge length for the extent of points (k, 3) [L]."""
    return float(f"{np.linalg.norm(np.ptp(points, axis=0)) / EDGES:.1g}")


def surface_part(item: Item, edge_length: float, tolerance: float, unit: str = "", creases: Sequence[Drawn] = ()) -> MeshedSurface:
    """Mesh a surface evenly.

    The edges of a Brep are divided first, so that adjacent faces share vertices. A SubD is subdivided and its vertices are moved
    to the limit surface.

    Parameters
    ----------
    item
        A Brep, an extrusion or a SubD.
    edge_length
        Intended edge length [L].
    tolerance
        Absolute tolerance of the file [L].
    unit
        Unit appended to lengths in the notes.
    creases
        Curves on the surface. If it has one face and they do not cross each other, mesh edges run along them.

    Raises
    ------
    FileError
        If it cannot be meshed; the message states what to do in Rhino.
    """
    rhino3dm = rhino3dm_module()

    geometry = item.geometry
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(True)
    elif isinstance(geometry, rhino3dm.Surface):
        geometry = rhino3dm.Brep.CreateFromSurface(geometry)
    _check_length(item, edge_length, unit)
    # Far from the origin, rounding makes smooth surfaces appear kinked.
    origin = box_around([geometry]).mean(axis=0)
    local = _moved(geometry, -origin)
    made, length = _attempted(item, local, edge_length, tolerance, [crease.points - origin for crease in creases])
    vertices, faces, deviation = made.vertices + origin, made.faces, made.deviation
    text = f"{item.label} was meshed with edges of about {length:g}{unit}, within {deviation:.2g}{unit} of the surface"
    if length < edge_length:
        text += f"; edges of {edge_length:g}{unit} would intersect"
    if made.joints:
        text += f"; {len(made.joints)} sharp joints became creases" if len(made.joints) > 1 else "; a sharp joint became a crease"
    drawn = [Drawn(f"a joint of {item.label}", "curve", line + origin, None, {}) for line in made.joints]
    drawn += [crease._replace(points=line + origin) for crease, line in zip(creases, made.creases)]
    law = user_law({**item.layer_text, **item.text})
    part = Part(item.label, vertices, np.column_stack([faces, faces[:, 2]]), 0.0, law, item.text)
    return MeshedSurface(part, drawn, [text], bool(made.creases))


def _moved(geometry: Geometry, by: FloatArray) -> Geometry:
    """Return a copy of a geometry, moved by a vector (3,) [L]."""
    rhino3dm = rhino3dm_module()
    copy = geometry.Duplicate()
    copy.Transform(rhino3dm.Transform.Translation(rhino3dm.Vector3d(*by.tolist())))
    return copy


def _check_length(item: Item, edge_length: float, unit: str) -> None:
    """Refuse an edge length that is probably in other units than the surface."""
    size = size_of(item.geometry)
    if not size < LARGEST:
        raise FileError(f"{item.label} is {size:.2g} large; its coordinates are damaged, so delete it or draw it again")
    if edge_length > size > 0.0:
        what = "is larger than it"
    elif size > MAX_EDGES * edge_length:
        what = f"would divide it more than {MAX_EDGES} times"
    else:
        return
    raise FileError(
        f"an edge length of {edge_length:g}{unit} {what}: {item.label} has a size of {size:.3g}{unit}; "
        "give the edge length in the unit of the drawing"
    )


def _attempted(item: Item, geometry: Geometry, edge_length: float, tolerance: float, creases: Sequence[FloatArray]) -> tuple[Meshed, float]:
    """Return the mesh of a surface and the edge length, which is halved while coarsely divided edges intersect."""
    reason = ""
    for attempt in range(MAX_ATTEMPTS):
        length = edge_length * 0.5**attempt
        try:
            return _meshed(geometry, length, tolerance, creases), length
        except MeshError as error:
            reason = str(error)
            if "install" in reason:
                break
    mend = "run Rhino's command Mesh on it, and put the mesh on the layer"
    raise FileError(f"{item.label} cannot be meshed ({reason}); {mend}")


def _meshed(geometry: Geometry, edge_length: float, tolerance: float, creases: Sequence[FloatArray]) -> Meshed:
    rhino3dm = rhino3dm_module()

    if isinstance(geometry, rhino3dm.SubD):
        return _subdivided(geometry, edge_length)
    if isinstance(geometry, rhino3dm.Brep) and len(geometry.Faces):
        return _faces_of_brep(geometry, edge_length, tolerance, creases)
    raise MeshError("it has no faces")


def _faces_of_brep(brep: Geometry, edge_length: float, tolerance: float, creases: Sequence[FloatArray]) -> Meshed:
    """Return the mesh of all faces, with edges along creases on a single face."""
    fine = min(max(0.25 * tolerance, 1e-6 * edge_length), 0.02 * edge_length)
    lines = [curve_points(brep.Edges[i], fine) for i in range(len(brep.Edges))]
    surfaces = [ParametricSurface(brep.Faces[i].UnderlyingSurface()) for i in range(len(brep.Faces))]
    stops = _crossings(brep, surfaces, lines, edge_length)
    drawn = _apart_creases(creases, surfaces[0], SIDE_TOLERANCE * edge_length) if len(surfaces) == 1 else []
    for crease in drawn:
        for end in crease[[0, -1]]:
            for i, line in enumerate(lines):
                gap, at = nearest_on_polyline(end[None], line)
                if gap[0] <= SIDE_TOLERANCE * edge_length:
                    stops.setdefault(i, []).append(float(at[0]))
    edges = [_divided(line, edge_length, stops.get(i, [])) for i, line in enumerate(lines)]
    rim = np.concatenate(edges)
    for crease in drawn:
        for k in (0, -1):
            gap, at = cKDTree(rim).query(crease[k])
            crease[k] = rim[at] if gap <= SIDE_TOLERANCE * edge_length else crease[k]
    drawn = [_divided(crease, edge_length, []) for crease in drawn]
    vertices, faces, count, deviation = [], [], 0, 0.0
    kinks: list[FloatArray] = []
    normals: dict[int, list[FloatArray]] = {}
    for face, surface in zip(brep.Faces, surfaces):
        made, ends = _face(face, surface, edges, edge_length, drawn)
        vertices.append(made.vertices)
        faces.append(made.faces + count)
        count += len(made.vertices)
        deviation = max(deviation, made.deviation)
        kinks.extend(made.kinks)
        for edge, normal in ends:
            normals.setdefault(edge, []).append(normal)
    sharp = [edge for edge, found in normals.items() if len(found) == 2 and angles_between(*found).max() > KINK_ANGLE]
    joints = [edges[edge] for edge in sorted(sharp)] + kinks[: len(kinks) - len(drawn)]
    return Meshed(np.concatenate(vertices), np.concatenate(faces), joints, deviation, kinks[len(kinks) - len(drawn) :])


def _apart_creases(creases: Sequence[FloatArray], surface: ParametricSurface, reach: float) -> list[FloatArray]:
    """Return copies of creases (k, 3) if all of them lie on a surface without kinks and do not meet, otherwise none."""
    import shapely

    if surface.kinks or any(len(crease) < 2 for crease in creases):
        return []
    # A few points show most curves off the surface at little cost.
    if not all(_on_surface(surface, crease[:: max(1, len(crease) // 8)], reach)[1] for crease in creases):
        return []
    pulled = [_on_surface(surface, crease, reach) for crease in creases]
    if not all(on for _, on in pulled):
        return []
    flat = [shapely.LineString(uv) for uv, _ in pulled]
    if any(not line.is_simple or line.is_ring for line in flat) or any(a.intersects(b) for k, a in enumerate(flat) for b in flat[:k]):
        return []
    return [np.array(crease) for crease in creases]


def _on_surface(surface: ParametricSurface, line: FloatArray, reach: float) -> tuple[FloatArray, bool]:
    """Return the parameters (k, 2) of points along a line, and whether all of them lie on a surface."""
    uv = surface.pulled_back(line, reach)
    return uv, bool(np.linalg.norm(surface.at(uv) - line, axis=1).max() <= reach)


def _crossings(
    brep: Geometry, surfaces: Sequence[ParametricSurface], lines: Sequence[FloatArray], edge_length: float
) -> dict[int, list[float]]:
    """Return the lengths [L] along each edge at which it crosses a kink of one of its surfaces."""
    found: dict[int, list[float]] = {}
    for face, surface in zip(brep.Faces, surfaces):
        loops = [face.Loops[k] for k in range(len(face.Loops))] if surface.kinks else []
        for trim in (trim for loop in loops for trim in _trims(loop)):
            line = resample_all(lines[trim.EdgeIndex], edge_length)
            met = np.array(surface.crossings(line[:: -1 if trim.IsReversed else 1], SIDE_TOLERANCE * edge_length))
            found.setdefault(trim.EdgeIndex, []).extend(arc_lengths(line)[-1] - met if trim.IsReversed else met)
    return found


def _trims(loop: Any) -> list[Any]:
    """Return the trims of a loop along edges, without singular trims at poles."""
    return [trim for trim in (loop.Trims[t] for t in range(loop.TrimCount)) if trim.EdgeIndex >= 0]


def _face(
    face: Any, surface: ParametricSurface, edges: Sequence[FloatArray], edge_length: float, creases: Sequence[FloatArray]
) -> tuple[FaceMesh, list[tuple[int, FloatArray]]]:
    """Return the mesh of a face, and its normals (k - 1, 3) between the points of every edge."""
    sense = -1.0 if face.OrientationIsReversed else 1.0
    loops, points, normals = [], [], []
    order = sorted(range(len(face.Loops)), key=lambda k: face.Loops[k].LoopType != rhino3dm_module().BrepLoopType.Outer)
    for k in order:
        own, places = [], []
        for trim in _trims(face.Loops[k]):
            line = edges[trim.EdgeIndex][::-1] if trim.IsReversed else edges[trim.EdgeIndex]
            uv = surface.pulled_back(line, SIDE_TOLERANCE * edge_length)
            own.append(uv)
            places.append(line)
            between = 0.5 * (uv[:-1] + uv[1:])
            found = sense * np.array([surface.normal(one) for one in between])
            normals.append((trim.EdgeIndex, found[::-1] if trim.IsReversed else found))
        if own:
            uv, place = _without_repeats(np.concatenate(own), np.concatenate(places), surface.domain)
            loops.append(uv)
            points.append(place)
    if not loops:
        raise MeshError("it has a face without edges")
    loops, _ = surface.snapped_to_kinks(loops, points)
    curves = [surface.pulled_back(crease, SIDE_TOLERANCE * edge_length) for crease in creases]
    rim, places = np.concatenate(loops), cKDTree(np.concatenate(points))
    for curve, crease in zip(curves, creases):
        for k in (0, -1):
            gap, at = places.query(crease[k])
            curve[k] = rim[at] if gap == 0.0 else curve[k]
    made = mesh_face(surface.at, loops, points, edge_length, surface.kinks, curves)
    if len(curves) and len(made.kinks) != len(curves):
        raise MeshError("its creases cannot be laid")
    return (made._replace(faces=made.faces[:, ::-1]) if sense < 0 else made), normals


def _without_repeats(uv: FloatArray, places: FloatArray, domain: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a loop without consecutive duplicates."""
    reach = 1e-6 * (domain[:, 1] - domain[:, 0])
    fresh = (np.abs(uv - np.roll(uv, 1, axis=0)) > reach).any(axis=1)
    return uv[fresh], places[fresh]


def _divided(line: FloatArray, edge_length: float, meets: Sequence[float]) -> FloatArray:
    """Return points spaced evenly along a curve between its ends, its kinks and the kinks of its surfaces.

    A closed curve is divided into at least three pieces.
    """
    at = arc_lengths(line)
    closed = bool((line[0] == line[-1]).all()) or np.linalg.norm(line[0] - line[-1]) <= 1e-9 * at[-1]
    ahead = np.diff(line, axis=0)
    turn = np.arctan2(np.linalg.norm(np.cross(ahead[:-1], ahead[1:]), axis=1), np.einsum("ij,ij->i", ahead[:-1], ahead[1:]))
    corners = at[np.concatenate([[0], np.flatnonzero(turn > KINK) + 1, [len(line) - 1]])]
    fresh = [t for t in sorted(meets) if np.abs(corners - t).min() > COINCIDENCE * edge_length]
    stops = np.sort(np.concatenate([corners, fresh]))
    stops = stops[np.append(True, np.diff(stops) > COINCIDENCE * edge_length)]
    least = (6 if float(at[-1]) < 3 * edge_length else 3) if closed and len(stops) == 2 else 1
    t = [at[0]]
    for first, last in zip(stops[:-1], stops[1:]):
        t.extend(np.linspace(first, last, max(least, round(float(last - first) / edge_length)) + 1)[1:])
    return point_at(line, np.array(t))


def _subdivided(subd: Geometry, edge_length: float) -> Meshed:
    """Return the mesh of the limit points of a SubD."""
    rhino3dm = rhino3dm_module()

    fine = subd.Duplicate()
    for _ in range(MAX_LEVELS):
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
    # Along edges of the new mesh, independent of the final positions of its vertices.
    ends = np.array([[_place(edge.Vertex(k).ControlNetPoint) for k in range(2)] for edge in sharp]).reshape(-1, 3)
    creases = list(V[cKDTree(net).query(ends)[1]].reshape(-1, 2, 3)) if len(net) == len(V) else []
    triangles = np.concatenate([F[:, :3], F[F[:, 2] != F[:, 3]][:, [0, 2, 3]]])
    sides = V[triangles]
    sagitta = np.linalg.norm(net - limit, axis=1).max(initial=0.0) if len(limit) == len(net) else np.linalg.norm(np.ptp(sides, axis=1))
    return Meshed(V, triangles, creases, float(sagitta), [])


def _place(point: Any) -> tuple[float, float, float]:
    return point.X, point.Y, point.Z


def _control_net(rhino3dm: Any, subd: Geometry) -> tuple[FloatArray, IntArray]:
    from .meshes import mesh_to_arrays

    mesh = rhino3dm.Mesh.CreateFromSubDControlNet(subd, False)
    if mesh is None or not len(mesh.Faces):
        raise MeshError("it has no faces")
    return mesh_to_arrays(mesh)
