"""Picture of a rationalised design: its panels by mould, and its distance from the design."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..meshing.boundary import boundary_loops
from ..model.counts import counted
from ..model.visible import PLAN_SHARE
from .result import Rationalised

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["panels_figure"]

OBLIQUE = np.array([1.0, -2.0, 1.0]) / np.sqrt(6.0)  # towards the viewer of a surface that faces no direction


def panels_figure(found: Rationalised) -> Figure:
    """Return a picture of the panels in the colours of their moulds, beside a map of the signed distance from the design.

    The design is seen along the direction that most of it faces; a closed one, or a tube, obliquely from above and from in front.

    Parameters
    ----------
    found
        A rationalised design.

    Returns
    -------
    matplotlib.figure.Figure
        Panels on the left, distances [L] on the right.

    Raises
    ------
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> from compas_cgc.plot import save
    >>> save(panels_figure(found), "panels.png")  # doctest: +SKIP
    """
    from .._figures import matplotlib_module
    from .._figures import new_figure
    from ..fabrication.picture_key import key_of
    from ..plot.colours import PALETTE
    from ..plot.colours import diverging_map
    from ..plot.colours import limit_above
    from ..plot.legend import add_key

    V, F = found.result.vertices, found.result.problem.faces
    axes_of_view = _axes(V, F)
    plane = V @ axes_of_view.T
    a, b, c = (plane[F[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    outwards = np.sign(np.einsum("fx,fx->", cross, (a + b + c) / 3.0 - plane.mean(axis=0))) if _is_around(cross) else 1.0
    front = outwards * cross[:, 2] > 0.0
    shown = np.flatnonzero(front)[np.argsort(plane[F[front], 2].mean(axis=1), kind="stable")]
    triangles = matplotlib_module("tri").Triangulation(plane[:, 0], plane[:, 1], F[shown])
    width, height = np.ptp(plane[:, :2], axis=0)
    figure = new_figure(12.0, min(9.0, 1.2 + 5.4 * height / max(width, 1e-12)))
    colours = matplotlib_module("colors")
    seen = np.zeros(len(V), bool)
    seen[F[shown]] = True
    rims = [np.append(loop, loop[0]) for loop in boundary_loops(F)]
    drawn = np.concatenate([found.panelling.seams, *(np.column_stack([rim[:-1], rim[1:]]) for rim in rims)])
    lines = list(plane[drawn[seen[drawn].all(axis=1)], :2])
    count = len(found.curvatures)
    shades = colours.ListedColormap([PALETTE[k % len(PALETTE)] for k in range(count)])
    limit = limit_above(found.distance.signed)
    key = key_of(found.result)._replace(words=(), north=found.design.drawing.north)
    unit = key.unit or "L"
    for k in range(2):
        axes = figure.add_subplot(1, 2, k + 1)
        axes.set_aspect("equal")
        axes.set_axis_off()
        if k == 0:
            values = found.classes[found.panels[shown]].astype(np.float64)
            filled = axes.tripcolor(triangles, facecolors=values, cmap=shades, vmin=-0.5, vmax=count - 0.5)
            bar = figure.colorbar(filled, ax=axes, ticks=range(count), shrink=0.7)
            bar.ax.set_yticklabels([f"{K:.3g}" for K in found.curvatures])
            bar.set_label(f"K of the mould [1/{unit}²]")
            axes.set_title(f"{counted(len(found.classes), 'panel')} on {counted(count, 'mould')}", fontsize=10)
        else:
            field = axes.tripcolor(triangles, found.distance.signed, cmap=diverging_map(), vmin=-limit, vmax=limit, shading="gouraud")
            figure.colorbar(field, ax=axes, shrink=0.7).set_label(f"distance [{unit}]")
            axes.set_title("distance from the design", fontsize=10)
        drawn_lines = matplotlib_module("collections").LineCollection(lines, colors="#1a1a1a", linewidths=0.5)
        # Snapped to pixels, single segments of a smooth seam would jump.
        drawn_lines.set_snap(False)
        axes.add_collection(drawn_lines)
    figure.tight_layout(rect=(0.0, 0.4 / figure.get_size_inches()[1], 1.0, 1.0))
    add_key(figure.axes[0], key, axes_of_view)
    return figure


def _axes(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return two directions across the view and the one towards the viewer (3, 3)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    facing = cross.sum(axis=0)
    normal = OBLIQUE if _is_around(cross) else facing / np.linalg.norm(facing)
    side = np.array([1.0, 0.0, 0.0]) if abs(normal[2]) > 0.7 else np.cross([0.0, 0.0, 1.0], normal)
    side = side - (side @ normal) * normal
    side = side / np.linalg.norm(side)
    return np.array([side, np.cross(normal, side), normal])


def _is_around(cross: np.ndarray) -> bool:
    """Return whether a surface with area vectors (m, 3) closes around something, rather than facing one way."""
    return bool(np.linalg.norm(cross.sum(axis=0)) <= PLAN_SHARE * np.linalg.norm(cross, axis=1).sum())
