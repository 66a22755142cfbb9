"""Zebra stripes: reflections of a striped sky, whose kinks show folds and whose fraying shows wrinkles."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..discrete import mesh_arrays
from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing import face_regions
from .colours import brightness
from .painter import layer
from .painter import paint
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

PIECES = 8  # that every edge is cut into, along which normals turn evenly
DARK = 0.14


def draw_zebra(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    creases: Optional[ArrayLike] = None,
    view: Union[str, View] = "diagonal",
    ax: Optional[Axes] = None,
    *,
    stripes: float = 9.0,
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
    cut = np.arange(3 * len(points)).reshape(-1, 3)
    seen = look(points.reshape(-1, 3), cut, np.zeros(3 * len(points), int), view)
    ax = axes_for(ax, frame or whole.frame)
    grey = _striped(normals, view, stripes) * brightness(normals, view, ambient=0.7)
    fill = np.column_stack([grey, grey, grey, np.ones(len(grey))])
    paint(ax, [layer(seen.triangles, seen.nearness, fill, fill, 0.2), *marks(ax, whole, roles, creases)])
    return ax


def _smooth_parts(V: FloatArray, F: IntArray, creases: IntArray) -> FloatArray:
    """Return a normal for every corner of every face (m, 3, 3), of the smooth part that the face belongs to."""
    label = face_regions(F, creases)
    pairs, corner = np.unique(np.column_stack([F.ravel(), np.repeat(label, 3)]), axis=0, return_inverse=True)
    parts = corner.reshape(-1, 3)
    return vertex_normals(V[pairs[:, 0]], parts)[parts]


def _refined(V: FloatArray, F: IntArray, N: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners (k, 3, 3) and unit normals (k, 3) of pieces of all faces, with normals that turn evenly."""
    place = {(i, j): i * (PIECES + 1) - i * (i - 1) // 2 + j for i in range(PIECES + 1) for j in range(PIECES + 1 - i)}
    shares = np.array([[i, j, PIECES - i - j] for i, j in place]) / PIECES
    up = [[place[i, j], place[i + 1, j], place[i, j + 1]] for i in range(PIECES) for j in range(PIECES - i)]
    down = [[place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]] for i in range(PIECES) for j in range(PIECES - 1 - i)]
    pieces = np.array(up + down)
    points = np.einsum("sc,fcx->fsx", shares, V[F])[:, pieces].reshape(-1, 3, 3)
    normals = np.einsum("sc,fcx->fsx", shares, N)[:, pieces].mean(axis=2).reshape(-1, 3)
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _striped(normals: FloatArray, view: View, stripes: float) -> FloatArray:
    """Return how bright the sky is that a surface with these normals (k, 3) shows to the eye (k,)."""
    right, _, eye = view_axes(view)
    towards = normals * np.where(normals @ eye < 0.0, -1.0, 1.0)[:, None]
    mirrored = 2.0 * (towards @ eye)[:, None] * towards - eye
    angle = np.arctan2(mirrored @ right, mirrored @ eye)
    return np.where(np.sin(2.0 * stripes * angle) > 0.0, 1.0, DARK)
