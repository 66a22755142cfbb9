"""Thumbnails: small shaded pictures of surfaces on one mesh, painted back to front."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..discrete import edge_faces
from ..discrete import face_normals
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..plot.colours import light_direction
from ..plot.view import Frame
from ..plot.view import View
from ..plot.view import project

__all__ = ["Image", "thumbnail"]

Image = NDArray[np.uint8]

VIEW = View(-58.0, 27.0)
OVERSAMPLING = 3  # samples per pixel, along each side
AMBIENT = 0.3  # brightness of a face parallel to the light
INK = (40, 40, 40)


def thumbnail(vertices: Vertices, faces: Faces, colour: Sequence[float], pixels: tuple[int, int], frame: Frame, creases: Edges) -> Image:
    """Return the picture of a surface (height, width, 3) on a white background.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    colour
        Red, green and blue in 0..1.
    pixels
        Width and height.
    frame
        Visible part of the projection, the same for all compared surfaces.
    creases
        ``(c, 2)`` edges that are drawn as lines, in addition to open edges.

    Raises
    ------
    CGCError
        If Pillow, a part of matplotlib, is not installed.
    """
    try:
        from PIL import Image as pillow
        from PIL import ImageDraw
    except ImportError:
        raise CGCError('drawing requires matplotlib: pip install "compas_cgc[plot]"') from None
    width, height = (OVERSAMPLING * number for number in pixels)
    seen = project(vertices, VIEW, vertices)
    places = (seen[:, :2] - [frame.left, frame.top]) * [width / frame.width, -height / frame.height]
    light = np.abs(face_normals(vertices, faces) @ light_direction(VIEW))
    shades = np.rint(255 * (AMBIENT + (1.0 - AMBIENT) * light)[:, None] * np.asarray(colour)[:3]).astype(int).tolist()
    image = pillow.new("RGB", (width, height), "white")
    draw = ImageDraw.Draw(image)
    corners, lines = places[faces].reshape(len(faces), 6).tolist(), _lines(places, faces, creases)
    for face in np.argsort(seen[faces, 2].mean(axis=1), kind="stable").tolist():
        draw.polygon(corners[face], fill=tuple(shades[face]))
        # Drawn together with the face, so that nearer faces hide them.
        for line in lines.get(face, ()):
            draw.line(line, fill=INK, width=OVERSAMPLING)
    return np.asarray(image.resize(pixels, pillow.Resampling.BOX))


def _lines(places: FloatArray, faces: Faces, creases: Edges) -> dict[int, list[list[float]]]:
    """Return the lines to draw with each face."""
    edges = edge_faces(faces)
    n = len(places)
    creased = np.isin(np.sort(edges[:, :2], axis=1) @ [n, 1], np.sort(creases, axis=1) @ [n, 1])
    found: dict[int, list[list[float]]] = {}
    for u, v, left, right in edges[(edges[:, 3] < 0) | creased].tolist():
        for face in (left, right):
            if face >= 0:
                found.setdefault(face, []).append([*places[u].tolist(), *places[v].tolist()])
    return found
