"""Line drawings of meshes as in the paper: white with thin black edges, dummies grey, supports red, creases thick."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from ..fabrication.picture_key import Key
from ..model.roles import FIXED
from .colours import DUMMY_EDGE
from .colours import DUMMY_FACE
from .colours import INK
from .colours import SUPPORT
from .colours import SURFACE
from .colours import brightness
from .colours import rgba
from .layout import panels
from .layout import points_per_length
from .layout import show
from .legend import FOOT
from .legend import add_key
from .painter import Layer
from .painter import discs
from .painter import layer
from .painter import paint
from .painter import segments
from .projected_mesh import Seen
from .projected_mesh import edge_array
from .projected_mesh import look
from .view import Frame
from .view import View
from .view import view_axes
from .view import view_named

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["axes_for", "draw_shape", "edge_width", "marks"]

MIN_EDGE = 1.6  # length on paper below which edges are not drawn, as they would blacken the surface [pt]


@names_what_was_meant()
def draw_shape(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    creases: Optional[ArrayLike] = None,
    view: Union[str, View] = "diagonal",
    ax: Optional[Axes] = None,
    *,
    dummies: bool = True,
    frame: Optional[Frame] = None,
    key: Optional[Key] = None,
) -> Axes:
    """Draw a mesh with its dummies, supports and creases.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`: faces with a dummy vertex
        are grey, fixed vertices are red dots.
    creases
        ``(e, 2)`` vertex indices of the edges to draw as thick lines.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`.
    ax
        Axes to draw on. Default: those of a new figure.
    dummies
        Whether to show dummy faces.
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
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Figures 7, 8, 10-12, 14-16, 18-20, 23, 24, 27, 28.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> type(draw_shape(plan.vertices, plan.faces, plan.roles, view="plan")).__name__
    'Axes'
    """
    view = view_named(view)
    seen = look(vertices, faces, roles, view, dummies)
    ax = axes_for(ax, seen, frame, view, key)
    light = brightness(seen.normals, view, ambient=0.75)
    fill = np.where(seen.real[:, None], rgba(SURFACE), rgba(DUMMY_FACE))
    fill[:, :3] *= light[:, None]
    width = edge_width(ax, seen)
    edge = np.where(seen.real[:, None], rgba(INK), rgba(DUMMY_EDGE)) if width else fill
    paint(ax, [layer(seen.triangles, seen.nearness, fill, edge, width or 0.3), *marks(ax, seen, roles, creases)])
    return ax


def axes_for(ax: Optional[Axes], seen: Seen, frame: Optional[Frame], view: View, key: Optional[Key], side: float = 0.0) -> Axes:
    """Return the given axes, or the axes of a new figure, with a key below if there is a surface to see; both show a frame."""
    frame = frame or seen.frame
    if ax is not None:
        show(ax, frame)
        return ax
    ax = panels([[frame]], width=5.0 + side, foot=FOOT, side=side)[1][0][0]
    if len(seen.faces):
        add_key(ax, key or Key(), view_axes(view))
    return ax


def edge_length(ax: Axes, seen: Seen) -> float:
    """Return the typical length of the edges on paper [pt]."""
    corners = seen.triangles
    if not len(corners):
        return 0.0
    return points_per_length(ax) * float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))


def edge_width(ax: Axes, seen: Seen) -> float:
    """Return the line width of the edges of the mesh [pt], zero if they are too short."""
    length = edge_length(ax, seen)
    return 0.0 if length < MIN_EDGE else float(np.clip(0.04 * length, 0.1, 0.4))


def marks(ax: Axes, seen: Seen, roles: ArrayLike, creases: Optional[ArrayLike]) -> list[Layer]:
    """Return the layers of creases and supports."""
    used = seen.used
    fixed = np.flatnonzero((np.asarray(roles) == FIXED) & used)
    length = edge_length(ax, seen)
    radius = float(np.clip(0.2 * length, 1.0, 2.4)) / points_per_length(ax)
    return [
        segments(seen.corners, seen.faces, edge_array(creases, used), INK, float(np.clip(0.16 * length, 0.8, 1.6))),
        # Dummy faces do not hide supports, as they are not part of the roof.
        discs(seen.corners, seen.faces[seen.real], fixed, radius, SUPPORT),
    ]
