"""CGCMesh: a COMPAS mesh with supports, creases, regions, targets and goals."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from copy import deepcopy
from pathlib import Path
from typing import IO
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional
from typing import Union

import numpy as np
from compas.datastructures import Mesh
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..errors import find_attribute
from ..errors import names_what_was_meant
from ..meshing import Diagnostic
from ..meshing import boundary_loops
from ..meshing import crease_paths
from ..meshing import dummy_ring
from ..meshing import face_regions
from ..meshing import named_supports
from ..meshing import path_edges
from ..meshing import triangles_of
from ..meshing import triangulate
from ..model.checks import check
from ..model.checks import refuse
from ..model.constraint_data import as_goals
from ..model.constraint_data import constraint_data
from ..model.constraints import Constraint
from ..model.constraints import check_indices
from ..model.constraints import point_array
from ..model.given import checked_number
from ..model.given import no_region
from ..model.given import no_vertex
from ..model.given import plan_direction
from ..model.given import vertex_names
from ..model.given import vertex_paths
from ..model.laws import ConstantCurvature
from ..model.laws import Law
from ..model.laws import as_law
from ..model.problem import CGCProblem
from ..model.problem import Drawing
from ..model.problem import Names
from ..model.problem import Origin
from ..model.roles import ROLES
from .check import diagnostics_of_keys
from .compas_data import objects_of
from .construction import checked_faces
from .construction import evaluated
from .construction import meshed_outline
from .construction import said_of_the_mesh
from .drawn_shape import drawn_shape
from .drawn_shape import origin_from
from .joining import join
from .joining import weld
from .parts import drop_from_goals
from .parts import part_of
from .pluggables import mesh_from_3dm
from .pluggables import mesh_from_brep
from .pluggables import mesh_to_3dm
from .subdivision import subdivided
from .transformation import transform

__all__ = ["CGCMesh"]

DRAWING = ("units", "tolerance", "north")  # attributes of a mesh that describe its drawing


class CGCMesh(Mesh):
    """A triangle mesh with supports, creases, target curvatures and goals.

    Every vertex has a ``role``:

    ========  ==========================================================
    internal  movable, K is prescribed
    fixed     support, does not move
    crease    on an internal boundary: movable, no K prescribed
    free      on a free edge of the mesh: movable, no K prescribed
    dummy     outside the real mesh, never part of a result
    ========  ==========================================================

    and a ``target`` K̄ [1/L^2], used at internal vertices. Faces of regions with another law than
    constant K have it as their ``law``, see :meth:`set_law`. Along creases, ``s`` and ``e``
    override the settings of the flow. From a flat drawing, a surface of K > 0 rises to the
    side to which the face normals point; :meth:`flip` reverses them.

    Parameters
    ----------
    default_vertex_attributes
        Defaults of vertex attributes besides role, target, s and e.
    default_edge_attributes
        Defaults of edge attributes besides ``is_crease``.
    default_face_attributes
        Defaults of face attributes besides ``law``.
    name
        Name of the mesh.

    Examples
    --------
    >>> mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
    >>> mesh.set_supports("boundary")
    >>> mesh.set_target(0.01)
    >>> mesh.check()
    []
    """

    VERTEX_DEFAULTS = {"role": "internal", "target": None, "s": None, "e": None}
    EDGE_DEFAULTS = {"is_crease": False}
    FACE_DEFAULTS = {"law": None}
    origin: Optional[Origin] = None  # for the mesh of a result: the problem that its surface solves

    def __init__(
        self,
        default_vertex_attributes: Optional[dict] = None,
        default_edge_attributes: Optional[dict] = None,
        default_face_attributes: Optional[dict] = None,
        name: Optional[str] = None,
        **kwargs: object,
    ):
        super().__init__(
            default_vertex_attributes={**self.VERTEX_DEFAULTS, **(default_vertex_attributes or {})},
            default_edge_attributes={**self.EDGE_DEFAULTS, **(default_edge_attributes or {})},
            default_face_attributes={**self.FACE_DEFAULTS, **(default_face_attributes or {})},
            name=name,
            **kwargs,
        )

    @classmethod
    def from_json(cls, filepath: Union[str, os.PathLike, IO]) -> CGCMesh:
        """Construct a mesh from a COMPAS .json file, or an open one.

        Raises
        ------
        FileError
            If it names a type that is not read.
        TypeError
            If it holds no CGCMesh.
        """
        if isinstance(filepath, (str, os.PathLike)):
            return cls.from_jsonstring(Path(filepath).read_text(encoding="utf-8-sig"))
        return cls.from_jsonstring(filepath.read())

    @classmethod
    def from_jsonstring(cls, string: str) -> CGCMesh:
        """Construct a mesh from the text of a COMPAS .json file.

        Raises
        ------
        FileError
            If it names a type that is not read.
        TypeError
            If it holds no CGCMesh.
        """
        mesh = objects_of(json.loads(string), cls)
        if not isinstance(mesh, cls):
            raise TypeError(f"the data holds a {type(mesh).__name__}, not a {cls.__name__}")
        return mesh

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            return find_attribute(self, name, _as_a_function)

    def __str__(self) -> str:
        """Return a summary of the mesh, its supports, creases, goals and regions."""
        V = self.arrays()[0]
        size = " x ".join(f"{side:.4g}" for side in (np.ptp(V, axis=0) if len(V) else ()))
        regions = self.regions()
        lines = [
            f"CGCMesh {self.name!r}: {len(V)} vertices, {self.number_of_faces()} faces, {size or 'empty'}",
            f"  {len(self.supports())} supports, {len(self.creases())} creases, {len(self.goals())} goals",
        ]
        for number, faces in enumerate(regions[:12]):
            K, law = self.region_target(number), self._law_of(faces)
            asked = str(law) if law is not None else "no single K" if K is None else f"K = {K:g}"
            lines.append(f"  region {number}: {len(faces)} faces, {asked}")
        if len(regions) > 12:
            lines.append(f"  and {len(regions) - 12} more regions")
        return "\n".join(lines)

    # ------------------------------------------------------------------
    # Construction
    # ------------------------------------------------------------------

    @classmethod
    def from_vertices_and_faces(cls, vertices: Any, faces: Any) -> CGCMesh:
        """Return a mesh of vertices and faces; quads and n-gons are triangulated.

        Parameters
        ----------
        vertices
            ``(n, 3)`` coordinates [L], or a dict from keys to coordinates.
        faces
            Lists of three or more vertex keys, or a dict from keys to lists. The face keys are kept
            if no face has to be split.

        Raises
        ------
        MeshError
            If a face names a vertex that does not exist.
        """
        points, named = checked_faces(vertices, faces)
        where = points if isinstance(points, Mapping) else dict(enumerate(points))
        keys = list(named)
        triangles, owner = triangles_of(where, list(named.values()))
        whole = len(np.unique(owner)) == len(owner)
        names = [keys[k] for k in owner] if whole else range(len(triangles))
        mesh = super().from_vertices_and_faces(points, dict(zip(names, triangles.tolist())))
        dropped = np.setdiff1d(np.arange(len(keys)), owner)
        if len(dropped):
            # COMPAS drops such faces silently; check() reports them.
            mesh.attributes["dropped_faces"] = [[keys[k], named[keys[k]]] for k in dropped]
        mesh.update_roles()
        return mesh

    @classmethod
    def from_mesh(cls, mesh: Mesh) -> CGCMesh:
        """Return a mesh with the keys, attributes and name of a COMPAS mesh."""
        if isinstance(mesh, type) or not hasattr(mesh, "vertex_coordinates"):
            mend = "read a file with compas_cgc.read(path), or convert arrays with CGCMesh.from_vertices_and_faces(vertices, faces)"
            raise MeshError(f"from_mesh() takes a COMPAS mesh, not {mesh!r:.60}; {mend}")
        keys = list(mesh.vertices())
        result = cls.from_vertices_and_faces(
            {key: mesh.vertex_coordinates(key) for key in keys}, {face: mesh.face_vertices(face) for face in mesh.faces()}
        )
        for key in keys:
            own = {name: value for name, value in mesh.vertex[key].items() if value is not None}
            result.vertex[key].update(own)
        for face in result.faces():
            law = mesh.facedata.get(face, {}).get("law")
            if law is not None:
                result.facedata.setdefault(face, {})["law"] = law
        result.edgedata = {edge: dict(values) for edge, values in mesh.edgedata.items() if _has_edge(result, edge)}
        result.attributes.update({name: value for name, value in mesh.attributes.items() if name != "name"})
        if getattr(mesh, "_name", None) is not None:
            result.name = mesh.name
        result.update_roles()
        return result

    @classmethod
    @names_what_was_meant(said_of_the_mesh)
    def from_meshgrid(cls, dx: float, nx: int, dy: Optional[float] = None, ny: Optional[int] = None) -> CGCMesh:
        """Return a plane grid of nx by ny cells, each split along the same diagonal.

        Parameters
        ----------
        dx, dy
            Widths of the grid [L].
        nx, ny
            Numbers of cells.
        """
        for name, count in (("nx", nx), ("ny", ny)):
            if count is not None and (not isinstance(count, (int, np.integer)) or count < 1):
                raise ValueError(f"{name}, the number of cells, must be a whole number of at least 1, not {count!r}")
        for name, width in (("dx", dx), ("dy", dy)):
            if width is not None and checked_number(width, f"{name}, the width of the grid,") == 0.0:
                raise ValueError(f"{name}, the width of the grid, must not be 0")
        grid = Mesh.from_meshgrid(dx, nx, dy, ny)
        mesh = cls.from_mesh(grid)
        if sum(mesh.face_normal(next(iter(mesh.faces())))[2:]) < 0:
            mesh.flip()
        return mesh

    @classmethod
    def from_3dm(cls, path: Union[str, os.PathLike], **options: object) -> CGCMesh:
        """Read a mesh with supports, creases, targets and goals from a Rhino file, see :func:`compas_cgc.io.read_mesh`."""
        return mesh_from_3dm(path, **options)

    @classmethod
    @names_what_was_meant(said_of_the_mesh)
    def from_outline(
        cls,
        outline: ArrayLike,
        edge_length: float,
        holes: Iterable[ArrayLike] = (),
        creases: Iterable[ArrayLike] = (),
        points: Optional[ArrayLike] = None,
        tolerance: float = 1e-6,
    ) -> CGCMesh:
        """Return a mesh of near-equilateral triangles within an outline in plan, with creases.

        The mesh has a vertex at every kink, end and crossing of the curves and at every point; edges are shorter at small features.
        Heights follow the curves, with a thin-plate interpolation between them. Points above level curves count as column heads,
        which do not raise the mesh around them before a solve. Requires the extra ``mesher``.

        Parameters
        ----------
        outline
            ``(k, 3)`` points around the boundary, or ``(k, 2)`` in plan; the first may be repeated at the end [L].
        edge_length
            Target edge length [L].
        holes
            Outlines of holes, in the same form.
        creases
            ``(k, 3)`` points along each crease [L]; parts outside the outline are ignored.
        points
            ``(k, 3)`` points that become vertices, such as columns, or ``(k, 2)`` in plan [L].
        tolerance
            Distance below which two points coincide [L].

        Raises
        ------
        MeshError
            If the mesher is not installed, the curves do not enclose an area, or a point lies outside it.

        Examples
        --------
        >>> square = [[0, 0, 0], [6, 0, 0], [6, 6, 0], [0, 6, 0], [0, 0, 0]]
        >>> mesh = CGCMesh.from_outline(square, 1.0, creases=[[[3, -1, 0], [3, 7, 0]]], points=[[1.4, 1.6, 0]])
        >>> len(mesh.regions())
        2
        """
        made = meshed_outline(outline, edge_length, holes, creases, points, tolerance)
        mesh = cls.from_vertices_and_faces(made.vertices.tolist(), made.faces.tolist())
        mesh.set_creases(made.creases)
        return mesh

    @classmethod
    def from_surface(cls, surface: Any, edge_length: float) -> CGCMesh:
        """Return a mesh of near-equilateral triangles on a surface, with creases at its kinks. Requires the extra ``mesher``.

        Parameters
        ----------
        surface
            Untrimmed surface of COMPAS (``point_at``, ``domain_u``, ``domain_v``), rhino3dm or RhinoCommon (``PointAt``,
            ``Domain``), or a Brep, extrusion or SubD of rhino3dm.
        edge_length
            Target edge length [L].

        Raises
        ------
        MeshError
            If the mesher is not installed, or the surface has no area.
        """
        from ..meshing.surface_mesh import mesh_from_surface

        given = evaluated(surface)
        if given is None:
            return mesh_from_brep(surface, edge_length)
        made = mesh_from_surface(given.at, given.domain, edge_length, given.spans)
        mesh = cls.from_vertices_and_faces(made.vertices.tolist(), made.faces.tolist())
        mesh.set_creases(made.creases)
        return mesh

    def to_3dm(self, path: Union[str, os.PathLike], version: int = 7) -> None:
        """Write the mesh with supports, creases, targets and goals as a Rhino file that :meth:`from_3dm` reads.

        Parameters
        ----------
        path
            Path of the .3dm file; an existing file is replaced once the new one is complete.
        version
            Rhino version: 7 or 8.
        """
        mesh_to_3dm(self, path, version)

    def triangulate(self) -> None:
        """Split the faces with more than three corners."""
        points = {key: self.vertex_coordinates(key) for key in self.vertices()}
        for face in list(self.faces()):
            corners = self.face_vertices(face)
            if len(corners) > 3:
                self.delete_face(face)
                for triangle in triangulate(points, corners):
                    self.add_face(triangle)

    def flip(self) -> None:
        """Flip all faces, which reverses the normals."""
        self.flip_cycles()

    def unify(self) -> None:
        """Orient all faces like the first face of their connected piece."""
        self.unify_cycles()

    # ------------------------------------------------------------------
    # Arrays
    # ------------------------------------------------------------------

    def arrays(self, dummies: bool = False) -> tuple[FloatArray, IntArray]:
        """Return vertices (n, 3) and faces (m, 3) in the order of their keys in the mesh.

        Parameters
        ----------
        dummies
            Include the dummy mesh.
        """
        points = [(own["x"], own["y"], own["z"]) for own in self.vertex.values()]
        vertices = np.array(points, dtype=np.float64).reshape(-1, 3)
        faces = self._positions(np.array(list(self.face.values()), dtype=np.int64).reshape(-1, 3))
        dummy = np.zeros(len(points), bool) if dummies else np.array([self.is_dummy(key) for key in self.vertex], dtype=bool)
        if not dummy.any():
            return vertices, faces
        return vertices[~dummy], (np.cumsum(~dummy) - 1)[faces[~dummy[faces].any(axis=1)]]

    def to_problem(self) -> CGCProblem:
        """Return the mesh as a problem, including any dummy mesh, in the order of its vertices.

        Raises
        ------
        ProblemError
            If arrays cannot represent the mesh: non-finite coordinates, polygons, creases between deleted vertices.
        """
        refuse(diagnostics_of_keys(self))
        vertices, faces = self.arrays(dummies=True)
        names = Names(np.array(list(self.vertex), dtype=np.int64), np.array(list(self.face), dtype=np.int64))
        default = self.default_vertex_attributes.get("role")
        number = {role: i for i, role in enumerate(ROLES)}
        return CGCProblem(
            vertices,
            faces,
            np.array([number[own.get("role", default)] for own in self.vertex.values()], dtype=np.int64),
            targets=self._numbers("target"),
            s=self._numbers("s"),
            e=self._numbers("e"),
            creases=self._positions(np.array(self.crease_edges(), dtype=np.int64).reshape(-1, 2)),
            goals=self.goals(),
            laws=self._laws(),
            names=names,
            drawing=self._drawing(),
            origin=self.origin,
        )

    @classmethod
    def from_problem(cls, problem: CGCProblem) -> CGCMesh:
        """Return the mesh of a problem, with the keys in its `names`."""
        keys = problem.names.vertices.tolist()
        faces = problem.names.vertices[problem.faces].tolist()
        mesh = Mesh.from_vertices_and_faces.__func__(
            cls, dict(zip(keys, problem.vertices.tolist())), dict(zip(problem.names.faces.tolist(), faces))
        )
        columns = (problem.roles, problem.targets, problem.s, problem.e)
        for key, role, target, s, e in zip(keys, *(column.tolist() for column in columns)):
            values = {"target": target, "s": s, "e": e if e != e else int(e)}
            mesh.vertex[key].update(role=ROLES[role], **{name: value for name, value in values.items() if value == value})
        for edge in problem.names.vertices[problem.creases].tolist():
            mesh.edge_attribute(tuple(edge), "is_crease", True)
        mesh.name = problem.drawing.name
        known, usual = problem.drawing._asdict(), Drawing()._asdict()
        mesh.attributes.update({name: known[name] for name in DRAWING if known[name] != usual[name]})
        mesh.set_goals(problem.goals)
        mesh._set_laws(problem.laws)
        mesh.origin = problem.origin
        return mesh

    def _drawing(self) -> Drawing:
        """Return the metadata of the drawing from the attributes of the mesh."""
        known = {name: self.attributes[name] for name in DRAWING if name in self.attributes}
        if "north" in known:
            known["north"] = plan_direction(known["north"], "the direction of north")
        return Drawing(self.name or "mesh", **known)

    def _numbers(self, name: str) -> FloatArray:
        default = self.default_vertex_attributes.get(name)
        values = (own.get(name, default) for own in self.vertex.values())
        return np.fromiter((np.nan if value is None else value for value in values), np.float64, len(self.vertex))

    def _positions(self, keys: IntArray) -> IntArray:
        """Return the indices of vertex keys in the order of the mesh."""
        known = np.array(list(self.vertex), dtype=np.int64)
        if np.array_equal(known, np.arange(len(known))):
            return keys
        order = np.argsort(known)
        return order[np.searchsorted(known, keys, sorter=order)]

    def copy(self, cls: Optional[type] = None, copy_guid: bool = False) -> Any:
        """Return an independent copy."""
        mesh = super().copy(cls, copy_guid)
        if isinstance(mesh, CGCMesh):
            mesh.origin = self.origin
        return mesh

    @property
    def __data__(self) -> dict:
        drawn = drawn_shape(self)
        return {**super().__data__, **({} if drawn is None else {"drawn": drawn})}

    @classmethod
    def __from_data__(cls, data: dict) -> CGCMesh:
        mesh = super().__from_data__(data)
        mesh.origin = origin_from(mesh, data.get("drawn"))
        return mesh

    # ------------------------------------------------------------------
    # Operations of COMPAS meshes
    # ------------------------------------------------------------------

    def transform(self, T: Any) -> None:
        """Transform the mesh in place; targets [1/L^2], goals, tolerance and the drawn shape of a result follow.

        A reflection reverses the faces, so that the surface keeps its side.

        Parameters
        ----------
        T
            COMPAS transformation or a ``(4, 4)`` matrix: translation, rotation, reflection, uniform scaling, or a product of
            these. A mesh without targets and goals takes any transformation.

        Raises
        ------
        ValueError
            If a target or a goal cannot follow the transformation; the mesh is unchanged.

        Examples
        --------
        >>> mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
        >>> mesh.set_target(0.01)
        >>> mesh.scale(10)
        >>> mesh.region_target(0)
        0.0001
        """
        transform(self, T)

    def transform_numpy(self, T: Any) -> None:
        """Transform the mesh in place, see :meth:`transform`."""
        transform(self, T)

    def join(self, other: Mesh, weld: bool = False, precision: Optional[int] = None) -> None:
        """Add another mesh, with its supports, creases, targets and goals.

        The regions of `other` follow those of this mesh. Words such as "all" in a goal become the vertices or regions of its own
        mesh; a goal for the whole surface, such as a rise, applies to the joined surface.

        Parameters
        ----------
        other
            The other mesh.
        weld
            Merge coincident vertices, see :meth:`weld`.
        precision
            Number of decimals of coordinates that count as coincident. Default: that of COMPAS.

        Raises
        ------
        ValueError
            If the meshes differ in their units or in a goal for the whole surface; this mesh is unchanged.

        Examples
        --------
        >>> mesh, other = CGCMesh.from_meshgrid(dx=2, nx=2), CGCMesh.from_meshgrid(dx=2, nx=2)
        >>> other.set_creases([[3, 4, 5]])
        >>> other.translate([2, 0, 0])
        >>> mesh.join(other, weld=True)
        >>> mesh.number_of_vertices(), len(mesh.regions())
        (15, 2)
        """
        join(self, other)
        if weld:
            self.weld(precision)

    def weld(self, precision: Optional[int] = None) -> None:
        """Merge coincident vertices; a seam between regions of different targets becomes a crease.

        Parameters
        ----------
        precision
            Number of decimals of coordinates that count as coincident. Default: that of COMPAS.
        """
        weld(self, precision)

    def remove_duplicate_vertices(self, precision: Optional[int] = None) -> None:
        """Merge coincident vertices, see :meth:`weld`."""
        weld(self, precision)

    def subdivided(self, scheme: str = "catmullclark", k: int = 1, **options: Any) -> CGCMesh:
        """Return a finer mesh of triangles with the same supports, creases, regions, targets and goals.

        A new vertex on an edge is a support, or subject to a goal, if both ends of the edge are.

        Parameters
        ----------
        scheme
            ``catmullclark`` or ``loop``, which smooth the mesh between the supports; ``corner``, which splits every triangle
            into four; ``quad`` or ``tri``.
        k
            Number of times.
        options
            Options of the scheme in COMPAS.

        Raises
        ------
        ValueError
            If the scheme does not keep creases.

        Examples
        --------
        >>> mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
        >>> mesh.set_creases([[10, 11, 12, 13, 14]])
        >>> fine = mesh.subdivided("corner")
        >>> fine.number_of_faces(), len(fine.regions()), len(fine.creases()[0])
        (128, 2, 9)
        """
        return subdivided(self, scheme, k, **options)

    subdivide = subdivided

    def exploded(self) -> list[CGCMesh]:
        """Return the connected pieces of the mesh, with their keys, supports, creases, targets and goals."""
        return [part_of(self, keys) for keys in self.connected_vertices()]

    def delete_vertex(self, key: int) -> None:
        """Delete a vertex and its faces; goals no longer name it."""
        drop_from_goals(self, {key})
        super().delete_vertex(key)

    def remove_unused_vertices(self) -> None:
        """Delete the vertices without faces; goals no longer name them."""
        drop_from_goals(self, {key for key in self.vertices() if not self.halfedge.get(key)})
        super().remove_unused_vertices()

    cull_vertices = remove_unused_vertices

    def with_coordinates(self, vertices: FloatArray) -> CGCMesh:
        """Return a copy without dummies and with the coordinates `vertices` (n, 3) [L]."""
        mesh = self.without_dummies()
        for key, (x, y, z) in zip(list(mesh.vertices()), np.asarray(vertices, dtype=np.float64).tolist()):
            mesh.vertex[key].update(x=x, y=y, z=z)
        return mesh

    # ------------------------------------------------------------------
    # Roles
    # ------------------------------------------------------------------

    def vertex_role(self, key: int, role: Optional[str] = None) -> Optional[str]:
        """Get or set the role of a vertex."""
        if role is None:
            return self.vertex_attribute(self._known(key), "role")
        if role not in ROLES:
            raise ValueError(f"role must be one of {', '.join(ROLES)}, not {role!r}")
        self.vertex_attribute(key, "role", role)
        return None

    def vertices_role(self, keys: Optional[Iterable[int]] = None) -> list[str]:
        """Return the roles of some or all vertices."""
        return [self.vertex_attribute(key, "role") for key in (self.vertices() if keys is None else keys)]

    def vertices_where_role(self, role: str) -> list[int]:
        """Return the vertices with a role."""
        return [key for key in self.vertices() if self.vertex_role(key) == role]

    def is_dummy(self, key: int) -> bool:
        """Check whether a vertex belongs to the dummy mesh."""
        return self.vertex[key].get("role") == "dummy"

    def supports(self) -> list[int]:
        """Return the fixed vertices."""
        return self.vertices_where_role("fixed")

    def set_supports(self, vertices: Union[str, Iterable[int]], add: bool = False) -> None:
        """Make vertices supports.

        Parameters
        ----------
        vertices
            Vertex keys, ``"boundary"`` for all boundary vertices, ``"outline"`` for those of the outer boundary without holes,
            or ``"corners"`` for boundary vertices where the boundary turns by more than 30 degrees.
        add
            Keep the present supports.
        """
        if isinstance(vertices, str):
            keys = self._real_keys()
            chosen = [keys[v] for v in named_supports(*self.arrays(), vertices)]
            if not chosen and self.vertex and not self.face:
                raise ValueError(f"the mesh has no faces and so no {vertices}; add faces of three or more different vertices")
            if not chosen and self.vertex and not self.boundary_loops():
                raise ValueError(f"the mesh is closed and has no {vertices}; name the support vertices: mesh.set_supports([...])")
        else:
            chosen = vertex_names(vertices, "supports")
            lost = [key for key in chosen if key not in self.vertex]
            if lost:
                raise ValueError(no_vertex(lost, self.vertices()))
        keep = set(self.supports()) if add else set()
        for key in self.supports():
            self.vertex_role(key, "internal")
        for key in keep.union(chosen):
            self.vertex_role(key, "fixed")
        self.update_roles()

    def vertices_near(self, points: ArrayLike) -> list[int]:
        """Return the nearest vertex to each point.

        Parameters
        ----------
        points
            ``(k, 3)`` points [L], or ``(k, 2)`` points in plan.

        Returns
        -------
        list of int
            Vertex keys, one per point.

        Examples
        --------
        >>> mesh = CGCMesh.from_meshgrid(dx=10, nx=5)
        >>> mesh.set_supports(mesh.vertices_near([[0, 0], [10, 0], [5, 10]]))
        >>> len(mesh.supports())
        3
        """
        places = point_array(points, "points")
        if places.ndim != 2 or places.shape[1] not in (2, 3):
            raise ValueError(f"points must be a list of points with two or three coordinates, not an array of shape {places.shape}")
        keys = np.array(self._real_keys(), dtype=np.int64)
        width = places.shape[1]
        return keys[cKDTree(self.arrays()[0][:, :width]).query(places)[1]].tolist()

    def boundary_loops(self) -> list[list[int]]:
        """Return the boundary loops of the real mesh as vertex keys, the longest first."""
        keys = self._real_keys()
        return [[keys[v] for v in loop] for loop in boundary_loops(self.arrays()[1])]

    def _real_keys(self) -> list[int]:
        return [key for key in self.vertices() if not self.is_dummy(key)]

    def update_roles(self) -> None:
        """Set the role of every vertex that is neither fixed nor dummy: crease, free or internal.

        ``set_supports``, ``set_creases`` and ``add_dummy_ring`` call this; call it after
        changing the mesh by hand.
        """
        on_crease = {v for edge in self.crease_edges() for v in edge}
        for key in self.vertices():
            if self.vertex[key].get("role") not in ("fixed", "dummy"):
                role = "crease" if key in on_crease else "free" if None in self.halfedge[key].values() else "internal"
                self.vertex[key]["role"] = role

    # ------------------------------------------------------------------
    # Creases and regions
    # ------------------------------------------------------------------

    def set_creases(self, creases: Iterable[Sequence[int]], add: bool = False) -> None:
        """Make edges creases, along which the surface may fold.

        Parameters
        ----------
        creases
            Edges ``(u, v)`` or paths of vertices ``[u, v, w, ...]``.
        add
            Keep the present creases.

        Raises
        ------
        ValueError
            If two consecutive vertices are not joined by an edge.
        """
        edges = path_edges([[self._known(key) for key in path] for path in vertex_paths(creases)])
        for u, v in edges:
            if v not in self.halfedge[u] and u not in self.halfedge[v]:
                raise ValueError(f"the crease from vertex {u} to {v} does not follow an edge of the mesh; define creases along edges")
        if not add:
            for edge in self.crease_edges():
                self.unset_edge_attribute(edge, "is_crease")
        for edge in edges:
            self.edge_attribute(edge, "is_crease", True)
        self.update_roles()

    def crease_edges(self) -> list[tuple[int, int]]:
        """Return the crease edges as pairs of vertex keys."""
        edges = (_edge_ends(name) for name, values in self.edgedata.items() if values.get("is_crease"))
        return sorted((u, v) for u, v in edges if u in self.vertex and v in self.vertex)

    def creases(self) -> list[list[int]]:
        """Return the creases as paths of vertex keys between ends and junctions, in a stable order."""
        return crease_paths(self.crease_edges())

    def regions(self) -> list[list[int]]:
        """Return the face keys of every region; regions are ordered by their first face."""
        faces = [f for f, corners in self.face.items() if not any(self.is_dummy(v) for v in corners)]
        if not faces:
            return []
        corners = self._positions(np.array([self.face[f][:3] for f in faces], dtype=np.int64))
        edges = self._positions(np.array(self.crease_edges(), dtype=np.int64).reshape(-1, 2))
        labels = face_regions(corners, edges)
        regions: list[list[int]] = [[] for _ in range(labels.max() + 1)]
        for face, label in zip(faces, labels.tolist()):
            regions[label].append(face)
        return regions

    def region_vertices(self, region: int) -> list[int]:
        """Return the vertices of a region that are not on creases."""
        regions = self.regions()
        if isinstance(region, bool) or not isinstance(region, (int, np.integer)) or not 0 <= region < len(regions):
            raise ValueError(no_region(region, len(regions), bool(self.crease_edges())))
        keys = dict.fromkeys(v for f in regions[region] for v in self.face[f])
        return [v for v in keys if self.vertex_role(v) != "crease"]

    # ------------------------------------------------------------------
    # Targets and strategies
    # ------------------------------------------------------------------

    def set_target(self, K: float, region: Optional[int] = None, vertices: Optional[Iterable[int]] = None) -> None:
        """Set the target Gaussian curvature everywhere, in a region or at vertices.

        Parameters
        ----------
        K
            Target curvature [1/L^2].
        region
            Number of a region, see :meth:`regions`.
        vertices
            Vertex keys.
        """
        given: Any = K
        if isinstance(given, (Mapping, Sequence, np.ndarray)) and not isinstance(given, str):
            raise ValueError(f"the target must be one number, not {K!r:.60}; call set_target(K, region=r) for every region")
        value = _number(K, "the target")
        if region is not None and vertices is not None:
            raise ValueError("give a region or vertices for the target, not both")
        laws = self._laws() if vertices is None else {}
        self._set_laws({number: None for number in laws if region in (None, number)})
        if region is not None:
            keys: Iterable[int] = self.region_vertices(region)
        else:
            keys = self.vertices() if vertices is None else [self._known(key) for key in vertex_names(vertices, "vertices")]
        self.vertices_attribute("target", value, keys=list(keys))

    def set_law(self, law: Union[Law, str, float], region: Optional[int] = None) -> None:
        """Set the law of the mean curvature H and the Gaussian curvature K everywhere or in a region.

        Parameters
        ----------
        law
            A value such as ``ConstantMeanCurvature(0.1)``, or a text such as ``minimal``, ``H = 0.1`` or ``2 H + 0.5 K = 0.3``.
            :class:`ConstantCurvature` sets the target.
        region
            Number of a region, see :meth:`regions`.

        Examples
        --------
        >>> mesh = CGCMesh.from_meshgrid(dx=9, nx=9)
        >>> mesh.set_law("H = 0.1")
        >>> mesh.region_law(0)
        ConstantMeanCurvature(h=0.1)
        """
        own = as_law(law)
        if isinstance(own, ConstantCurvature):
            self.set_target(float(own.k), region)
            return
        numbers = range(len(self.regions())) if region is None else [region]
        for number in numbers:
            for key in self.region_vertices(number):
                self.vertex[key]["target"] = None
        self._set_laws(dict.fromkeys(numbers, own))

    def region_law(self, region: int) -> Optional[Law]:
        """Return the law of a region, None if it has none and not one target."""
        K = self.region_target(region)
        return self._law_of(self.regions()[region]) or (None if K is None else ConstantCurvature(K))

    def _law_of(self, faces: Iterable[int]) -> Optional[Law]:
        texts = {self.face_attribute(face, "law") for face in faces} - {None}
        return as_law(texts.pop()) if len(texts) == 1 else None

    def _laws(self) -> dict[int, Law]:
        """Return the laws of the regions that have one other than constant K."""
        if not any(values.get("law") for values in self.facedata.values()):
            return {}
        laws = {number: self._law_of(faces) for number, faces in enumerate(self.regions())}
        return {number: law for number, law in laws.items() if law is not None}

    def _set_laws(self, laws: Mapping[int, Optional[Law]]) -> None:
        """Set or remove (None) the laws of regions."""
        regions = self.regions() if laws else []
        for number, law in laws.items():
            for face in regions[number]:
                self.facedata.setdefault(face, {})["law"] = None if law is None else str(law)

    def vertex_target(self, key: int, K: Optional[float] = None) -> Optional[float]:
        """Get or set the target of a vertex [1/L^2]."""
        if K is None:
            return self.vertex_attribute(self._known(key), "target")
        self.vertex_attribute(self._known(key), "target", _number(K, "the target"))
        return None

    def vertices_target(self, keys: Optional[Iterable[int]] = None) -> list[Optional[float]]:
        """Return the targets of some or all vertices [1/L^2]."""
        return [self.vertex_target(key) for key in (self.vertices() if keys is None else keys)]

    def region_target(self, region: int) -> Optional[float]:
        """Return the target of a region [1/L^2], None if it is not one number."""
        keys = self.region_vertices(region)
        values = {self.vertex_target(v) for v in keys if self.vertex_role(v) == "internal"} or {self.vertex_target(v) for v in keys}
        return values.pop() if len(values) == 1 else None

    def set_strategy(
        self,
        s: Optional[float] = None,
        e: Optional[int] = None,
        crease: Optional[int] = None,
        vertices: Optional[Iterable[int]] = None,
    ) -> None:
        """Override the strategies S1 (factor s) and S2 (delay e) of the settings along creases.

        Parameters
        ----------
        s
            Factor on displacements, 0 <= s <= 1.
        e
            Number of first steps in which the vertices do not move.
        crease
            Number of a crease, see :meth:`creases`; default: all of them.
        vertices
            Keys of vertices.
        """
        if s is not None and not 0 <= _number(s, "s") <= 1:
            raise ValueError(f"s must be between 0 and 1, not {s!r}")
        if e is not None and (int(_number(e, "e")) != e or e < 0):
            raise ValueError(f"e must be a whole number of at least 0, not {e!r}")
        paths = self.creases()
        if vertices is None and not paths:
            raise ValueError("the mesh has no crease to set a strategy for; set creases first (mesh.set_creases)")
        if vertices is not None:
            keys = [self._known(key) for key in vertex_names(vertices, "vertices")]
        elif crease is None:
            keys = [v for path in paths for v in path]
        elif crease in range(len(paths)):
            keys = paths[crease]
        else:
            raise ValueError(f"there is no crease {crease!r}; the mesh has creases 0 to {len(paths) - 1}")
        for key in keys:
            if s is not None:
                self.vertex_attribute(key, "s", float(s))
            if e is not None:
                self.vertex_attribute(key, "e", int(e))

    def vertex_s(self, key: int, s: Optional[float] = None) -> Optional[float]:
        """Get or set the factor s of a crease vertex; None means the value in the settings."""
        if s is None:
            return self.vertex_attribute(key, "s")
        self.set_strategy(s=s, vertices=[key])
        return None

    def vertex_e(self, key: int, e: Optional[int] = None) -> Optional[int]:
        """Get or set the delay e of a crease vertex; None means the value in the settings."""
        if e is None:
            return self.vertex_attribute(key, "e")
        self.set_strategy(e=e, vertices=[key])
        return None

    # ------------------------------------------------------------------
    # Constraints
    # ------------------------------------------------------------------

    def goals(self) -> tuple[Constraint, ...]:
        """Return the goals; they refer to vertices by index in the order of :meth:`vertices`."""
        return as_goals(self.attributes.get("goals"))

    def set_goals(self, goals: Iterable[Union[Constraint, Mapping]], add: bool = False) -> None:
        """Set the goals.

        Parameters
        ----------
        goals
            Goals such as :class:`Height`, or their plain data; they refer to vertices by index in the order of :meth:`vertices`.
        add
            Keep the present goals.
        """
        kept = self.goals() if add else ()
        data = [constraint_data(constraint) for constraint in (*kept, *as_goals(goals))]
        check_indices(as_goals(data), self.number_of_vertices())
        self.attributes.pop("goals", None)
        if data:
            self.attributes["goals"] = data

    # ------------------------------------------------------------------
    # Dummy mesh
    # ------------------------------------------------------------------

    def add_dummy_ring(self) -> list[int]:
        """Add a ring of dummy faces along the boundary, so that K can be prescribed on free edges.

        Returns
        -------
        list of int
            The dummy vertices.
        """
        vertices, faces = self.arrays(dummies=True)
        keys = list(self.vertices())
        points, corners, _ = dummy_ring(vertices, faces, np.ones(len(keys), bool))
        added = [self.add_vertex(x=x, y=y, z=z, role="dummy") for x, y, z in points[len(keys) :].tolist()]
        names = keys + added
        for face in corners[len(faces) :].tolist():
            self.add_face([names[v] for v in face])
        self.update_roles()
        return added

    def without_dummies(self) -> CGCMesh:
        """Return a copy without the dummy mesh; its free edges get the role free again."""
        mesh = self._duplicate()
        dummies = [v for v in mesh.vertices() if mesh.is_dummy(v)]
        if dummies:
            drop_from_goals(mesh, set(dummies))
            for key in dummies:
                Mesh.delete_vertex(mesh, key)
            mesh.update_roles()
        return mesh

    def _duplicate(self) -> CGCMesh:
        """Return a copy; ten times faster than serialisation through the COMPAS data."""
        mesh = type(self)(self.default_vertex_attributes, self.default_edge_attributes, self.default_face_attributes)
        mesh._name = self._name
        mesh.attributes = deepcopy(self.attributes)
        mesh._max_vertex, mesh._max_face = self._max_vertex, self._max_face
        mesh.halfedge = {u: dict(others) for u, others in self.halfedge.items()}
        mesh.face = {face: list(corners) for face, corners in self.face.items()}
        for name in ("vertex", "facedata", "edgedata"):
            setattr(mesh, name, {key: _copied(values) for key, values in getattr(self, name).items()})
        return mesh

    # ------------------------------------------------------------------
    # Check
    # ------------------------------------------------------------------

    def check(self) -> list[Diagnostic]:
        """Return everything that prevents a solve or may surprise, see :func:`compas_cgc.check`.

        Returns
        -------
        list of Diagnostic
            Sentences; a solve refuses a mesh with a ``fatal`` one, with the same text.
        """
        return check(self)

    def _known(self, key: int) -> int:
        if key not in self.vertex:
            raise ValueError(no_vertex([key], self.vertices()))
        return int(key)


def _as_a_function(name: str) -> str:
    """Return the function to call instead of a method that does not exist."""
    if name in ("solve", "analyse", "sensitivity"):
        return f"use the function compas_cgc.{name}(mesh)"
    if name in ("write", "save", "to_file"):
        return 'use the function compas_cgc.write("roof.3dm", mesh)'
    return ""


def _copied(values: dict) -> dict:
    return {name: value if isinstance(value, (str, int, float, type(None))) else deepcopy(value) for name, value in values.items()}


def _number(value: Any, what: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be a number, not {value!r}") from None
    if not math.isfinite(number):
        raise ValueError(f"{what} must be a finite number, not {value!r}")
    return number


def _edge_ends(name: str) -> tuple[int, int]:
    u, v = name.strip("()").split(",")
    return int(u), int(v)


def _has_edge(mesh: Mesh, name: str) -> bool:
    u, v = _edge_ends(name)
    return u in mesh.halfedge and (v in mesh.halfedge[u] or u in mesh.halfedge.get(v, {}))
