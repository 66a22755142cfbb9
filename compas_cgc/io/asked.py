"""A mesh with what is asked of it, as arrays that files are written from."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing import crease_paths
from ..meshing import face_regions
from ..model.roles import CREASE
from ..model.roles import DUMMY
from ..model.roles import FIXED
from ..model.roles import INTERNAL
from ..model.roles import ROLES

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["Asked", "asked_of"]


class Asked(NamedTuple):
    """A mesh without dummies, its vertices numbered from 0 in their order."""

    name: str
    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 3)
    roles: IntArray  # (n,) indices into ROLES
    targets: FloatArray  # (n,) [1/L^2], NaN where none
    s: FloatArray  # (n,) factor of S1, NaN where none
    e: FloatArray  # (n,) delay of S2, NaN where none
    edges: IntArray  # (c, 2) crease edges
    creases: list[list[int]]  # the same as paths
    regions: IntArray  # (m,) region of every face

    @property
    def supports(self) -> IntArray:
        """Fixed vertices (k,)."""
        return np.flatnonzero(self.roles == FIXED)

    @property
    def asked(self) -> np.ndarray:
        """Vertices where K is asked (n,) bool."""
        return self.roles == INTERNAL

    def region_targets(self) -> list[Optional[float]]:
        """Return the target of every region, None where it is not one number [1/L^2].

        What counts are the vertices where K is asked, or else all but those on creases.
        """
        return [self._target(self.faces[self.regions == region]) for region in range(int(self.regions.max(initial=-1)) + 1)]

    def _target(self, faces: IntArray) -> Optional[float]:
        used = np.zeros(len(self.vertices), bool)
        used[faces] = True
        counts = used & self.asked
        counts = counts if counts.any() else used & (self.roles != CREASE)
        values = np.unique(self.targets[counts])
        return float(values[0]) if len(values) == 1 and np.isfinite(values[0]) else None


def asked_of(mesh: CGCMesh) -> Asked:
    """Return the arrays of a mesh."""
    data = mesh.vertex
    keys = [key for key, own in data.items() if own.get("role") != ROLES[DUMMY]]
    index = {key: i for i, key in enumerate(keys)}
    faces = list(mesh.face.values())
    if len(keys) < len(data):
        faces = [corners for corners in faces if all(key in index for key in corners)]
    corners = np.array(faces, dtype=np.int64).reshape(-1, 3)
    if keys != list(range(len(keys))):
        known = np.array(sorted(index), dtype=np.int64)
        corners = np.array([index[key] for key in known.tolist()], dtype=np.int64)[np.searchsorted(known, corners)]
    columns = {name: np.fromiter((data[key][name] for key in keys), np.float64, len(keys)) for name in "xyz"}
    role = {name: i for i, name in enumerate(ROLES)}
    default = mesh.default_vertex_attributes.get("role", ROLES[INTERNAL])
    edges = [(index[u], index[v]) for u, v in mesh.crease_edges() if u in index and v in index]
    pairs = np.array(edges, dtype=np.int64).reshape(-1, 2)
    return Asked(
        name=mesh.name or "mesh",
        vertices=np.column_stack([columns[axis] for axis in "xyz"]),
        faces=corners,
        roles=np.fromiter((role[data[key].get("role", default)] for key in keys), np.int64, len(keys)),
        targets=_numbers(mesh, keys, "target"),
        s=_numbers(mesh, keys, "s"),
        e=_numbers(mesh, keys, "e"),
        edges=pairs,
        creases=crease_paths(edges),
        regions=face_regions(corners, pairs) if len(corners) else np.empty(0, np.int64),
    )


def _numbers(mesh: CGCMesh, keys: list[int], name: str) -> FloatArray:
    default = mesh.default_vertex_attributes.get(name)
    values = (mesh.vertex[key].get(name, default) for key in keys)
    return np.fromiter((np.nan if value is None else value for value in values), np.float64, len(keys))
