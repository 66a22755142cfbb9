"""Seams along level lines of K, for the fewest regions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter

from ..discrete.arrays import FloatArray
from ..errors import MeshError
from ..meshing.polyline import arc_lengths
from .clusters import clusterings
from .clusters import signed_root
from .curve_panels import Lengths
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["level_seams"]

GRID = 120  # samples of K along each parameter
SMOOTHING = 0.05  # of the size: waves of K that are shorter give no regions of their own
SMALLEST = 0.12  # of the size: level lines that are shorter are left out


def level_seams(surface: SplineSurface, moulds: int, rims: Sequence[FloatArray] = ()) -> list[FloatArray]:
    """Return the level lines (k, 2) of K between so many clusters of its signed root, on a surface with rims (k, 2).

    Raises
    ------
    MeshError
        If contourpy, which comes with matplotlib, is not installed.
    """
    try:
        from contourpy import contour_generator
    except ImportError:
        raise MeshError("seams along levels of K need contourpy; install it: pip install 'compas_cgc[plot]'") from None
    plane = Lengths.of(surface, rims)
    spans = [own[-1] for own in plane.lengths]
    axes = [np.linspace(0.0, span, GRID + 1) for span in spans]
    size = float(np.hypot(*spans))
    uv = plane.to_parameters(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2))
    K = surface.gaussian(uv).reshape(GRID + 1, GRID + 1)
    # Both ends of a parameter that closes are the same lines: one of them is left out, and repeated afterwards.
    once = tuple(slice(None, -1 if closes else None) for closes in surface.closed)
    modes = ["wrap" if closes else "nearest" for closes in surface.closed]
    K = gaussian_filter(K[once], [SMOOTHING * size * GRID / span for span in spans], mode=modes)
    K = np.pad(K, [(0, int(closes)) for closes in surface.closed], mode="wrap")
    curvature = signed_root(K)
    values, _ = next(clusterings([curvature.ravel()], within_rims(uv, rims).astype(np.float64), moulds, False))
    values = np.sort(values)
    lines: list[FloatArray] = []
    generator = contour_generator(axes[0], axes[1], curvature.T)
    for low, high in zip(values[:-1], values[1:]):
        for traced in generator.lines(0.5 * (low + high)):
            line = np.asarray(traced, dtype=np.float64)
            if arc_lengths(np.column_stack([line, np.zeros(len(line))]))[-1] >= SMALLEST * size:
                lines.append(plane.to_parameters(_smooth(line)))
    return lines


def _smooth(line: FloatArray) -> FloatArray:
    """Return a level line (k, 2) without the corners of the grid it was traced on."""
    closed = bool(np.allclose(line[0], line[-1]))
    smooth = gaussian_filter(line[:-1] if closed else line, [2.0, 0.0], mode="wrap" if closed else "nearest")
    if closed:
        return np.concatenate([smooth, smooth[:1]])
    smooth[0], smooth[-1] = line[0], line[-1]
    return smooth
