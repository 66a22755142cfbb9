"""View projection: the paper's two views, and others."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Union

import numpy as np

from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask

__all__ = ["VIEWS", "Frame", "View", "frame_of", "project", "used_vertices", "view_axes", "view_named"]


class View(NamedTuple):
    """Where one looks from.

    Parameters
    ----------
    azimuth
        Of the eye about z, from the x-axis [deg].
    elevation
        Of the eye above the horizon [deg].
    distance
        Of the eye from the middle, in diagonals of the model; infinite: orthographic.

    Examples
    --------
    >>> View(-60.0, 30.0).distance
    inf
    """

    azimuth: float  # of the eye about z, from the x-axis [deg]
    elevation: float  # of the eye above the horizon [deg]
    distance: float = math.inf  # of the eye from the middle, in diagonals of the model; infinite: orthographic


class Frame(NamedTuple):
    """What of the sheet is shown."""

    left: float  # [L]
    right: float  # [L]
    bottom: float  # [L]
    top: float  # [L]

    @property
    def width(self) -> float:
        """Width [L]."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Height [L]."""
        return self.top - self.bottom

    def grown(self, width: float, height: float) -> Frame:
        """Return a frame of another size about the same middle."""
        x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
        return Frame(x - width / 2, x + width / 2, y - height / 2, y + height / 2)


VIEWS = {"diagonal": View(-60.0, 30.0), "plan": View(-90.0, 90.0)}


def view_named(view: Union[str, View]) -> View:
    """Return a view given by name or as it is.

    Raises
    ------
    ValueError
        If there is no view of that name.
    """
    if isinstance(view, str):
        if view not in VIEWS:
            raise ValueError(f"view must be one of {', '.join(VIEWS)} or a View, not {view!r}")
        return VIEWS[view]
    return View(*view)


def view_axes(view: View) -> FloatArray:
    """Return the unit vectors to the right, up, and to the eye, as rows (3, 3)."""
    a, e = math.radians(view.azimuth), math.radians(view.elevation)
    eye = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return np.stack([right, np.cross(eye, right), eye])


def project(points: FloatArray, view: View, about: FloatArray) -> FloatArray:
    """Project points on the sheet; planes stay planes, in a perspective too.

    Parameters
    ----------
    points
        ``(n, 3)`` coordinates [L].
    view
        Where one looks from.
    about
        ``(k, 3)`` points of the model that a perspective is centred on [L].

    Returns
    -------
    (n, 3) float64
        Coordinates on the sheet, and nearness to the eye: larger is nearer [L].
    """
    axes = view_axes(view)
    if math.isinf(view.distance):
        return points @ axes.T
    low, high = about.min(axis=0), about.max(axis=0)
    seen = (points - (low + high) / 2) @ axes.T
    return seen / (1.0 - seen[:, 2:] / (view.distance * float(np.linalg.norm(high - low))))


def frame_of(sheet: FloatArray, margin: float = 0.03) -> Frame:
    """Return the frame about points of the sheet ``(n, 2)``, with a margin in parts of its larger side."""
    if not len(sheet):
        return Frame(0.0, 1.0, 0.0, 1.0)
    low, high = sheet.min(axis=0), sheet.max(axis=0)
    pad = margin * (float((high - low).max()) or 1.0)
    return Frame(low[0] - pad, high[0] + pad, low[1] - pad, high[1] + pad)


def used_vertices(n: int, faces: Faces) -> Mask:
    """Mark the vertices of some faces (n,)."""
    used = np.zeros(n, bool)
    used[faces.ravel()] = True
    return used
