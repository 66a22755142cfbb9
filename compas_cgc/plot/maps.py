"""Colour maps of values at vertices: errors of curvature, and curvature itself."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import FloatArray
from ..errors import names_what_was_meant
from ..fabrication.picture_key import Key
from ..model.roles import INTERNAL
from .colours import UNDEFINED
from .colours import brightness
from .colours import diverging_map
from .colours import limit_above
from .colours import rgba
from .legend import SIDE
from .legend import colour_bar
from .legend import per_area
from .painter import layer
from .painter import paint
from .projected_mesh import look
from .shape import axes_for
from .shape import edge_width
from .shape import marks
from .view import Frame
from .view import View
from .view import view_named

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_curvature", "draw_error", "vertex_values"]


@names_what_was_meant()
def draw_error(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    errors: ArrayLike,
    view: Union[str, View] = "plan",
    ax: Optional[Axes] = None,
    *,
    creases: Optional[ArrayLike] = None,
    limit: Optional[float] = None,
    unit: Optional[str] = None,
    label: Optional[str] = None,
    frame: Optional[Frame] = None,
    key: Optional[Key] = None,
) -> Axes:
    """Draw the error map: red where K is above its target, blue where below, grey where K is not prescribed.

    Every vertex colours a third of each adjacent face. Dummy faces are omitted.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`.
    errors
        ``(n,)`` signed errors K - K̄ [1/L^2]; read at internal vertices, NaN is grey.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`.
    ax
        Axes to draw on, with room on the right for the colour bar. Default: those of a
        new figure.
    creases
        ``(e, 2)`` vertex indices of the edges to draw as thick lines.
    limit
        Error of the darkest colours [1/L^2]. Default: a round number above the largest.
    unit
        Unit of length for the label, such as ``"m"``.
    label
        Label of the colour bar. Default: K - K̄ with its unit.
    frame
        Visible part of the projection. Default: everything.
    key
        Unit, north and words of the key below a new figure, see :func:`key_of`. Default: only the unit is known.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ValueError
        If there is not one error per vertex.
    MeshError
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Figures 22 and 26.

    Examples
    --------
    >>> import compas_cgc
    >>> dome = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> type(draw_error(dome.vertices, dome.faces, dome.problem.roles, dome.curvature - dome.problem.targets)).__name__
    'Axes'
    """
    roles = np.asarray(roles)
    values = vertex_values(errors, len(roles), "errors")
    values = np.where(roles == INTERNAL, values, np.nan)
    return draw_values(
        vertices, faces, roles, values, view, ax, creases, limit, label or rf"$K-\bar K${per_area(unit)}", frame, key or Key(unit or "")
    )


@names_what_was_meant()
def draw_curvature(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    curvature: ArrayLike,
    view: Union[str, View] = "plan",
    ax: Optional[Axes] = None,
    *,
    creases: Optional[ArrayLike] = None,
    limit: Optional[float] = None,
    unit: Optional[str] = None,
    label: Optional[str] = None,
    frame: Optional[Frame] = None,
    key: Optional[Key] = None,
) -> Axes:
    """Draw the Gaussian curvature itself: red where positive, white where flat, blue where negative.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`.
    curvature
        ``(n,)`` K [1/L^2]; NaN is grey, as on creases and open boundaries.
    creases
        ``(e, 2)`` edges, as in :func:`draw_error`.
    view, ax, limit, unit, label, frame, key
        As in :func:`draw_error`.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ValueError
        If there is not one curvature per vertex.
    MeshError
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> import compas_cgc
    >>> dome = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> type(draw_curvature(dome.vertices, dome.faces, dome.problem.roles, dome.curvature)).__name__
    'Axes'
    """
    values = vertex_values(curvature, len(np.asarray(roles)), "curvature")
    return draw_values(
        vertices, faces, roles, values, view, ax, creases, limit, label or f"$K${per_area(unit)}", frame, key or Key(unit or "")
    )


def draw_values(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    values: FloatArray,
    view: Union[str, View],
    ax: Optional[Axes],
    creases: Optional[ArrayLike],
    limit: Optional[float],
    label: str,
    frame: Optional[Frame],
    key: Key,
) -> Axes:
    """Draw signed values ``(n,)`` at vertices with a colour bar."""
    view = view_named(view)
    seen = look(vertices, faces, roles, view, dummies=False)
    ax = axes_for(ax, seen, frame, view, key, SIDE)
    limit = limit or limit_above(values[seen.faces])
    colours = diverging_map()(np.clip(values / limit, -1.0, 1.0) / 2 + 0.5)
    colours[~np.isfinite(values)] = rgba(UNDEFINED)
    fill = colours[seen.faces]
    fill[..., :3] *= brightness(seen.normals, view, ambient=0.85)[:, None, None]
    fill = fill.reshape(-1, 4)
    width = edge_width(ax, seen)
    outline = layer(seen.triangles, seen.nearness, "none", (0.1, 0.1, 0.1, 0.55 if width else 0.0), 0.6 * width)
    shares = layer(corner_shares(seen.triangles), np.repeat(seen.nearness, 3), fill, fill, 0.25)
    paint(ax, [shares, outline, *marks(ax, seen, np.full(len(values), -1), creases)])
    colour_bar(ax, limit, label)
    return ax


def corner_shares(corner: FloatArray) -> FloatArray:
    """Return the third of every triangle (m, 3, 2) that belongs to each of its corners, as quadrangles (3 m, 4, 2)."""
    after = (corner + np.roll(corner, -1, axis=1)) / 2
    before = np.roll(after, 1, axis=1)
    middle = np.broadcast_to(corner.mean(axis=1, keepdims=True), corner.shape)
    return np.stack([corner, after, middle, before], axis=2).reshape(-1, 4, 2)


def vertex_values(values: ArrayLike, n: int, name: str) -> FloatArray:
    """Return an array with one float per vertex; raise an error for another shape."""
    result = np.asarray(values, dtype=np.float64)
    if result.shape != (n,):
        raise ValueError(f"{name} must be one per vertex ({n}), not of shape {result.shape}")
    return result
