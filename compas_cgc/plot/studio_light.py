"""Studio light: rendering of a smooth surface with creases under sun and sky, on a white floor.

Light is computed by shadow maps (Williams, 1978), one per direction of the sky and the sun.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from .._figures import new_figure
from ..discrete import edge_faces
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import ArgumentError
from ..errors import names_what_was_meant
from ..fabrication.picture_key import Key
from ..meshing import face_regions
from ..model.roles import INTERNAL
from .colours import diverging_map
from .colours import rgba
from .layout import SIZE
from .legend import add_key
from .maps import vertex_values
from .projected_mesh import edge_array
from .projected_mesh import real_faces
from .view import View
from .view import frame_of
from .view import project
from .view import view_axes
from .view import view_named
from .zbuffer import Fragments
from .zbuffer import rasterise

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["STUDIO_VIEW", "studio", "studio_image"]

STUDIO_VIEW = View(-62.0, 24.0, 2.4)
TONES = ("#f6ead4", "#9ccad0", "#f0bfa4", "#cad8a8", "#c9cdea")
LINE = np.array([0.16, 0.17, 0.19])
SUN = np.array([-0.55, 0.45, 0.70])  # to the right, up, to the eye
SKIES = 60
SUNS = 12
SUN_ANGLE = 0.09  # half of the angular diameter of the sun, large for soft shadows [rad]
SHADOW_PIXELS = 300
KEY_ROWS, KEY_AT = 5.5, 1.8  # height of the key and place of its first row, relative to its font
KEY_LETTERS = 60  # that fit on a row of the key
FLOOR = 0.85  # half of the width of the floor, relative to the diagonal of the model


class _Scene(NamedTuple):
    """Corners of faces, their normals and their colours."""

    points: FloatArray  # (m, 3, 3) [L]
    normals: FloatArray  # (m, 3, 3)
    colours: FloatArray  # (m, 3)
    size: float  # diagonal [L]


@names_what_was_meant()
def studio(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    creases: Optional[ArrayLike] = None,
    *,
    curvature: Optional[ArrayLike] = None,
    view: Union[str, View] = STUDIO_VIEW,
    width: int = 1600,
    colours: Sequence[str] = TONES,
    key: Optional[Key] = None,
) -> Figure:
    """Return a rendering of a surface, smooth between creases, with soft shadows.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`; dummy faces are omitted.
    creases
        ``(e, 2)`` vertex indices of the edges along which the surface folds, drawn as lines.
    curvature
        ``(n,)`` K [1/L^2] of internal vertices for the colours: red positive, blue negative. Default: tones by region.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`; from above.
    width
        Width of the picture [pixel].
    colours
        Tones of regions; adjacent regions have different tones.
    key
        Unit, north and words of the key below the picture, see :func:`key_of`.

    Returns
    -------
    matplotlib.figure.Figure
        A figure for :func:`save`.

    Raises
    ------
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> from compas_cgc import CGCMesh
    >>> plan = CGCMesh.from_meshgrid(dx=4.0, nx=4).to_problem()
    >>> studio(plan.vertices, plan.faces, plan.roles, width=80).get_size_inches().tolist()[0]
    0.4
    """
    image = studio_image(vertices, faces, roles, creases, curvature=curvature, view=view, width=width, colours=colours)
    height = len(image) / 200
    size = min(SIZE, 72.0 * width / 200 / KEY_LETTERS)
    foot = KEY_ROWS * size / 72.0
    figure = new_figure(width / 200, height + foot)
    ax = figure.add_axes((0, foot / (height + foot), 1, height / (height + foot)))
    ax.set_axis_off()
    ax.imshow(image, interpolation="nearest", aspect="auto")
    view, F = view_named(view), np.asarray(faces, dtype=np.int64)
    surface = np.asarray(vertices, dtype=np.float64)[np.unique(F[real_faces(F, roles)])]
    scale = 72.0 / 200 * _camera(surface, view, surface, width).scale
    key = key or Key()
    colour = ["red: K > 0, blue: K < 0"] if curvature is not None else []
    # In perspective, lengths depend on the distance.
    perspective = ["scale: at the middle of the surface"] if np.isfinite(view.distance) else []
    words = (*key.words, *colour, *perspective)
    add_key(ax, key._replace(words=words), view_axes(view), KEY_AT * size, scale, size, 0.02)
    return figure


@names_what_was_meant()
def studio_image(
    vertices: ArrayLike,
    faces: ArrayLike,
    roles: ArrayLike,
    creases: Optional[ArrayLike] = None,
    *,
    curvature: Optional[ArrayLike] = None,
    view: Union[str, View] = STUDIO_VIEW,
    width: int = 1600,
    colours: Sequence[str] = TONES,
    oversampling: int = 2,
) -> FloatArray:
    """Return the picture of :func:`studio` as RGB values in 0..1 (h, w, 3).

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`.
    creases
        ``(e, 2)`` edges, as for :func:`studio`.
    curvature
        ``(n,)`` K [1/L^2] for the colours.
    view, width, colours
        As for :func:`studio`.
    oversampling
        Samples along each side of a pixel.

    Returns
    -------
    (h, w, 3) float64
        The picture, the first row at the top.

    Examples
    --------
    >>> from compas_cgc import CGCMesh
    >>> plan = CGCMesh.from_meshgrid(dx=4.0, nx=4).to_problem()
    >>> studio_image(plan.vertices, plan.faces, plan.roles, width=80).shape[1:]
    (80, 3)
    """
    view = view_named(view)
    V, F = np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64)
    F = F[real_faces(F, roles)]
    edges = edge_array(creases, np.ones(len(V), bool))
    K = None if curvature is None else np.where(np.asarray(roles) == INTERNAL, vertex_values(curvature, len(V), "curvature"), np.nan)
    scene = _scene(V, F, edges, K, colours)
    ground = _ground(V[F].reshape(-1, 3), int(np.clip(width // 4, 20, 220)))
    corners = np.concatenate([scene.points, ground])
    about = V[np.unique(F)]
    camera = _camera(V[F].reshape(-1, 3), view, about, width * oversampling)
    seen = rasterise(camera.sheet(corners), camera.height, camera.width)
    sky, sun = _directions(view)
    count = len(scene.points)
    floor = np.broadcast_to([0.0, 0.0, 1.0], ground.shape)
    normals = np.concatenate([scene.normals, floor])
    # Orient all normals towards the viewer.
    eye = view_axes(view)[2] if np.isinf(view.distance) else _towards(corners, view, about)
    normals = np.where((normals * eye).sum(axis=2, keepdims=True).mean(axis=1, keepdims=True) < 0, -normals, normals)
    light = _gathered(scene, corners, normals, sky, sun)
    light[count:] = _faded(light[count:], ground, sun[0])
    albedo = np.concatenate([scene.colours, np.full((len(ground), 3), 0.97)])
    image = _developed(seen, normals, light, albedo, eye, sun[0], count)
    _draw_lines(image, seen, camera, V, F, edges, scene.size, oversampling)
    h = image.shape[0] // oversampling
    return image[: h * oversampling].reshape(h, oversampling, width, oversampling, 3).mean(axis=(1, 3)).clip(0.0, 1.0)


def _scene(V: FloatArray, F: IntArray, edges: IntArray, curvature: Optional[FloatArray], colours: Sequence[str]) -> _Scene:
    regions = face_regions(F, edges)
    normal = face_normals(V, F)
    corner_angles = _corner_angles(V[F])
    # One normal per vertex and region: smooth within regions, folded between them.
    key, group = np.unique(regions[:, None] * len(V) + F, return_inverse=True)
    total = np.zeros((len(key), 3))
    np.add.at(total, group.reshape(-1), (corner_angles[:, :, None] * normal[:, None, :]).reshape(-1, 3))
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
    if curvature is None:
        if not len(colours):
            raise ArgumentError("colours must contain at least one tone, such as '#d8c3a5'")
        palette = np.array([rgba(colour)[:3] for colour in colours])
        tone = palette[_tones(F, regions) % len(palette)]
    else:
        K = curvature[F]
        known = np.isfinite(K)
        weight, sums = known.sum(axis=1), np.where(known, K, 0.0).sum(axis=1)
        whole = np.bincount(regions, sums) / np.maximum(np.bincount(regions, weight), 1)
        mean = np.where(weight > 0, sums / np.maximum(weight, 1), whole[regions])
        limit = 2.6 * max(float(np.abs(mean).max(initial=0.0)), 1e-300)
        tone = diverging_map()(np.clip(mean / limit, -1, 1) / 2 + 0.5)[:, :3]
    size = float(np.linalg.norm(np.ptp(V[F].reshape(-1, 3), axis=0)))
    return _Scene(V[F], total[group.reshape(F.shape)], tone, size)


def _tones(faces: IntArray, regions: IntArray) -> IntArray:
    """Return the number of a tone for every face (m,): few tones, but two for regions that share an edge."""
    sides = edge_faces(faces)[:, 2:]
    pairs = np.unique(regions[sides[(sides >= 0).all(axis=1)]], axis=0)
    beside: dict[int, set[int]] = {int(region): set() for region in np.unique(regions)}
    for a, b in pairs[pairs[:, 0] != pairs[:, 1]].tolist():
        beside[a].add(b)
        beside[b].add(a)
    tone: dict[int, int] = {}
    while len(tone) < len(beside):
        # Next the one with the most tones around it (DSATUR, doi:10.1145/359094.359101): two tones do where two can.
        around = {region: {tone[other] for other in beside[region] if other in tone} for region in beside if region not in tone}
        region = max(around, key=lambda r: len(around[r]))
        tone[region] = next(i for i in itertools.count() if i not in around[region])
    return np.array([tone[int(region)] for region in regions], dtype=np.int64)


def _corner_angles(points: FloatArray) -> FloatArray:
    """Return the angles of triangles (m, 3, 3) at their corners (m, 3)."""
    after, before = np.roll(points, -1, axis=1) - points, np.roll(points, 1, axis=1) - points
    return np.arctan2(np.linalg.norm(np.cross(after, before), axis=2), (after * before).sum(axis=2))


def _ground(points: FloatArray, n: int) -> FloatArray:
    """Return the triangles of the floor (g, 3, 3) within the shadow of a model, n squares per side."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, reach = (low + high) / 2, float(np.linalg.norm(high - low))
    t = FLOOR * reach * np.linspace(-1.0, 1.0, n + 1)
    x, y = np.meshgrid(middle[0] + t, middle[1] + t, indexing="ij")
    grid = np.stack([x, y, np.full_like(x, low[2] - 1e-3 * reach)], axis=-1)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3, 3), np.stack([a, c, d], axis=2).reshape(-1, 3, 3)])


class _Camera(NamedTuple):
    view: View
    about: FloatArray
    left: float
    top: float
    scale: float  # pixels per unit of length
    height: int
    width: int

    def sheet(self, points: FloatArray) -> FloatArray:
        """Return column, row and nearness of points (..., 3)."""
        flat = project(points.reshape(-1, 3), self.view, self.about)
        out = np.column_stack([(flat[:, 0] - self.left) * self.scale, (self.top - flat[:, 1]) * self.scale, flat[:, 2]])
        return out.reshape(points.shape)


def _camera(points: FloatArray, view: View, about: FloatArray, width: int) -> _Camera:
    frame = frame_of(project(points, view, about)[:, :2], margin=0.05)
    # Leave space for the shadow.
    tall = frame.height + 0.05 * frame.width
    scale = width / frame.width
    height = 2 * (int(round(tall * scale)) // 2)
    return _Camera(view, about, frame.left, frame.top, scale, height, width)


def _towards(corners: FloatArray, view: View, about: FloatArray) -> FloatArray:
    """Return the unit vectors from corners (m, 3, 3) to the eye."""
    low, high = about.min(axis=0), about.max(axis=0)
    eye = (low + high) / 2 + view_axes(view)[2] * view.distance * float(np.linalg.norm(high - low))
    ray = eye - corners
    return ray / np.linalg.norm(ray, axis=2, keepdims=True)


def _directions(view: View) -> tuple[FloatArray, FloatArray]:
    """Return directions to the sky (k, 3), uniform on its hemisphere (Fibonacci), and to the sun, its centre first."""
    i = np.arange(SKIES)
    z = (i + 0.5) / SKIES
    turn = np.pi * (3 - np.sqrt(5)) * i
    sky = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
    middle = SUN @ view_axes(view)
    middle = middle / np.linalg.norm(middle)
    across = np.linalg.svd(middle[None])[2][1:]
    j = np.arange(SUNS)
    radius = SUN_ANGLE * np.sqrt(j / SUNS)
    spread = radius[:, None] * (np.cos(2.4 * j)[:, None] * across[0] + np.sin(2.4 * j)[:, None] * across[1])
    sun = middle + spread
    return sky, sun / np.linalg.norm(sun, axis=1, keepdims=True)


def _gathered(scene: _Scene, corners: FloatArray, normals: FloatArray, sky: FloatArray, sun: FloatArray) -> FloatArray:
    """Return the light of the sky and of the sun at corners of faces (m, 3, 2)."""
    points, where = np.unique(np.concatenate([corners, np.round(normals, 3)], axis=2).reshape(-1, 6), axis=0, return_inverse=True)
    place, normal = points[:, :3], points[:, 3:]
    lifted = place + 4e-3 * scene.size * normal
    light = np.zeros((len(points), 2))
    for kind, directions in enumerate((sky, sun)):
        weight = 0.0
        for direction in directions:
            facing = normal @ direction
            lit = np.flatnonzero(facing > 0)
            light[lit, kind] += facing[lit] * _visible(scene.points, lifted[lit], direction)
            weight += direction[2] if kind == 0 else 1.0
        light[:, kind] /= weight
    return light[where.reshape(-1)].reshape(*corners.shape[:2], 2)


def _faded(light: FloatArray, ground: FloatArray, sun: FloatArray) -> FloatArray:
    """Return the light of the floor (g, 3, 2), blended to that of an open floor at its edge."""
    middle = ground.reshape(-1, 3).mean(axis=0)
    half = np.ptp(ground[:, :, 0]) / 2
    away = np.linalg.norm(ground - middle, axis=2) / half
    share = np.clip((away - 0.6) / 0.4, 0.0, 1.0)[:, :, None]
    return light * (1 - share) + np.array([1.0, sun[2]]) * share


def _visible(triangles: FloatArray, points: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the visibility (0..1) of a distant light from points (k, 3), by a shadow map with smooth edges."""
    axes = np.vstack([np.linalg.svd(direction[None])[2][1:], direction])
    flat = triangles @ axes.T
    low, high = flat[:, :, :2].reshape(-1, 2).min(axis=0), flat[:, :, :2].reshape(-1, 2).max(axis=0)
    scale = (SHADOW_PIXELS - 4) / float((high - low).max())
    on_map = np.concatenate([(flat[:, :, :2] - low) * scale + 2, flat[:, :, 2:]], axis=2)
    seen = rasterise(on_map, SHADOW_PIXELS, SHADOW_PIXELS).nearness
    own = points @ axes.T
    at = (own[:, :2] - low) * scale + 2 - 0.5
    base = np.floor(at).astype(np.int64)
    part = at - base
    total = np.zeros(len(points))
    for dx in (0, 1):
        for dy in (0, 1):
            x, y = base[:, 0] + dx, base[:, 1] + dy
            within = (x >= 0) & (y >= 0) & (x < SHADOW_PIXELS) & (y < SHADOW_PIXELS)
            nearest = np.where(within, seen[np.where(within, y, 0), np.where(within, x, 0)], -np.inf)
            share = np.where(dx, part[:, 0], 1 - part[:, 0]) * np.where(dy, part[:, 1], 1 - part[:, 1])
            total += share * (nearest <= own[:, 2])
    return total


def _developed(
    seen: Fragments, normals: FloatArray, light: FloatArray, albedo: FloatArray, eye: FloatArray, sun: FloatArray, count: int
) -> FloatArray:
    """Return the picture: light of sun and sky reflected by the faces, with some gloss."""
    shown = seen.face >= 0
    normal = seen.interpolated(normals)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    both = seen.interpolated(light)
    towards = seen.interpolated(eye) if eye.ndim == 3 else np.broadcast_to(eye, normal.shape)
    half = sun + towards
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    face = seen.face[shown]
    gloss = np.where(face < count, 0.10 * np.clip((normal * half).sum(axis=1), 0, 1) ** 40, 0.0)
    colour = albedo[face]
    warm, cool = np.array([1.0, 0.965, 0.90]), np.array([0.93, 0.97, 1.02])
    # Light reflected from the floor.
    bounce = 0.05 + 0.17 * (1 - normal[:, 2:]) * (face < count)[:, None]
    sent = colour * (0.62 * both[:, 1:] * warm + 0.52 * both[:, :1] * cool + bounce) + (gloss * np.minimum(1.0, 2 * both[:, 1]))[:, None]
    # The floor is white where it is not in shadow.
    open_floor = 0.62 * sun[2] * warm + 0.52 * cool + 0.05
    part = np.clip(sent / (0.97 * open_floor), 0.0, 1.0)
    sent = np.where((face >= count)[:, None], 1.0 - 0.62 * (1.0 - part), sent)
    image = np.ones((*seen.face.shape, 3))
    image[shown] = sent
    return image


def _draw_lines(
    image: FloatArray, seen: Fragments, camera: _Camera, V: FloatArray, F: IntArray, edges: IntArray, size: float, oversampling: int
) -> None:
    """Draw the visible parts of creases and open edges."""
    sides = edge_faces(F)
    open_edges = sides[sides[:, 3] < 0, :2]
    pixel = max(camera.width / oversampling / 1600, 0.7)
    for own, radius in ((open_edges, 0.8), (edges, 1.25)):
        if not len(own):
            continue
        ends = camera.sheet(V[own])
        lift = 0.012 * size
        steps = np.maximum(np.ceil(2 * np.linalg.norm(ends[:, 1, :2] - ends[:, 0, :2], axis=1)).astype(np.int64), 1)
        which = np.repeat(np.arange(len(own)), steps + 1)
        part = np.concatenate([np.linspace(0.0, 1.0, k + 1) for k in steps.tolist()])[:, None]
        at = ends[which, 0] * (1 - part) + ends[which, 1] * part
        _stamp(image, seen.nearness - lift, at, max(radius * oversampling * pixel, 0.5))


def _stamp(image: FloatArray, nearness: FloatArray, at: FloatArray, radius: float) -> None:
    """Draw black discs around points (k, 3) in front of the surface."""
    height, width = nearness.shape
    reach = int(np.ceil(radius))
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            x, y = np.floor(at[:, 0]).astype(np.int64) + dx, np.floor(at[:, 1]).astype(np.int64) + dy
            near = (x + 0.5 - at[:, 0]) ** 2 + (y + 0.5 - at[:, 1]) ** 2 <= radius**2
            keep = near & (x >= 0) & (y >= 0) & (x < width) & (y < height)
            x, y = x[keep], y[keep]
            free = nearness[y, x] <= at[keep, 2]
            image[y[free], x[free]] = LINE
