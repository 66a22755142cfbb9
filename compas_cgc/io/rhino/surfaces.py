"""Surfaces of Rhino without a mesh (NURBS, Breps, extrusions, SubD) to even meshes with creases at their joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import FileError
from ...errors import MeshError
from ...meshing.polyline import arc_lengths
from ...meshing.polyline import nearest_on_polyline
from ...meshing.surface_mesh import FaceMesh
from ...meshing.surface_mesh import mesh_face
from ._types import Geometry
from .archive import Item
from .archive import rhino3dm_module
from .curves import curve_points
from .sketch import Drawn
from .sketch import Part
from .user_text import user_target

__all__ = ["MeshedSurface", "default_edge_length", "rounded_length", "surface_part"]

EDGES = 30  # along the diagonal of a surface, where no edge length is asked for
JOINT = np.radians(10.0)  # angle between the normals of two faces from which their joint is a crease
KINK = np.radians(20.0)  # turn of an edge from which it has a vertex there
SNAP = 1e-3  # of the range of a parameter, within which a vertex of an edge is put on a kink
GRID = 16  # divisions of a surface in which the parameters of a point are looked for first
STEPS = 30  # of Newton's method towards them
LEVELS = 5  # of subdivision at most
ATTEMPTS = 3  # each with edges half as long
SIDE = 512  # divisions of a side of a domain, for the parameters of the points along it
SOUTH, EAST, NORTH, WEST = range(4)


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
    sharp = [edge for edge, found in normals.items() if len(found) == 2 and _angle_between(*found) > JOINT]
    return np.concatenate(vertices), np.concatenate(faces), [edges[edge] for edge in sorted(sharp)] + kinks, deviation


def _face(face: Any, brep: Geometry, edges: Sequence[FloatArray], edge_length: float) -> tuple[FaceMesh, dict[int, FloatArray]]:
    """Return the mesh of a face, and its normal half way along every edge."""
    surface = _Surface(face.UnderlyingSurface())
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


class _Surface:
    """A parametric surface: places, normals and the parameters of places."""

    def __init__(self, surface: Any):
        self._surface = surface
        self.domain = np.array([[surface.Domain(k).T0, surface.Domain(k).T1] for k in range(2)])
        self._grid: Optional[tuple[FloatArray, FloatArray]] = None
        self._sides = self._natural_sides()
        self.kinks = self._sharp_knots()

    def snapped_to_kinks(self, loops: Sequence[FloatArray], points: Sequence[FloatArray]) -> tuple[list[FloatArray], Sequence[FloatArray]]:
        """Return loops (k, 2) whose points that all but lie on a kink do."""
        snapped = [loop.copy() for loop in loops]
        for axis, value in self.kinks:
            for loop in snapped:
                near = np.abs(loop[:, axis] - value) <= SNAP * np.ptp(self.domain[axis])
                loop[near, axis] = value
        return snapped, points

    def _sharp_knots(self) -> list[tuple[int, float]]:
        """Return the knots of full multiplicity inside at which the normal turns: the parameter, 0 or 1, and its value."""
        # Other surfaces (planes, sums, revolutions of arcs) have parameters of their own, and are smooth or fall into faces.
        nurbs = self._surface.ToNurbsSurface()
        if nurbs is None or any(
            abs(nurbs.Domain(k).T0 - self.domain[k, 0]) + abs(nurbs.Domain(k).T1 - self.domain[k, 1]) > 0.0 for k in range(2)
        ):
            return []
        found = []
        for axis, knots, degree in ((0, nurbs.KnotsU, nurbs.Degree(0)), (1, nurbs.KnotsV, nurbs.Degree(1))):
            values, count = np.unique([knots[i] for i in range(len(knots))], return_counts=True)
            low, high = self.domain[axis]
            inside = (values > low) & (values < high) & (count >= degree)
            found += [(axis, float(value)) for value in values[inside] if self._turns_at(axis, float(value)) > JOINT]
        return found

    def _turns_at(self, axis: int, value: float) -> float:
        """Return the angle by which the normal turns across a line of constant parameter, at most [rad]."""
        low, high = self.domain[1 - axis]
        step = 1e-5 * float(np.ptp(self.domain[axis]))
        most = 0.0
        for other in np.linspace(low, high, 7)[1:-1]:
            normals = []
            for side in (-step, step):
                uv = np.empty(2)
                uv[axis], uv[1 - axis] = value + side, other
                normals.append(self.normal(uv))
            most = max(most, _angle_between(*normals))
        return most

    def at(self, parameters: FloatArray) -> FloatArray:
        """Return the places (k, 3) of parameters (k, 2), brought into the domain."""
        inside = np.clip(parameters, self.domain[:, 0], self.domain[:, 1])
        return np.array([(p.X, p.Y, p.Z) for p in map(self._surface.PointAt, *inside.T.tolist())]).reshape(-1, 3)

    def normal(self, parameters: FloatArray) -> FloatArray:
        """Return the normal (3,) at parameters (2,)."""
        normal = self._surface.NormalAt(*map(float, parameters))
        return np.array([normal.X, normal.Y, normal.Z])

    def pulled_back(self, line: FloatArray, reach: float) -> FloatArray:
        """Return the parameters (k, 2) of points along an edge, on a side of the domain where it runs along one."""
        for which, (values, points) in enumerate(self._sides):
            length = arc_lengths(points)
            if length[-1] <= reach:
                continue
            gap, t = nearest_on_polyline(line, points)
            # A side that winds a lot is not followed closely by its polyline.
            sagitta = 0.5 * np.linalg.norm(points[2:] + points[:-2] - 2 * points[1:-1], axis=1).max()
            if gap.max() > max(reach, sagitta):
                continue
            if np.linalg.norm(points[0] - points[-1]) <= 1e-6 * length[-1]:
                t = np.unwrap(t, period=length[-1])
            rising = t[len(t) // 2] > t[0] if len(t) > 2 else t[-1] > t[0]
            # Loops run anticlockwise, so that the two sides of a seam are told by the way it is passed.
            if rising != (which in (SOUTH, EAST)):
                continue
            t = t - length[-1] * np.floor((0.5 * (t.min() + t.max())) / length[-1])
            axis = 0 if which in (SOUTH, NORTH) else 1
            uv = np.empty((len(line), 2))
            uv[:, axis] = np.interp(t, length, values)
            uv[:, 1 - axis] = self.domain[1 - axis, 0 if which in (SOUTH, WEST) else 1]
            return uv
        return self._walked(line)

    def _natural_sides(self) -> list[tuple[FloatArray, FloatArray]]:
        """Return the parameters (k,) and places (k, 3) along the sides of the domain: south, east, north, west."""
        sides = []
        for which in (SOUTH, EAST, NORTH, WEST):
            axis = 0 if which in (SOUTH, NORTH) else 1
            values = np.linspace(self.domain[axis, 0], self.domain[axis, 1], SIDE + 1)
            uv = np.empty((SIDE + 1, 2))
            uv[:, axis], uv[:, 1 - axis] = values, self.domain[1 - axis, 0 if which in (SOUTH, WEST) else 1]
            sides.append((values, self.at(uv)))
        return sides

    def _walked(self, line: FloatArray) -> FloatArray:
        """Return the parameters (k, 2) of points along a curve, from its middle to both ends, each from the one before."""
        uv = np.empty((len(line), 2))
        middle = len(line) // 2
        uv[middle] = self._nearest(line[middle])
        for way in (1, -1):
            step = np.zeros(2)
            for i in range(middle + way, len(line) if way > 0 else -1, way):
                tried = [self._newton(line[i], uv[i - way] + own) for own in (step, np.zeros(2))]
                gaps = [float(np.linalg.norm(self.at(one[None])[0] - line[i])) for one in tried]
                uv[i] = tried[int(np.argmin(gaps))] if gaps[1] < 0.5 * gaps[0] else tried[0]
                step = uv[i] - uv[i - way]
        return uv

    def _nearest(self, point: FloatArray) -> FloatArray:
        if self._grid is None:
            axes = [np.linspace(low, high, GRID + 1) for low, high in self.domain]
            uv = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
            self._grid = uv, self.at(uv)
        uv, places = self._grid
        starts = uv[np.argsort(np.linalg.norm(places - point, axis=1), kind="stable")[:4]]
        found = [self._newton(point, start) for start in starts]
        return found[int(np.argmin([np.linalg.norm(self.at(one[None])[0] - point) for one in found]))]

    def _newton(self, point: FloatArray, start: FloatArray) -> FloatArray:
        """Return the parameters (2,) of the surface point nearest to a point, by Gauss and Newton with differences."""
        low, high = self.domain.T
        h = 1e-6 * (high - low)
        here = np.clip(start, low, high)
        for _ in range(STEPS):
            around = np.clip(here + np.array([[0, 0], [h[0], 0], [-h[0], 0], [0, h[1]], [0, -h[1]]]), low, high)
            spots = self.at(around)
            off = point - spots[0]
            steps = (around[1] - around[2])[0], (around[3] - around[4])[1]
            tangents = np.column_stack([(spots[1] - spots[2]) / steps[0], (spots[3] - spots[4]) / steps[1]])
            scaled = np.linalg.lstsq(tangents * (high - low), off, rcond=1e-8)[0]
            move = scaled / max(1.0, np.abs(scaled).max() / 0.2) * (high - low)
            before = np.linalg.norm(off)
            for share in (1.0, 0.5, 0.25, 0.1):
                new = np.clip(here + share * move, low, high)
                if np.linalg.norm(point - self.at(new[None])[0]) < before:
                    break
            else:
                break
            moved, here = np.abs(new - here), new
            if (moved <= 1e-10 * (high - low)).all():
                break
        return here


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


def _angle_between(one: FloatArray, other: FloatArray) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other))


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
