"""Rendering: one large perspective picture of a result."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import names_what_was_meant
from ..meshing import face_regions
from ..model.roles import INTERNAL
from .colours import INK
from .colours import PALETTE
from .colours import brightness
from .colours import diverging_map
from .colours import light_direction
from .colours import limit_above
from .colours import rgba
from .layout import panels
from .maps import vertex_values
from .painter import Layer
from .painter import layer
from .painter import paint
from .painter import segments
from .projected_mesh import Seen
from .projected_mesh import edge_array
from .projected_mesh import look
from .projected_mesh import real_faces
from .shape import edge_width
from .view import View
from .view import frame_of
from .view import project
from .view import used_vertices
from .view import view_axes
from .view import view_named

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["HERO_VIEW", "hero"]

HERO_VIEW = View(-58.0, 27.0, 2.2)
WIDTH = 8.0  # 1600 pixels [in]
SHADOW = [str(grey) for grey in (0.97, 0.955, 0.94, 0.925, 0.91, 0.895, 0.88, 0.865)]  # from the rim inwards


@names_what_was_meant()
def hero(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    creases: Optional[ArrayLike] = None,
    *,
    regions: Optional[ArrayLike] = None,
    curvature: Optional[ArrayLike] = None,
    view: Union[str, View] = HERO_VIEW,
) -> Figure:
    """Return a shaded picture of a result in perspective, 1600 pixels wide.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`; dummy faces are omitted.
    creases
        ``(e, 2)`` vertex indices of the edges to draw as thick lines.
    regions
        ``(m,)`` number of the region of every face, one colour per number.
        Default: the regions between creases, adjacent ones in different tones.
    curvature
        ``(n,)`` K [1/L^2] for the colours instead: red positive, blue negative; only values at
        internal vertices are used.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    ValueError
        If there is not one region per face or one curvature per vertex.
    MeshError
        If the arrays are not a triangle mesh with a role for every vertex.
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("vault.3dm")).to_problem()
    >>> hero(plan.vertices, plan.faces, plan.roles).get_size_inches().tolist()[0]
    7.999999999999999
    """
    view = view_named(view)
    seen = look(vertices, faces, roles, view, dummies=False)
    if curvature is not None:
        values = vertex_values(curvature, len(seen.corners), "curvature")
        colours = curvature_colours(
            seen.faces, face_regions(seen.faces, edge_array(creases, seen.used)), np.where(np.asarray(roles) == INTERNAL, values, np.nan)
        )
    elif regions is not None:
        colours = region_colours(face_values(regions, len(np.asarray(faces)))[real_faces(faces, roles)])
    else:
        colours = region_colours(tones(seen.faces, face_regions(seen.faces, edge_array(creases, seen.used))))
    below = shadow(np.asarray(vertices, dtype=np.float64), seen.faces, view)
    cast = [one.polygons.reshape(-1, 2) for one in below]
    frame = frame_of(np.concatenate([seen.corners[seen.used, :2], *cast]), margin=0.02)
    figure, ((ax,),) = panels([[frame]], width=WIDTH, foot=0.0)
    paint(ax, [*below, surface(seen, colours, view, edge_width(ax, seen)), *lines(seen, creases)])
    return figure


def tones(faces: IntArray, regions: IntArray) -> IntArray:
    """Return the number of a tone for every face (m,): few tones, different for adjacent regions."""
    sides = edge_faces(faces)[:, 2:]
    pairs = np.unique(regions[sides[(sides >= 0).all(axis=1)]], axis=0)
    beside: dict[int, set[int]] = {int(region): set() for region in np.unique(regions)}
    for a, b in pairs[pairs[:, 0] != pairs[:, 1]].tolist():
        beside[a].add(b)
        beside[b].add(a)
    tone: dict[int, int] = {}
    while len(tone) < len(beside):
        # Next the region with the most tones around it (DSATUR, doi:10.1145/359094.359101): two tones suffice if possible.
        around = {region: {tone[other] for other in beside[region] if other in tone} for region in beside if region not in tone}
        region = max(around, key=lambda r: len(around[r]))
        tone[region] = next(i for i in count() if i not in around[region])
    return np.array([tone[int(region)] for region in regions], dtype=np.int64)


def region_colours(regions: IntArray) -> FloatArray:
    """Return the colour of every face by its region (m, 4)."""
    palette = np.array([rgba(colour) for colour in PALETTE])
    return palette[np.unique(regions, return_inverse=True)[1].ravel() % len(palette)]


def curvature_colours(faces: IntArray, regions: IntArray, curvature: FloatArray) -> FloatArray:
    """Return the colour of every face (m, 4) by the mean K of its corners, or of its region if they have none."""
    corners = curvature[faces]
    known = np.isfinite(corners)
    weight, total = known.sum(axis=1), np.where(known, corners, 0.0).sum(axis=1)
    whole = np.bincount(regions, total) / np.maximum(np.bincount(regions, weight), 1)
    mean = np.where(weight > 0, total / np.maximum(weight, 1), whole[regions])
    return diverging_map()(np.clip(mean / limit_above(mean), -1.0, 1.0) / 2 + 0.5)


def surface(seen: Seen, colours: FloatArray, view: View, width: float) -> Layer:
    """Return the layer of shaded faces with colours (m, 4)."""
    fill = colours.copy()
    fill[:, :3] *= brightness(seen.normals, view, ambient=0.5)[:, None]
    edge = fill.copy()
    edge[:, :3] *= 0.72 if width else 1.0
    return layer(seen.triangles, seen.nearness, fill, edge, max(width, 0.4))


def lines(seen: Seen, creases: Optional[ArrayLike]) -> list[Layer]:
    """Return the layers of the outline and of the creases."""
    edges = edge_faces(seen.faces)
    outline = edges[edges[:, 3] < 0, :2]
    return [
        segments(seen.corners, seen.faces, outline, INK, 1.0),
        segments(seen.corners, seen.faces, edge_array(creases, seen.used), INK, 1.6),
    ]


def shadow(vertices: FloatArray, faces: IntArray, view: View) -> list[Layer]:
    """Return the layers of the shadow on the ground at the lowest vertex, darker from outside to inside."""
    if view_axes(view)[2, 2] <= 0 or not len(faces):
        return []
    real = vertices[used_vertices(len(vertices), faces)]
    ground = real[:, 2].min()
    layers = []
    for i, colour in enumerate(SHADOW):
        light = light_direction(view, spread=1.0 - i / len(SHADOW))
        cast = vertices - (vertices[:, 2:] - ground) / light[2] * light
        layers.append(layer(project(cast, view, real)[faces, :2], np.full(len(faces), -np.inf), colour, colour, 0.4))
    return layers


def face_values(values: ArrayLike, m: int) -> IntArray:
    """Return an array with one number per face; raise an error for another shape."""
    result = np.asarray(values, dtype=np.int64)
    if result.shape != (m,):
        raise ValueError(f"regions must be one per face ({m}), not of shape {result.shape}")
    return result
