"""CGCProblem: a mesh as arrays with supports, creases, targets and goals."""

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
from .constraint_data import as_goals
from .constraints import Constraint
from .constraints import Fixed
from .constraints import check_indices
from .constraints import indices
from .frame import Frame
from .frame import local_frame
from .given import checked_number
from .given import no_region
from .given import no_vertex
from .given import vertex_names
from .given import vertex_paths
from .given import wrong_problem
from .laws import ConstantCurvature
from .laws import Law
from .laws import as_law
from .laws import types_of
from .motion import Similarity
from .motion import similarity_of
from .roles import CREASE
from .roles import DUMMY
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL
from .roles import role_numbers
from .roles import roles_by_place

__all__ = ["CGCProblem", "Drawing", "Names", "Origin", "PosesProblem", "problem_of"]

Targets = Union[float, ArrayLike, Mapping[int, float]]
Laws = Union[Law, str, float, Mapping[int, Union[Law, str, float]]]


class Names(NamedTuple):
    """Keys of vertices and faces in the user's mesh."""

    vertices: IntArray  # (n,)
    faces: IntArray  # (m,)


class Drawing(NamedTuple):
    """Metadata of the drawing that a mesh comes from."""

    name: str = "mesh"
    units: Optional[str] = None  # unit system such as ``Meters``
    tolerance: Optional[float] = None  # distance within which points coincide [L]
    places: tuple[tuple[str, Sequence[Sequence[float]]], ...] = ()  # named closed polylines in plan [L]
    north: tuple[float, float] = (0.0, 1.0)  # direction in plan


class Origin(NamedTuple):
    """The problem that a surface solves."""

    drawn: CGCProblem  # the problem as drawn, with its targets
    vertices: FloatArray  # (n, 3) vertices of the solution [L]
    measure: str = ""  # in which it has its K, empty if unknown
    evenness: float = 0.0  # length over which curvature was made to vary evenly, relative to the square root of the area


class PosesProblem(Protocol):
    """Object that can be converted to a problem, such as a :class:`~compas_cgc.datastructures.CGCMesh`."""

    def to_problem(self) -> CGCProblem:
        """Return the problem."""
        ...


def problem_of(given: PosesProblem, use: str = "is needed here") -> CGCProblem:
    """Return the problem of a mesh, a result or another object with ``to_problem``.

    Parameters
    ----------
    given
        The object.
    use
        What the problem is used for, for the error message.

    Raises
    ------
    CGCError
        If the object cannot be converted.
    """
    if isinstance(given, type) or not hasattr(given, "to_problem"):
        raise CGCError(wrong_problem(given, use))
    return given.to_problem()


