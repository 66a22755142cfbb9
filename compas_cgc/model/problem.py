"""What the solvers are given: a mesh as arrays, with a role and a target for every vertex."""

from __future__ import annotations

import math
from dataclasses import dataclass
from dataclasses import replace
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete import mesh_arrays
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing.dummy_mesh import dummy_ring
from ..meshing.regions import face_regions

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["CREASE", "DUMMY", "FIXED", "FREE", "INTERNAL", "ROLES", "CGCProblem", "Frame"]

ROLES = ("internal", "fixed", "crease", "free", "dummy")
INTERNAL, FIXED, CREASE, FREE, DUMMY = range(len(ROLES))


class Frame(NamedTuple):
    """A local frame: ``local = (model - origin) / scale``."""

    origin: FloatArray  # (3,) model coordinates of the local origin [L]
    scale: float  # model length of one local unit [L], a power of two

    def to_local(self, vertices: FloatArray) -> FloatArray:
        """Return model coordinates ``(n, 3)`` in this frame."""
        return (vertices - self.origin) / self.scale

    def to_model(self, vertices: FloatArray) -> FloatArray:
        """Return coordinates of this frame ``(n, 3)`` in the model."""
        return vertices * self.scale + self.origin


@dataclass(frozen=True)
class CGCProblem:
    """A triangle mesh with what is asked of it.

    Parameters
    ----------
    vertices
        ``(n, 3)`` float64 coordinates [L].
    faces
        ``(m, 3)`` int64 vertex indices, anticlockwise seen from where the normals point.
    roles
        ``(n,)`` int64 role of every vertex, an index into :data:`ROLES`. Default: free on open edges, internal elsewhere.
    targets
        ``(n,)`` float64 target Gaussian curvature K̄ [1/L^2]; read at internal vertices. Default: none is set (NaN).
    s
        ``(n,)`` float64 factor of strategy S1, NaN where the settings' value holds.
    e
        ``(n,)`` float64 delay of strategy S2 in steps, NaN where the settings' value holds.
    creases
        ``(c, 2)`` int64 edges along which the surface may fold; they divide it into regions.
    """

    vertices: FloatArray
    faces: IntArray
    roles: Optional[IntArray] = None
    targets: Optional[FloatArray] = None
    s: Optional[FloatArray] = None
    e: Optional[FloatArray] = None
    creases: Optional[IntArray] = None

    def __post_init__(self) -> None:
        V, F = mesh_arrays(self.vertices, self.faces)
        n = len(V)
        put = object.__setattr__
        put(self, "vertices", V)
        put(self, "faces", F)
        roles = np.where(boundary_vertices(V, F), FREE, INTERNAL) if self.roles is None else self.roles
        put(self, "roles", np.ascontiguousarray(roles, dtype=np.int64))
        creases = () if self.creases is None else self.creases
        put(self, "creases", np.ascontiguousarray(creases, dtype=np.int64).reshape(-1, 2))
        for name in ("targets", "s", "e"):
            value = getattr(self, name)
            value = np.nan if value is None else value
            put(self, name, np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=np.float64), (n,))))
        if self.roles.shape != (n,):
            raise ValueError(f"roles must be one per vertex ({n}), not of shape {self.roles.shape}")

    @classmethod
    def from_mesh(cls, mesh: CGCMesh) -> CGCProblem:
        """Return the problem that a mesh poses, with any dummy mesh, in the order of its vertices."""
        vertices, faces = mesh.arrays(dummies=True)
        index = {key: i for i, key in enumerate(mesh.vertices())}

        def column(name: str) -> list:
            default = mesh.default_vertex_attributes.get(name)
            return [own.get(name, default) for own in mesh.vertex.values()]

        def numbers(name: str) -> FloatArray:
            return np.array([np.nan if value is None else value for value in column(name)], dtype=np.float64)

        number = {role: i for i, role in enumerate(ROLES)}
        roles = [number[role] for role in column("role")]
        creases = [(index[u], index[v]) for u, v in mesh.crease_edges()]
        return cls(vertices, faces, roles, numbers("target"), numbers("s"), numbers("e"), creases)

    @property
    def asked(self) -> NDArray[np.bool_]:
        """Vertices where K is asked for, N_I of the paper (n,)."""
        return self.roles == INTERNAL

    @property
    def movable(self) -> NDArray[np.bool_]:
        """Vertices that may move (n,)."""
        return (self.roles == INTERNAL) | (self.roles == CREASE) | (self.roles == FREE)

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

    def regions(self) -> IntArray:
        """Number the regions of the faces, see :func:`compas_cgc.meshing.face_regions` (m,)."""
        return face_regions(self.faces, self.creases)

    def without_dummies(self) -> CGCProblem:
        """Return the problem of the real mesh; its free edges are free again."""
        real = self.roles != DUMMY
        if real.all():
            return self
        index = np.cumsum(real) - 1
        V, F = self.vertices[real], index[self.faces[self.real_faces]]
        own = self.roles[real]
        roles = np.where(boundary_vertices(V, F) & (own == INTERNAL), FREE, own)
        return CGCProblem(V, F, roles, self.targets[real], self.s[real], self.e[real], index[self.creases])

    def with_dummy_ring(self) -> CGCProblem:
        """Return the problem with dummy faces along the free edges, where K is then asked for too.

        The dummy vertices come last. A problem without open edges that move is returned
        as it is.
        """
        rim = boundary_vertices(self.vertices, self.faces)
        if not (rim & self.movable).any():
            return self
        vertices, faces, inner = dummy_ring(self.vertices, self.faces, self.movable)
        dummies = np.full(len(inner), DUMMY)
        roles = np.where(self.roles == FREE, INTERNAL, self.roles)
        nothing = np.full(len(inner), np.nan)
        return CGCProblem(
            vertices,
            faces,
            np.concatenate([roles, dummies]),
            np.concatenate([self.targets, nothing]),
            np.concatenate([self.s, nothing]),
            np.concatenate([self.e, nothing]),
            self.creases,
        )

    def face_targets(self) -> FloatArray:
        """Return the target of every face: the mean over its corners where K is asked (m,).

        Faces without such a corner (between creases, in the dummy ring) take the mean
        of the faces around them.
        """
        weight = self.asked.astype(np.float64)
        value = np.where(self.asked, self.targets, 0.0)
        corners = np.arange(3 * len(self.faces)) // 3
        shape = (len(self.faces), len(self.vertices))
        incidence = sparse.csr_matrix((np.ones(len(corners)), (corners, self.faces.ravel())), shape=shape)
        count = incidence @ weight
        total = incidence @ value
        known = count > 0
        result = np.divide(total, count, out=np.zeros(len(self.faces)), where=known)
        while known.any() and not known.all():
            around = incidence @ (incidence.T @ known.astype(np.float64))
            mean = incidence @ (incidence.T @ np.where(known, result, 0.0))
            new = ~known & (around > 0)
            if not new.any():
                break
            result[new] = mean[new] / around[new]
            known = known | new
        return result

    def local(self) -> tuple[CGCProblem, Frame]:
        """Return the same problem about its centroid at unit size, and the frame.

        The scale is a power of two, so that no digit is lost by it.
        """
        of_faces = np.zeros(len(self.vertices), bool)
        of_faces[self.faces] = True
        used = self.vertices[of_faces] if len(self.faces) else self.vertices
        low, high = used.min(axis=0), used.max(axis=0)
        size = float(np.linalg.norm(high - low))
        scale = 2.0 ** math.floor(math.log2(size)) if size > 0 else 1.0
        frame = Frame(used.mean(axis=0), scale)
        local = replace(self, vertices=frame.to_local(self.vertices), targets=self.targets * scale**2)
        return local, frame
