"""View projection: the two views of the paper, and others."""

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
    """Direction and distance of the viewer.

    Parameters
    ----------
    azimuth
        Angle of the viewer about z, from the x-axis [deg].
    elevation
        Angle of the viewer above the horizon [deg].
    distance
        Distance of the viewer from the centre, relative to the diagonal of the model; infinite: orthographic.

    Examples
    --------
    >>> View(-60.0, 30.0).distance
    inf
    """

    azimuth: float  # angle of the viewer about z, from the x-axis [deg]
    elevation: float  # angle of the viewer above the horizon [deg]
    distance: float = math.inf  # from the centre, relative to the diagonal of the model; infinite: orthographic


class Frame(NamedTuple):
    """Visible part of the projection plane."""

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
        """Return a frame of another size with the same centre."""
        x, y = (self.left + self.right) / 2, (self.bottom + self.top) / 2
        return Frame(x - width / 2, x + width / 2, y - height / 2, y + height / 2)


VIEWS = {"diagonal": View(-60.0, 30.0), "plan": View(-90.0, 90.0)}


def view_named(view: Union[str, View]) -> View:
    """Return a view from its name or a :class:`View`.

    Raises
    ------
    ValueError
        If the name is unknown.
    """
    if isinstance(view, str):
        if view not in VIEWS:
            raise ValueError(f"view must be one of {', '.join(VIEWS)} or a View, not {view!r}")
        return VIEWS[view]
    return View(*view)


def view_axes(view: View) -> FloatArray:
    """Return the unit vectors to the right, upwards, and to the viewer, as rows (3, 3)."""
    a, e = math.radians(view.azimuth), math.radians(view.elevation)
    eye = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return np.stack([right, np.cross(eye, right), eye])


def project(points: FloatArray, view: View, about: FloatArray) -> FloatArray:
    """Project points; planes remain planes, also in perspective.

    Parameters
    ----------
    points
        ``(n, 3)`` coordinates [L].
    view
        Direction and distance of the viewer.
    about
        ``(k, 3)`` points of the model, the centre of the perspective [L].

    Returns
    -------
    (n, 3) float64
        Projected coordinates, and nearness to the viewer: larger is nearer [L].
    """
    axes = view_axes(view)
    if math.isinf(view.distance):
        return points @ axes.T
    low, high = about.min(axis=0), about.max(axis=0)
    seen = (points - (low + high) / 2) @ axes.T
    return seen / (1.0 - seen[:, 2:] / (view.distance * float(np.linalg.norm(high - low))))


def frame_of(sheet: FloatArray, margin: float = 0.03) -> Frame:
    """Return the frame around projected points ``(n, 2)``, with a margin relative to its larger side."""
    if not len(sheet):
        return Frame(0.0, 1.0, 0.0, 1.0)
    low, high = sheet.min(axis=0), sheet.max(axis=0)
    pad = margin * (float((high - low).max()) or 1.0)
    return Frame(low[0] - pad, high[0] + pad, low[1] - pad, high[1] + pad)


def used_vertices(n: int, faces: Faces) -> Mask:
    """Return a mask (n,) of the vertices of faces."""
    used = np.zeros(n, bool)
    used[faces.ravel()] = True
    return used
