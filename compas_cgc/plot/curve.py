"""Plane curves with their gradients, as in Example 1."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import FloatArray
from ..errors import names_what_was_meant
from ..fabrication.picture_key import Key
from .colours import INK
from .colours import SUPPORT
from .layout import caption
from .layout import heading
from .layout import letter
from .layout import panels
from .layout import show
from .layout import shown
from .legend import add_key
from .view import Frame
from .view import frame_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Curve", "curve_figure", "draw_curve"]

MAX_ARROW = 0.12  # length of the longest arrow, relative to the width of the curve
ARROW = "#2b7bba"


class Curve(NamedTuple):
    """One picture of :func:`curve_figure`.

    Parameters
    ----------
    title
        Caption, such as "S1 with s = 0.8".
    points
        (n, 2) [L].
    gradient
        (n, 2).
    fixed
        Fixed vertices.
    breaks
        Vertices of the internal boundary.

    Examples
    --------
    >>> Curve("C1", np.zeros((3, 2))).title
    'C1'
    """

    title: str  # caption, such as "S1 with s = 0.8"
    points: FloatArray  # (n, 2) [L]
    gradient: Optional[FloatArray] = None  # (n, 2)
    fixed: Sequence[int] = (0, -1)  # fixed vertices
    breaks: Sequence[int] = ()  # vertices of the internal boundary


@names_what_was_meant()
def draw_curve(
    points: ArrayLike,
    gradient: Optional[ArrayLike] = None,
    fixed: Sequence[int] = (0, -1),
    breaks: Sequence[int] = (),
    ax: Optional[Axes] = None,
    *,
    frame: Optional[Frame] = None,
) -> Axes:
    """Draw a plane curve with arrows of the gradient, scaled so that the largest has the same length in every picture.

    Parameters
    ----------
    points
        ``(n, 2)`` polyline [L].
    gradient
        ``(n, 2)`` gradient of the energy at the vertices, in any unit.
    fixed
        Fixed vertices: red dots.
    breaks
        Vertices of the internal boundary: squares.
    ax
        Axes to draw on. Default: those of a new figure.
    frame
        Visible part of the plane. Default: everything.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ValueError
        If a shape is wrong.
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Figures 4-6.

    Examples
    --------
    >>> type(draw_curve(np.array([[0.0, 0], [1, 1], [2, 0]]))).__name__
    'Axes'
    """
    P, arrows = curve_arrays(points, gradient)
    shown = frame or curve_frame(P, arrows)
    sheet: Axes = panels([[shown]], width=4.0, foot=0.0)[1][0][0] if ax is None else ax
    if ax is not None:
        show(sheet, shown)
    long = np.linalg.norm(arrows, axis=1) > 0.02 * MAX_ARROW * width_of(P)
    if long.any():
        sheet.quiver(
            *P[long].T,
            *arrows[long].T,
            angles="xy",
            scale_units="xy",
            scale=1.0,
            units="dots",
            width=sheet.figure.dpi / 72 * 0.8,
            headwidth=4.5,
            headlength=5.5,
            headaxislength=5.0,
            color=ARROW,
            zorder=2,
        )
    sheet.plot(*P.T, color=INK, lw=1.0, marker="o", ms=2.2, mec=INK, mfc="white", mew=0.6, solid_joinstyle="round", zorder=3)
    sheet.plot(*P[list(breaks)].T, ls="", marker="s", ms=3.2, mec=INK, mfc="white", mew=0.9, zorder=4)
    sheet.plot(*P[list(fixed)].T, ls="", marker="o", ms=5.0, mec="white", mew=0.4, mfc=SUPPORT, zorder=5, clip_on=False)
    return sheet


@names_what_was_meant()
def curve_figure(curves: Sequence[Union[Curve, tuple[Any, ...]]], title: Optional[str] = None, *, unit: Optional[str] = None) -> Figure:
    """Return a figure of curves side by side at the same scale, with captions (a), (b), ...

    Parameters
    ----------
    curves
        A :class:`Curve` or a tuple of its fields per picture.
    title
        Title of the figure.
    unit
        Unit of length for the scale bar.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    ValueError
        If there is no curve, or a shape is wrong.
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> len(curve_figure([("an arch", np.array([[0.0, 0], [1, 1], [2, 0]]))]).axes)
    1
    """
    drawn = [curve if isinstance(curve, Curve) else Curve(*curve) for curve in curves]
    if not drawn:
        raise ValueError("curve_figure requires at least one curve")
    own = [curve_frame(*curve_arrays(curve.points, curve.gradient)) for curve in drawn]
    bottom, top = min(frame.bottom for frame in own), max(frame.top for frame in own)
    frames = [Frame(frame.left, frame.right, bottom, top) for frame in own]
    figure, (axes,) = panels([frames], head=0.25 if title else 0.0, foot=0.45)
    for i, (ax, curve) in enumerate(zip(axes, drawn)):
        draw_curve(*curve[1:], ax=ax, frame=shown(ax))
        caption(ax, f"{letter(i)} {curve.title}")
    add_key(axes[0], Key(unit or "", None))
    if title:
        heading(axes, title)
    return figure


def curve_arrays(points: ArrayLike, gradient: Optional[ArrayLike]) -> tuple[FloatArray, FloatArray]:
    """Return the points and the arrows to draw, both (n, 2)."""
    P = np.asarray(points, dtype=np.float64)
    if P.ndim != 2 or P.shape[1] != 2 or len(P) < 2:
        raise ValueError(f"points must have the shape (n, 2) with n >= 2, not {P.shape}")
    G = np.zeros_like(P) if gradient is None else np.asarray(gradient, dtype=np.float64)
    if G.shape != P.shape:
        raise ValueError(f"gradient must be one vector per point {P.shape}, not of shape {G.shape}")
    largest = float(np.linalg.norm(G, axis=1).max())
    return P, G * (MAX_ARROW * width_of(P) / largest if largest > 0 else 0.0)


def width_of(P: FloatArray) -> float:
    """Return the larger side of the bounding box of points [L]."""
    return float(np.ptp(P, axis=0).max())


def curve_frame(P: FloatArray, arrows: FloatArray) -> Frame:
    """Return the frame around a curve and its arrows."""
    return frame_of(np.concatenate([P, P + arrows]), margin=0.05)
