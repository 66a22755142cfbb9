"""The problem: a mesh as arrays, with all that is asked of it."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field
from dataclasses import replace
from typing import NamedTuple
from typing import Optional
from typing import Protocol
from typing import Union

import numpy as np
from numpy.typing import ArrayLike
from numpy.typing import NDArray

from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete import mesh_arrays
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing import crease_paths
from ..meshing import face_means
from ..meshing import face_regions
from ..meshing import lost_edges
from ..meshing import named_supports
from ..meshing import path_edges
from .constraint_data import as_constraints
from .constraints import Constraint
from .constraints import check_indices
from .frame import Frame
from .frame import local_frame
from .given import no_region
from .given import no_vertex
from .given import vertex_names
from .given import vertex_paths
from .given import wrong_problem
from .roles import CREASE
from .roles import DUMMY
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL
from .roles import role_numbers
from .roles import roles_by_place

__all__ = ["CGCProblem", "Drawing", "Names", "Origin", "PosesProblem", "problem_of"]

Targets = Union[float, ArrayLike, Mapping[int, float]]


class Names(NamedTuple):
    """What the user calls vertices and faces."""

    vertices: IntArray  # (n,)
    faces: IntArray  # (m,)


class Drawing(NamedTuple):
    """The drawing that a mesh comes from."""

    name: str = "mesh"
    units: Optional[str] = None  # unit system such as ``Meters``
    tolerance: Optional[float] = None  # distance within which points are one [L]
    places: tuple[tuple[str, Sequence[Sequence[float]]], ...] = ()  # closed lines in plan by name [L]


class Origin(NamedTuple):
    """What a surface was found for."""

    drawn: CGCProblem  # as it was drawn, with its targets
    vertices: FloatArray  # (n, 3) that were found for it [L]


class PosesProblem(Protocol):
    """What can be turned into a problem, such as a :class:`~compas_cgc.datastructures.CGCMesh`."""

    def to_problem(self) -> CGCProblem:
        """Return the problem that this poses."""
        ...


def problem_of(given: PosesProblem, use: str = "is needed here") -> CGCProblem:
    """Return the problem that a mesh, a result or the like poses.

    Parameters
    ----------
    given
        What a caller handed over.
    use
        What is done with it, as the sentence has it.

    Raises
    ------
    CGCError
        If it poses none, with what to make of it.
    """
    if isinstance(given, type) or not hasattr(given, "to_problem"):
        raise CGCError(wrong_problem(given, use))
    return given.to_problem()


@names_what_was_meant()
@dataclass(frozen=True, eq=False, repr=False)
class CGCProblem:
    """A triangle mesh with what is asked of it.

    Wherever vertices are given to a method, they go by the user's names, which are their positions
    where nothing else is said. Every method returns a new problem.

    Parameters
    ----------
    vertices
        ``(n, 3)`` float64 coordinates [L].
    faces
        ``(m, 3)`` int64 vertex indices, anticlockwise seen from where the normals point.
    roles
        ``(n,)`` role of every vertex, its name or its index in :data:`ROLES`. Default: crease on creases, free on
        open edges, internal elsewhere.
    targets
        ``(n,)`` float64 target Gaussian curvature K̄ [1/L^2]; read at internal vertices. Default: none is set (NaN).
    s
        ``(n,)`` float64 factor of strategy S1, NaN where the settings' value holds.
    e
        ``(n,)`` float64 delay of strategy S2 in steps, NaN where the settings' value holds.
    creases
        ``(c, 2)`` int64 edges along which the surface may fold, which divide it into regions; or paths of vertices
        ``[u, v, w, ...]``.
    constraints
        What is asked of vertices besides K, each a :class:`Constraint` or its plain data; they go by their positions.
    names
        What the user calls vertices and faces. Default: their positions.
    drawing
        Name, units and tolerance of the drawing that the mesh comes from.
    origin
        Of a result: what its surface was found for, so that other targets lead on from there.

    Raises
    ------
    MeshError
        If vertices and faces are no mesh.
    ValueError
        If a length, a role or an index is wrong; the sentence says which.

    Examples
    --------
    >>> i, j = np.divmod(np.arange(100), 10)
    >>> vertices = np.column_stack([i, j, 0 * i])
    >>> a = np.array([k for k in range(90) if k % 10 < 9])
    >>> faces = np.vstack([np.column_stack([a, a + 10, a + 11]), np.column_stack([a, a + 11, a + 1])])
    >>> problem = CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.01)
    >>> int(problem.asked.sum()), problem.target_scale
    (64, 0.01)
    """

    vertices: FloatArray
    faces: IntArray
    roles: IntArray = None  # type: ignore[assignment]  # arrays once made
    targets: FloatArray = np.nan  # type: ignore[assignment]
    s: FloatArray = np.nan  # type: ignore[assignment]
    e: FloatArray = np.nan  # type: ignore[assignment]
    creases: IntArray = ()  # type: ignore[assignment]
    constraints: tuple[Constraint, ...] = ()
    names: Names = None  # type: ignore[assignment]
    drawing: Drawing = field(default=Drawing())
    origin: Optional[Origin] = None

    def __post_init__(self) -> None:
        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        V, F = mesh_arrays(self.vertices, self.faces)
        n = len(V)
        put("vertices", V)
        put("faces", F)
        put("creases", _edges(() if self.creases is None else self.creases, n))
        put("roles", _roles_of_places(V, F, self.creases) if self.roles is None else role_numbers(self.roles, n))
        for name in ("targets", "s", "e"):
            put(name, _column(getattr(self, name), n, name))
        put("constraints", as_constraints(self.constraints))
        check_indices(self.constraints, n)
        put("names", Names(np.arange(n), np.arange(len(F))) if self.names is None else _checked_names(self.names, n, len(F)))

    def __repr__(self) -> str:
        # The arrays would fill the screen.
        mesh = f"{len(self.vertices)} vertices, {len(self.faces)} faces"
        asked = f"{len(self.supports)} supports, {len(self.creases)} crease edges, {len(self.constraints)} constraints and goals"
        return f"<CGCProblem {self.drawing.name!r}: {mesh}, {asked}>"

    @classmethod
    def from_mesh(cls, mesh: PosesProblem) -> CGCProblem:
        """Return the problem that a mesh poses, with any dummy mesh, in the order of its vertices."""
        return mesh.to_problem()

    def to_problem(self) -> CGCProblem:
        """Return the problem itself, so that it is taken wherever a mesh is."""
        return self

    # ------------------------------------------------------------------
    # What is asked
    # ------------------------------------------------------------------

    def with_supports(self, supports: Union[str, Iterable[int]], add: bool = False) -> CGCProblem:
        """Fix vertices, and no others unless they shall be added.

        Parameters
        ----------
        supports
            Vertices, ``"boundary"`` for every vertex on an open edge, ``"outline"`` for those around the mesh and not around
            its holes, or ``"corners"`` for those where an open edge turns by more than 30 degrees.
        add
            Keep the supports that there are.

        Raises
        ------
        ValueError
            If there is no such vertex.
        """
        if isinstance(supports, str):
            fixed = named_supports(self.vertices, self.faces[self.real_faces], supports)
        else:
            fixed = self.positions(vertex_names(supports, "supports"))
        roles = np.where(self.roles == DUMMY, DUMMY, np.where((self.roles == FIXED) & add, FIXED, INTERNAL))
        roles[fixed] = FIXED
        return replace(self, roles=roles_by_place(self.vertices, self.faces, roles, self.creases))

    def with_creases(self, creases: Iterable[Sequence[int]], add: bool = False) -> CGCProblem:
        """Let the surface fold along edges, and along no others unless they shall be added.

        Parameters
        ----------
        creases
            Edges ``(u, v)`` or paths of vertices ``[u, v, w, ...]``.
        add
            Keep the creases that there are.

        Raises
        ------
        ValueError
            If two vertices that follow each other are not joined by an edge.
        """
        own = self.creases.tolist() if add else []
        edges = _edges([*own, *(self.positions(path).tolist() for path in vertex_paths(creases))], len(self.vertices))
        lost = lost_edges(self.faces, edges)
        if lost.any():
            u, v = self.names.vertices[edges[np.argmax(lost)]].tolist()
            raise ValueError(f"the crease from vertex {u} to {v} does not follow an edge; lead it along edges of the mesh")
        return replace(self, creases=edges, roles=roles_by_place(self.vertices, self.faces, self.roles, edges))

    def with_targets(self, K: Targets, *, region: Optional[int] = None) -> CGCProblem:
        """Ask for Gaussian curvatures [1/L^2].

        Parameters
        ----------
        K
            One number for all, a number per vertex ``(n,)`` with NaN where what there is shall stay, or a number by region.
        region
            Where one number shall hold. Default: everywhere.

        Raises
        ------
        ValueError
            If there is no such region, or not a number for every vertex.
        """
        if isinstance(K, Mapping):
            problem = self
            for number, value in K.items():
                problem = problem.with_targets(value, region=number)
            return problem
        given = _column(K, len(self.vertices), "targets")
        within = ~np.isnan(given) if np.ndim(K) else np.ones(len(given), bool)
        if region is not None:
            within &= self.region_vertices(region)
        return replace(self, targets=np.where(within, given, self.targets))

    def with_constraints(self, constraints: Iterable[Union[Constraint, Mapping[str, object]]], add: bool = True) -> CGCProblem:
        """Ask for something besides K, next to what is asked already unless `add` is false.

        Raises
        ------
        ProblemError
            If a constraint names a vertex that does not exist.
        """
        return replace(self, constraints=(*(self.constraints if add else ()), *as_constraints(constraints)))

    def with_vertices(self, vertices: ArrayLike) -> CGCProblem:
        """Put the vertices at other places (n, 3) [L].

        Raises
        ------
        ValueError
            If there is not one place for every vertex.
        """
        places = np.asarray(vertices, dtype=np.float64)
        if places.shape != self.vertices.shape:
            raise ValueError(f"vertices must have the shape {self.vertices.shape}, not {places.shape}")
        return replace(self, vertices=places)

    def flipped(self) -> CGCProblem:
        """Turn all faces over, so that the other side is the outside."""
        return replace(self, faces=self.faces[:, ::-1])

    # ------------------------------------------------------------------
    # Parts
    # ------------------------------------------------------------------

    @property
    def drawn(self) -> Optional[CGCProblem]:
        """The problem over the drawing that its surface was found from; None unless its targets, and nothing else, were changed since."""
        if self.origin is None:
            return None
        was, now = self.origin.drawn, self
        same = np.array_equal(self.origin.vertices, now.vertices) and was.constraints == now.constraints
        same = same and all(np.array_equal(getattr(was, name), getattr(now, name)) for name in ("faces", "roles", "creases"))
        if not same or np.array_equal(was.targets, now.targets, equal_nan=True):
            return None
        return replace(self, vertices=was.vertices, origin=None)

    @property
    def asked(self) -> NDArray[np.bool_]:
        """Vertices where K is asked for, N_I of the paper (n,)."""
        return self.roles == INTERNAL

    @property
    def movable(self) -> NDArray[np.bool_]:
        """Vertices that may move (n,)."""
        return (self.roles == INTERNAL) | (self.roles == CREASE) | (self.roles == FREE)

    @property
    def supports(self) -> IntArray:
        """Fixed vertices, by their positions (k,)."""
        return np.flatnonzero(self.roles == FIXED)

    @property
    def real_faces(self) -> NDArray[np.bool_]:
        """Faces without a dummy vertex (m,)."""
        return ~(self.roles == DUMMY)[self.faces].any(axis=1)

    @property
    def target_scale(self) -> float:
        """Curvature that errors are small or large against: the largest |K̄|, or one over the area [1/L^2]."""
        largest = float(np.abs(self.targets[self.asked]).max(initial=0.0))
        if largest > 0.0:
            return largest
        return 1.0 / float(face_areas(self.vertices, self.faces[self.real_faces]).sum())

    def positions(self, names: Iterable[int]) -> IntArray:
        """Return the positions of vertices that the user names (k,).

        Raises
        ------
        ValueError
            If there is no such vertex.
        """
        wanted = np.array(vertex_names(names, "vertices"), dtype=np.int64)
        known = self.names.vertices
        order = np.argsort(known, kind="stable")
        at = np.minimum(np.searchsorted(known, wanted, sorter=order), len(order) - 1)
        found = order[at]
        lost = wanted[known[found] != wanted]
        if len(lost):
            raise ValueError(no_vertex(lost.tolist(), known.tolist()))
        return found

    def regions(self) -> IntArray:
        """Number the regions of the faces, see :func:`compas_cgc.meshing.face_regions` (m,)."""
        return face_regions(self.faces, self.creases)

    def region_vertices(self, region: int) -> NDArray[np.bool_]:
        """Return the vertices of a region where K can be asked: not on creases (n,).

        Raises
        ------
        ValueError
            If there is no such region.
        """
        label = self.regions()
        count = int(label[self.real_faces].max(initial=-1)) + 1
        if isinstance(region, bool) or not isinstance(region, (int, np.integer)) or not 0 <= region < count:
            raise ValueError(no_region(region, count, len(self.creases) > 0))
        inside = np.zeros(len(self.vertices), bool)
        inside[self.faces[label == region]] = True
        return inside & (self.roles != CREASE)

    def region_targets(self) -> list[Optional[float]]:
        """Return the target of every region of the real mesh, None where it is not one number [1/L^2].

        What counts are the vertices where K is asked, or else all but those on creases.
        """
        label = np.where(self.real_faces, self.regions(), -1)
        return [self._target_of(self.faces[label == region]) for region in range(int(label.max(initial=-1)) + 1)]

    def _target_of(self, faces: IntArray) -> Optional[float]:
        used = np.zeros(len(self.vertices), bool)
        used[faces] = True
        counts = used & self.asked
        counts = counts if counts.any() else used & (self.roles != CREASE)
        values = np.unique(self.targets[counts])
        return float(values[0]) if len(values) == 1 and np.isfinite(values[0]) else None

    def crease_paths(self) -> list[list[int]]:
        """Return the creases as paths of positions between ends and branchings, in a stable order."""
        return crease_paths(map(tuple, self.creases.tolist()))

    def face_targets(self) -> FloatArray:
        """Return the target of every face: the mean over its corners where K is asked (m,).

        Faces without such a corner (between creases, in the dummy ring) take the mean of the faces around them.
        """
        return face_means(self.faces, self.asked, self.targets)

    def without_dummies(self) -> CGCProblem:
        """Return the problem of the real mesh; its free edges are free again."""
        real = self.roles != DUMMY
        if real.all():
            return self
        index = np.cumsum(real) - 1
        V, F = self.vertices[real], index[self.faces[self.real_faces]]
        own = self.roles[real]
        return replace(
            self,
            vertices=V,
            faces=F,
            roles=np.where(boundary_vertices(V, F) & (own == INTERNAL), FREE, own),
            targets=self.targets[real],
            s=self.s[real],
            e=self.e[real],
            creases=index[self.creases],
            constraints=tuple(constraint.renumbered(np.where(real, index, -1)) for constraint in self.constraints),
            names=Names(self.names.vertices[real], self.names.faces[self.real_faces]),
        )

    def local(self) -> tuple[CGCProblem, Frame]:
        """Return the same problem about its centroid at unit size, and the frame."""
        frame = local_frame(self.vertices, self.faces)
        local = replace(
            self,
            vertices=frame.to_local(self.vertices),
            targets=self.targets * frame.scale**2,
            constraints=tuple(constraint.local(frame) for constraint in self.constraints),
        )
        return local, frame


def _edges(creases: ArrayLike, n: int) -> IntArray:
    """Return edges or paths of vertices as edges (c, 2)."""
    if isinstance(creases, np.ndarray) and creases.ndim == 2 and creases.shape[1] == 2:
        edges = np.ascontiguousarray(creases, dtype=np.int64)
    else:
        edges = np.array(path_edges(creases), dtype=np.int64).reshape(-1, 2)  # type: ignore[arg-type]
    wrong = edges[(edges < 0) | (edges >= n)]
    if wrong.size:
        raise ValueError(f"a crease names vertex {wrong[0]}; the mesh has {n}, from 0 to {n - 1}")
    return edges


def _column(values: ArrayLike, n: int, name: str) -> FloatArray:
    """Return one number per vertex (n,)."""
    given = np.asarray(np.nan if values is None else values, dtype=np.float64)
    if given.shape not in ((), (n,)):
        raise ValueError(f"{name} must be one number, or one per vertex ({n}), not of shape {given.shape}")
    return np.ascontiguousarray(np.broadcast_to(given, (n,)))


def _roles_of_places(vertices: FloatArray, faces: IntArray, creases: IntArray) -> IntArray:
    return roles_by_place(vertices, faces, np.full(len(vertices), INTERNAL), creases)


def _checked_names(names: Names, n: int, m: int) -> Names:
    vertices, faces = (np.asarray(own, dtype=np.int64) for own in names)
    if vertices.shape != (n,) or faces.shape != (m,):
        raise ValueError(f"names must be {n} of vertices and {m} of faces, not of shape {vertices.shape} and {faces.shape}")
    return Names(vertices, faces)
