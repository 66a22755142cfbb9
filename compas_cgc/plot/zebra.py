"""Zebra stripes: reflections of a striped sky, whose kinks show folds and whose fraying shows wrinkles."""

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

PIECES, MOST = 8, 120_000  # that every edge is cut into, along which normals turn evenly; pieces of all faces, nearly
DARK = 0.14
THIN = 0.6  # line around a mesh [pt], whose bright stripes would run into the sheet


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
) -> Axes:
    """Draw a mesh as if it were polished, under a sky of stripes.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`.
    creases
        ``(e, 2)`` vertex indices of edges across which the surface may fold.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`.
    ax
        Axes to draw on. Default: those of a new figure.
    stripes
        How many there are in half the sky.
    frame
        What to show of the sheet. Default: all.

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
    ax = axes_for(ax, frame or whole.frame)
    middle = unit_vectors(normals.mean(axis=1))
    grey = np.where(sky.mean(axis=1) > 0.0, 1.0, DARK) * brightness(middle, view, ambient=0.7)
    fill = np.column_stack([grey, grey, grey, np.ones(len(grey))])
    edges = edge_faces(F)
    rim = segments(whole.corners, F, edges[edges[:, 3] < 0, :2], INK, THIN)
    paint(ax, [layer(seen.triangles, seen.nearness, fill, fill, 0.2), rim, *marks(ax, whole, roles, creases)])
    return ax


def _smooth_parts(V: FloatArray, F: IntArray, creases: IntArray) -> FloatArray:
    """Return a normal for every corner of every face (m, 3, 3), of the smooth part that the face belongs to.

    Weighted so that those of points on a ball are its own, however irregular the mesh (Max, doi:10.1080/10867651.1999.10487501).
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
    """Return the corners (k, 3, 3) of pieces of all faces, and unit normals there (k, 3, 3), which turn evenly."""
    pieces = int(np.clip(np.sqrt(MOST / max(len(F), 1)), 1, PIECES))
    place = {(i, j): i * (pieces + 1) - i * (i - 1) // 2 + j for i in range(pieces + 1) for j in range(pieces + 1 - i)}
    shares = np.array([[i, j, pieces - i - j] for i, j in place]) / pieces
    up = [[place[i, j], place[i + 1, j], place[i, j + 1]] for i in range(pieces) for j in range(pieces - i)]
    down = [[place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]] for i in range(pieces) for j in range(pieces - 1 - i)]
    corners = np.array(up + down)
    points = np.einsum("sc,fcx->fsx", shares, V[F])[:, corners].reshape(-1, 3, 3)
    normals = np.einsum("sc,fcx->fsx", shares, N)[:, corners].reshape(-1, 3)
    return points, unit_vectors(normals).reshape(-1, 3, 3)


def _sky(normals: FloatArray, view: View, stripes: float) -> FloatArray:
    """Return a wave across the sky (k, 3) that a surface with these normals (k, 3, 3) mirrors to the eye: above zero it is bright.

    It rises and falls in straight lines, so that it is zero where lines between two normals say.
    """
    right, _, eye = view_axes(view)
    mirrored = 2.0 * (normals @ eye)[..., None] * normals - eye
    # By planes across the sky: by angles around it all stripes would meet overhead, which is where roofs look.
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
