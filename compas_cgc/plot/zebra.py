"""Zebra stripes: reflections of a striped sky, whose kinks show folds and whose irregularities show wrinkles."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..discrete import edge_faces
from ..discrete import mesh_arrays
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.normals import unit_vectors
from ..errors import names_what_was_meant
from ..fabrication.picture_key import Key
from ..meshing import face_regions
from ..meshing.split_sides import split_sides
from ..meshing.split_sides import weighted
from .colours import INK
from .colours import brightness
from .painter import layer
from .painter import paint
from .painter import segments
from .projected_mesh import edge_array
from .projected_mesh import look
from .shape import axes_for
from .shape import marks
from .view import Frame
from .view import View
from .view import view_axes
from .view import view_named

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_zebra"]

PIECES, MAX_PIECES = 8, 120_000  # pieces per edge for interpolated normals; approximate limit for all faces
DARK = 0.14
OUTLINE_WIDTH = 0.6  # line width of the outline [pt], which separates bright stripes from the background


@names_what_was_meant()
def draw_zebra(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    creases: Optional[ArrayLike] = None,
    view: Union[str, View] = "diagonal",
    ax: Optional[Axes] = None,
    *,
    stripes: float = 12.0,
    frame: Optional[Frame] = None,
    key: Optional[Key] = None,
) -> Axes:
    """Draw a mesh as a mirror under a striped sky.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`.
    creases
        ``(e, 2)`` vertex indices of edges along which the surface may fold.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`.
    ax
        Axes to draw on. Default: those of a new figure.
    stripes
        Number of stripes in half of the sky.
    frame
        Visible part of the projection. Default: everything.
    key
        Unit, north and words of the key below a new figure, see :func:`key_of`.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    MeshError
        If the arrays are not a triangle mesh.
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> import compas_cgc
    >>> dome = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))).problem
    >>> type(draw_zebra(dome.vertices, dome.faces, dome.roles)).__name__
    'Axes'
    """
    V, F = mesh_arrays(vertices, faces)
    view = view_named(view)
    whole = look(V, F, roles, view, dummies=False)
    F = whole.faces
    points, normals = _refined(V, F, _smooth_parts(V, F, edge_array(creases, whole.used)))
    points, normals, sky = _cut_at_stripes(points, normals, _sky(normals, view, stripes))
    corners = np.arange(3 * len(points)).reshape(-1, 3)
    seen = look(points.reshape(-1, 3), corners, np.zeros(3 * len(points), int), view)
    ax = axes_for(ax, whole, frame, view, key)
    middle = unit_vectors(normals.mean(axis=1))
    grey = np.where(sky.mean(axis=1) > 0.0, 1.0, DARK) * brightness(middle, view, ambient=0.7)
    fill = np.column_stack([grey, grey, grey, np.ones(len(grey))])
    edges = edge_faces(F)
    rim = segments(whole.corners, F, edges[edges[:, 3] < 0, :2], INK, OUTLINE_WIDTH)
    paint(ax, [layer(seen.triangles, seen.nearness, fill, fill, 0.2), rim, *marks(ax, whole, roles, creases)])
    return ax


def _smooth_parts(V: FloatArray, F: IntArray, creases: IntArray) -> FloatArray:
    """Return a normal for every corner of every face (m, 3, 3), smooth within the region of the face.

    The weights give exact normals for vertices on a sphere, also on irregular meshes (Max, doi:10.1080/10867651.1999.10487501).
    """
    label = face_regions(F, creases)
    pairs, corner = np.unique(np.column_stack([F.ravel(), np.repeat(label, 3)]), axis=0, return_inverse=True)
    corner = corner.ravel()
    ahead, back = np.roll(V[F], -1, axis=1) - V[F], np.roll(V[F], 1, axis=1) - V[F]
    square = (ahead**2).sum(axis=2) * (back**2).sum(axis=2)
    own = (np.cross(ahead, back) / np.maximum(square, np.finfo(float).tiny)[..., None]).reshape(-1, 3)
    sums = np.column_stack([np.bincount(corner, own[:, k], len(pairs)) for k in range(3)]).astype(np.float64)
    return unit_vectors(sums)[corner].reshape(-1, 3, 3)


def _refined(V: FloatArray, F: IntArray, N: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners (k, 3, 3) of pieces of all faces, and interpolated unit normals there (k, 3, 3)."""
    pieces = int(np.clip(np.sqrt(MAX_PIECES / max(len(F), 1)), 1, PIECES))
    place = {(i, j): i * (pieces + 1) - i * (i - 1) // 2 + j for i in range(pieces + 1) for j in range(pieces + 1 - i)}
    shares = np.array([[i, j, pieces - i - j] for i, j in place]) / pieces
    up = [[place[i, j], place[i + 1, j], place[i, j + 1]] for i in range(pieces) for j in range(pieces - i)]
    down = [[place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]] for i in range(pieces) for j in range(pieces - 1 - i)]
    corners = np.array(up + down)
    points = np.einsum("sc,fcx->fsx", shares, V[F])[:, corners].reshape(-1, 3, 3)
    normals = np.einsum("sc,fcx->fsx", shares, N)[:, corners].reshape(-1, 3)
    return points, unit_vectors(normals).reshape(-1, 3, 3)


def _sky(normals: FloatArray, view: View, stripes: float) -> FloatArray:
    """Return the reflected value of the sky (k, 3) for normals (k, 3, 3): a wave that is bright where positive.

    The wave is piecewise linear, so that its zeros are exact on linearly interpolated normals.
    """
    right, _, eye = view_axes(view)
    mirrored = 2.0 * (normals @ eye)[..., None] * normals - eye
    # Stripes are planes across the sky; stripes by angle would all meet at the zenith, which roofs reflect.
    return np.arcsin(np.sin(np.pi * stripes * (mirrored @ right)))


def _cut_at_stripes(points: FloatArray, normals: FloatArray, sky: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return triangles (k, 3, 3), their normals and the sky there (k, 3), cut where the sky changes from bright to dark."""
    end = np.roll(sky, -1, axis=1)
    crossing = sky * end < 0.0
    if not crossing.any():
        return points, normals, sky
    split = split_sides(np.arange(sky.size).reshape(-1, 3), crossing, sky, end, sky.size)
    points, normals, sky = (weighted(split.weights, values[split.parent]) for values in (points, normals, sky))
    return points, normals, sky