@names_what_was_meant()
@dataclass(frozen=True, eq=False, repr=False)
class CGCProblem:
    """A triangle mesh with supports, creases, target curvatures and goals.

    Methods take vertices by their keys in ``names``; by default keys are indices. Every method returns a new problem.

    Parameters
    ----------
    vertices
        ``(n, 3)`` float64 coordinates [L].
    faces
        ``(m, 3)`` int64 vertex indices, counterclockwise seen from the side to which the normals point.
    roles
        ``(n,)`` role of every vertex, as a name or an index into :data:`ROLES`. Default: crease on creases, free on
        the boundary, internal elsewhere.
    targets
        ``(n,)`` float64 target Gaussian curvature K̄ [1/L^2], used at internal vertices. Default: NaN (not set).
    s
        ``(n,)`` float64 factor of strategy S1, NaN where the value in the settings applies.
    e
        ``(n,)`` float64 delay of strategy S2 in steps, NaN where the value in the settings applies.
    creases
        ``(c, 2)`` int64 edges along which the surface may fold, which divide it into regions; or paths of vertices
        ``[u, v, w, ...]``.
    laws
        Laws of regions other than constant K, by the number of the region; targets do not count there.
    goals
        Requirements besides K, each a :class:`Constraint` or its plain data; they refer to vertices by index.
    names
        Keys of vertices and faces in the user's mesh. Default: their indices.
    drawing
        Name, units, tolerance and north of the drawing that the mesh comes from.
    origin
        For a result: the problem that its surface solves, which later solves with other targets start from.

    Raises
    ------
    MeshError
        If vertices and faces do not form a mesh.
    ValueError
        If a length, a role or an index is invalid.

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
    goals: tuple[Constraint, ...] = ()
    laws: Mapping[int, Law] = field(default_factory=dict)
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
        if self.laws:
            within = self._within_regions(self.laws)
            put("laws", {int(region): as_law(self.laws[region]) for region in sorted(self.laws)})
            put("targets", np.where(np.any([*within.values()], axis=0), np.nan, self.targets))
        put("goals", as_goals(self.goals))
        check_indices(self.goals, n)
        put("names", Names(np.arange(n), np.arange(len(F))) if self.names is None else _checked_names(self.names, n, len(F)))

    def __repr__(self) -> str:
        # The arrays would fill the screen.
        mesh = f"{len(self.vertices)} vertices, {len(self.faces)} faces"
        asked = f"{len(self.supports)} supports, {len(self.creases)} crease edges, {len(self.goals)} goals"
        return f"<CGCProblem {self.drawing.name!r}: {mesh}, {asked}>"

    @classmethod
    def from_mesh(cls, mesh: PosesProblem) -> CGCProblem:
        """Return the problem of a mesh, including any dummy mesh, in the order of its vertices."""
        return mesh.to_problem()

    def to_problem(self) -> CGCProblem:
        """Return the problem itself; functions that take a mesh call this."""
        return self

    # ------------------------------------------------------------------
    # Supports, creases, targets, goals
    # ------------------------------------------------------------------

    def with_supports(self, supports: Union[str, Iterable[int]], add: bool = False) -> CGCProblem:
        """Return the problem with these vertices fixed; replaces the supports unless `add` is true.

        Parameters
        ----------
        supports
            Vertices, ``"boundary"`` for all boundary vertices, ``"outline"`` for those of the outer boundary without holes, or
            ``"corners"`` for boundary vertices where the boundary turns by more than 30 degrees.
        add
            Keep the present supports.

        Raises
        ------
        ValueError
            If a vertex does not exist.
        """
        if isinstance(supports, str):
            fixed = named_supports(self.vertices, self.faces[self.real_faces], supports)
        else:
            fixed = self.positions(vertex_names(supports, "supports"))
        roles = np.where(self.roles == DUMMY, DUMMY, np.where((self.roles == FIXED) & add, FIXED, INTERNAL))
        roles[fixed] = FIXED
        return replace(self, roles=roles_by_place(self.vertices, self.faces, roles, self.creases))

    def with_creases(self, creases: Iterable[Sequence[int]], add: bool = False) -> CGCProblem:
        """Return the problem with creases along these edges; replaces the creases unless `add` is true.

        A new region within an old one keeps the law of that.

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
        own = self.creases.tolist() if add else []
        edges = _edges([*own, *(self.positions(path).tolist() for path in vertex_paths(creases))], len(self.vertices))
        lost = lost_edges(self.faces, edges)
        if lost.any():
            u, v = self.names.vertices[edges[np.argmax(lost)]].tolist()
            raise ValueError(f"the crease from vertex {u} to {v} does not follow an edge of the mesh; define creases along edges")
        made = replace(self, creases=edges, roles=roles_by_place(self.vertices, self.faces, self.roles, edges), laws={})
        if not self.laws:
            return made
        old, new = self.regions(), made.regions()
        parents = {region: np.unique(old[new == region]).tolist() for region in range(made.number_of_regions())}
        return replace(made, laws={region: self.laws[own[0]] for region, own in parents.items() if len(own) == 1 and own[0] in self.laws})

    def with_targets(self, K: Targets, *, region: Optional[int] = None) -> CGCProblem:
        """Return the problem with these target Gaussian curvatures.

        Parameters
        ----------
        K
            Target [1/L^2]: one number, ``(n,)`` numbers with NaN where the present target stays, or a dict of numbers by region.
        region
            Region that gets the target. Default: all.

        Raises
        ------
        ValueError
            If the region does not exist or the number of targets is wrong.
        """
        if isinstance(K, Mapping):
            targets, within = self.targets.copy(), self._within_regions(K)
            for number, value in K.items():
                targets[within[number]] = checked_number(value, "a target")
            return replace(self, targets=targets, laws={number: law for number, law in self.laws.items() if number not in K})
        given = _column(K, len(self.vertices), "targets")
        mask = ~np.isnan(given) if np.ndim(K) else np.ones(len(given), bool)
        laws = self.laws if np.ndim(K) else {}
        if region is not None:
            mask &= self.region_vertices(region)
            laws = {number: law for number, law in self.laws.items() if number != region}
        return replace(self, targets=np.where(mask, given, self.targets), laws=laws)

    def with_laws(self, laws: Laws) -> CGCProblem:
        """Return the problem with these laws of regions.

        Parameters
        ----------
        laws
            One law for all regions, or a dict of laws by region: values such as ``ConstantMeanCurvature(0.1)`` or texts such as
            ``"H = 0.1"``. :class:`ConstantCurvature` sets the targets of the region.

        Raises
        ------
        ValueError
            If a region does not exist or a text is no law.

        Examples
        --------
        >>> problem = CGCProblem([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).with_laws("H = 0.1")
        >>> problem.laws
        {0: ConstantMeanCurvature(h=0.1)}
        """
        by_region = laws if isinstance(laws, Mapping) else dict.fromkeys(range(self.number_of_regions()), laws)
        given, within = {region: as_law(law) for region, law in by_region.items()}, self._within_regions(by_region)
        targets, own = self.targets.copy(), dict(self.laws)
        for region, law in given.items():
            own.pop(region, None)
            if isinstance(law, ConstantCurvature):
                targets[within[region]] = law.k
            else:
                own[region] = law
        return replace(self, targets=targets, laws=own)

    def region_laws(self) -> list[Optional[Law]]:
        """Return the law of every region of the real mesh, None where a region has no law and not one target."""
        targets = self.region_targets()
        constant = [None if K is None else ConstantCurvature(K) for K in targets]
        return [self.laws.get(region, law) for region, law in enumerate(constant)]

    def with_goals(self, goals: Iterable[Union[Constraint, Mapping[str, object]]], add: bool = True) -> CGCProblem:
        """Return the problem with these goals, added to the present ones unless `add` is false.

        Raises
        ------
        ProblemError
            If a constraint names a vertex that does not exist.
        """
        return replace(self, goals=(*(self.goals if add else ()), *as_goals(goals)))

    def with_vertices(self, vertices: ArrayLike) -> CGCProblem:
        """Return the problem with other vertex coordinates (n, 3) [L].

        Raises
        ------
        ValueError
            If the shape is wrong.
        """
        places = np.asarray(vertices, dtype=np.float64)
        if places.shape != self.vertices.shape:
            raise ValueError(f"vertices must have the shape {self.vertices.shape}, not {places.shape}")
        return replace(self, vertices=places)

    def transformed(self, transformation: object) -> CGCProblem:
        """Return the problem after a similarity: vertices, targets [1/L^2], goals and the drawn shape follow it.

        A reflection reverses the faces, so that the surface keeps its side.

        Parameters
        ----------
        transformation
            COMPAS transformation, or a ``(4, 4)`` matrix.

        Raises
        ------
        ValueError
            If the transformation is no similarity, or a goal refers to the vertical and cannot follow it.

        Examples
        --------
        >>> problem = CGCProblem([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], targets=4.0)
        >>> problem.transformed(np.diag([2, 2, 2, 1])).targets.tolist()
        [1.0, 1.0, 1.0]
        """
        return self._moved(similarity_of(transformation))

    def _moved(self, motion: Similarity) -> CGCProblem:
        from .goals.moved import moved_goals

        tolerance = None if self.drawing.tolerance is None else motion.measure(self.drawing.tolerance)
        places = tuple((name, motion.plan(line).tolist()) for name, line in self.drawing.places) if motion.up else ()
        x, y, _ = motion.direction((*self.drawing.north, 0.0)).tolist()
        origin = (
            None
            if self.origin is None
            else self.origin._replace(drawn=self.origin.drawn._moved(motion), vertices=motion.points(self.origin.vertices))
        )
        return replace(
            self,
            vertices=motion.points(self.vertices),
            faces=self.faces[:, ::-1] if motion.reflects else self.faces,
            targets=self.targets / motion.scale**2,
            laws={region: law.scaled(motion.scale) for region, law in self.laws.items()},
            goals=moved_goals(self.goals, motion),
            drawing=self.drawing._replace(tolerance=tolerance, places=places, north=(x, y) if motion.up else self.drawing.north),
            origin=origin,
        )

    def flipped(self) -> CGCProblem:
        """Return the problem with all faces flipped, so that its surfaces go to the other side; laws then refer to the new normals."""
        return replace(self, faces=self.faces[:, ::-1])

    def with_opposite_normals(self) -> CGCProblem:
        """Return the problem of the same surfaces with all faces flipped; H of its laws changes sign.

        Examples
        --------
        >>> problem = CGCProblem([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).with_laws("H = 0.1")
        >>> str(problem.with_opposite_normals().laws[0]), str(problem.flipped().laws[0])
        ('H = -0.1', 'H = 0.1')
        """
        return replace(self.flipped(), laws={region: law.scaled(-1.0) for region, law in self.laws.items()})

    # ------------------------------------------------------------------
    # Parts
    # ------------------------------------------------------------------

    @property
    def drawn(self) -> Optional[CGCProblem]:
        """The problem on the originally drawn vertices; None where more than the targets has changed since the solve."""
        if self.origin is None:
            return None
        was, now = self.origin.drawn, self
        same = np.array_equal(self.origin.vertices, now.vertices) and was.goals == now.goals
        same = same and all(np.array_equal(getattr(was, name), getattr(now, name)) for name in ("faces", "roles"))
        same = same and np.array_equal(_unordered(was.creases), _unordered(now.creases))
        return replace(self, vertices=was.vertices, origin=None) if same else None

    def drawn_as(self, vertices: ArrayLike, measure: str = "", evenness: float = 0.0) -> CGCProblem:
        """Return the problem of a surface with the drawing (n, 3) that it was found for [L], and how: see :class:`Origin`.

        Raises
        ------
        ValueError
            If the shape is wrong.
        """
        return replace(self, origin=Origin(replace(self.with_vertices(vertices), origin=None), self.vertices, measure, evenness))

    @property
    def asked(self) -> NDArray[np.bool_]:
        """Mask of the vertices with a target, N_I of the paper (n,): internal ones of regions without another law than constant K."""
        internal = self.roles == INTERNAL
        if self.laws:
            internal[self.faces[np.isin(self.regions(), list(self.laws))]] = False
        return internal

    @property
    def types(self) -> FloatArray:
        """Types of K = K̄ at the vertices (n,): 1 elliptic, 0 parabolic, -1 hyperbolic, NaN without a target."""
        return types_of(self.targets)

    @property
    def movable(self) -> NDArray[np.bool_]:
        """Mask of the vertices that may move (n,); those of goals :class:`Fixed` may not."""
        result = np.isin(self.roles, (INTERNAL, CREASE, FREE))
        for goal in self.goals:
            if isinstance(goal, Fixed):
                result[indices(goal.vertices, len(result))] = False
        return result

    @property
    def supports(self) -> IntArray:
        """Indices of the fixed vertices (k,)."""
        return np.flatnonzero(self.roles == FIXED)

    @property
    def real_faces(self) -> NDArray[np.bool_]:
        """Mask of the faces without dummy vertices (m,)."""
        a, b, c = (self.roles == DUMMY)[self.faces.T]
        return ~(a | b | c)

    @property
    def target_scale(self) -> float:
        """Reference curvature for relative errors: the largest |K̄|, or one over the area if all targets are 0 [1/L^2]."""
        largest = float(np.abs(self.targets[self.asked]).max(initial=0.0))
        if largest > 0.0:
            return largest
        return 1.0 / float(face_areas(self.vertices, self.faces[self.real_faces]).sum())

    def positions(self, names: Iterable[int]) -> IntArray:
        """Return the indices of vertices given by their keys (k,).

        Raises
        ------
        ValueError
            If a vertex does not exist.
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
        """Return the region number of every face, see :func:`compas_cgc.meshing.face_regions` (m,).

        The faces of the dummy mesh join no regions; they have the next number after those of the real mesh.
        """
        real = self.real_faces
        own = face_regions(self.faces[real], self.creases)
        label = np.full(len(self.faces), own.max(initial=-1) + 1)
        label[real] = own
        return label

    def number_of_regions(self) -> int:
        """Return the number of regions of the real mesh."""
        return int(self.regions()[self.real_faces].max(initial=-1)) + 1

    def region_vertices(self, region: int) -> NDArray[np.bool_]:
        """Return the mask of the vertices of a region that are not on creases (n,).

        Raises
        ------
        ValueError
            If the region does not exist.
        """
        return self._within_regions([region])[region]

    def _within_regions(self, regions: Iterable[int]) -> dict[int, NDArray[np.bool_]]:
        """Return the masks of the vertices of regions that are not on creases, by region."""
        label, count = self.regions(), self.number_of_regions()
        masks = {}
        for region in regions:
            if isinstance(region, bool) or not isinstance(region, (int, np.integer)) or not 0 <= region < count:
                raise ValueError(no_region(region, count, len(self.creases) > 0))
            inside = np.zeros(len(self.vertices), bool)
            inside[self.faces[label == region]] = True
            masks[region] = inside & (self.roles != CREASE)
        return masks

    def region_targets(self) -> list[Optional[float]]:
        """Return the target of every region of the real mesh, None if it is not one number [1/L^2].

        The internal vertices of a region count; a region without any uses its vertices off the creases.
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
        """Return the creases as paths of vertex indices between ends and junctions, in a stable order."""
        return crease_paths(map(tuple, self.creases.tolist()))

    def face_targets(self) -> FloatArray:
        """Return the target of every face: the mean over its internal corners (m,) [1/L^2].

        Faces without such a corner (between creases, in the dummy ring) take the mean of their neighbours.
        """
        return face_means(self.faces, self.asked, self.targets)

    def without_dummies(self) -> CGCProblem:
        """Return the problem without the dummy mesh; its free edges get the role free again."""
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
            goals=tuple(constraint.renumbered(np.where(real, index, -1)) for constraint in self.goals),
            names=Names(self.names.vertices[real], self.names.faces[self.real_faces]),
        )

    def local(self) -> tuple[CGCProblem, Frame]:
        """Return the problem in its local frame (centroid, unit size), and the frame."""
        frame = local_frame(self.vertices, self.faces)
        local = replace(
            self,
            vertices=frame.to_local(self.vertices),
            targets=self.targets * frame.scale**2,
            laws={region: law.scaled(1.0 / frame.scale) for region, law in self.laws.items()},
            goals=tuple(constraint.transformed(frame) for constraint in self.goals),
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
        raise ValueError(f"a crease names vertex {wrong[0]}, but the mesh has vertices 0 to {n - 1}; correct the crease")
    return edges


def _unordered(edges: IntArray) -> IntArray:
    """Return edges (c, 2) in an order that does not depend on the one given, as meshes do not keep it."""
    return np.unique(np.sort(edges, axis=1), axis=0)


def _column(values: ArrayLike, n: int, name: str) -> FloatArray:
    """Return one number per vertex (n,)."""
    given = np.asarray(np.nan if values is None else values, dtype=np.float64)
    if given.shape not in ((), (n,)):
        raise ValueError(f"{name} must be one number or one number per vertex ({n}), not an array of shape {given.shape}")
    return np.ascontiguousarray(np.broadcast_to(given, (n,)))


def _roles_of_places(vertices: FloatArray, faces: IntArray, creases: IntArray) -> IntArray:
    return roles_by_place(vertices, faces, np.full(len(vertices), INTERNAL), creases)


def _checked_names(names: Names, n: int, m: int) -> Names:
    vertices, faces = (np.asarray(own, dtype=np.int64) for own in names)
    if vertices.shape != (n,) or faces.shape != (m,):
        raise ValueError(f"names must be {n} keys of vertices and {m} of faces, not arrays of shape {vertices.shape} and {faces.shape}")
    return Names(vertices, faces)
