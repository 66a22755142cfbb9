"""Array types by shape, and the validation of triangle meshes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from numpy.typing import NDArray

from ..errors import MeshError
from ..errors import names_what_was_meant

__all__ = [
    "CSRIndices",
    "EPS",
    "Edges",
    "Faces",
    "FloatArray",
    "Indices",
    "IntArray",
    "Mask",
    "MeshError",
    "PerFace",
    "PerVertex",
    "TINY",
    "Vectors",
    "Vertices",
    "mesh_arrays",
]

EPS = float(np.finfo(float).eps)  # relative rounding error of float64; by definition
TINY = float(np.finfo(float).tiny)  # smallest normal float64, which keeps quotients finite; by definition

FloatArray = NDArray[np.float64]
"""Floating-point numbers of any shape."""
IntArray = NDArray[np.int64]
"""Whole numbers of any shape."""

# NumPy's types know the kind of number and not the shape; these names tell readers.
Vertices = FloatArray
"""``(n, 3)`` coordinates [L]."""
Faces = IntArray
"""``(m, 3)`` vertex indices of triangles, counterclockwise seen from outside."""
Edges = IntArray
"""``(e, 2)`` vertex indices, or ``(e, 4)`` followed by the faces to the left and right, -1 for none."""
Indices = IntArray
"""``(k,)`` indices of vertices or faces."""
Mask = NDArray[np.bool_]
"""``(n,)`` or ``(m,)`` truth of something for every vertex or face."""
PerVertex = FloatArray
"""``(n,)`` one number for every vertex."""
PerFace = FloatArray
"""``(m,)`` one number for every face."""
Vectors = FloatArray
"""``(n, 3)`` or ``(m, 3)`` one vector for every vertex or face."""
CSRIndices = NDArray[np.signedinteger]
"""``indptr`` or ``indices`` of a sparse matrix, or labels of its components, int32 or int64."""


@names_what_was_meant()
def mesh_arrays(vertices: ArrayLike, faces: ArrayLike) -> tuple[Vertices, Faces]:
    """Return contiguous float64 vertices and int64 faces, or say what is wrong with them.

    Arrays that already fit are passed on without a copy.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.

    Returns
    -------
    vertices, faces
        ``(n, 3)`` float64 and ``(m, 3)`` int64, contiguous.

    Raises
    ------
    MeshError
        If a shape is wrong, a coordinate is not finite, or an index does not exist.

    Examples
    --------
    >>> vertices, faces = mesh_arrays([[0, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> vertices.dtype.name, faces.shape
    ('float64', (1, 3))
    """
    try:
        V = np.ascontiguousarray(vertices, dtype=np.float64)
        raw = np.asarray(faces)
    except (TypeError, ValueError) as error:
        raise MeshError(f"vertices and faces must be arrays of numbers ({error}); triangulate n-gons first") from None
    if V.ndim != 2 or V.shape[1] != 3:
        raise MeshError(f"vertices must have the shape (n, 3), not {V.shape}")
    if raw.size == 0:
        raw = raw.reshape(0, 3).astype(np.int64)
    if raw.ndim != 2 or raw.shape[1] != 3:
        raise MeshError(f"faces must have the shape (m, 3), not {raw.shape}; triangulate quads and n-gons first")
    if raw.dtype.kind not in "iu":
        raise MeshError(f"faces must hold integers, not {raw.dtype}")
    F = np.ascontiguousarray(raw, dtype=np.int64)
    if F.size and (F.min() < 0 or F.max() >= len(V)):
        bad = int(np.flatnonzero(((F < 0) | (F >= len(V))).any(axis=1))[0])
        raise MeshError(f"face {bad} names a vertex that does not exist: {F[bad].tolist()}, but there are {len(V)} vertices")
    if not np.isfinite(V).all():
        bad = int(np.flatnonzero(~np.isfinite(V).all(axis=1))[0])
        raise MeshError(f"vertex {bad} has a coordinate that is not a finite number: {V[bad].tolist()}")
    return V, F
