"""Seams along level lines of K, for the fewest regions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.ndimage import label

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..errors import MeshError
from ..meshing.polyline import arc_lengths
from .clusters import clusterings
from .clusters import signed_root
from .creases import continued
from .curve_panels import Lengths
from .curve_panels import parameter_rim
from .rims import within_rims
from .spline_surface import SplineSurface

__all__ = ["level_seams"]

GRID = 120  # samples of K along each parameter
SMOOTHING = 0.05  # of the size: waves of K that are shorter give no regions of their own
SMALLEST = 0.12  # of the size: level lines that are shorter are left out
NECK = 0.02  # of the size: lines across regions with hills and bowls that are shorter are left out


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
    principal = surface.principal(uv)[0].reshape(GRID + 1, GRID + 1, 2)
    # Both ends of a parameter that closes are the same lines: one of them is left out, and repeated afterwards.
    once = tuple(slice(None, -1 if closes else None) for closes in surface.closed)
    modes = ["wrap" if closes else "nearest" for closes in surface.closed]
    widths = [SMOOTHING * size * GRID / span for span in spans]

    def smoothed(values: FloatArray) -> FloatArray:
        filtered = gaussian_filter(values[once], widths, mode=modes)
        return np.pad(filtered, [(0, int(closes)) for closes in surface.closed], mode="wrap")

    curvature, mean = signed_root(smoothed(principal.prod(axis=2))), smoothed(principal.mean(axis=2))
    values, _ = next(clusterings([curvature.ravel()], within_rims(uv, rims).astype(np.float64), moulds, False))
    values = np.sort(values)
    levels = 0.5 * (values[:-1] + values[1:])

    def traced(field: FloatArray, level: float, least: float) -> list[FloatArray]:
        found = [np.asarray(line, dtype=np.float64) for line in contour_generator(axes[0], axes[1], field.T).lines(level)]
        long = [line for line in found if arc_lengths(np.column_stack([line, np.zeros(len(line))]))[-1] >= least * size]
        return [plane.to_parameters(_smooth(line)) for line in long]

    lines = [line for level in levels for line in traced(curvature, level, SMALLEST)]
    both = _hills_and_bowls(curvature, mean, levels, within_rims(uv, rims).reshape(mean.shape))
    between = traced(np.ma.masked_array(mean, ~both), 0.0, NECK) if both.any() else []
    closing = [np.concatenate([rim, rim[:1]]) for rim in rims or [parameter_rim(surface)]]
    return lines + continued(plane, between, [*lines, *closing], size / GRID)


def _hills_and_bowls(curvature: FloatArray, mean: FloatArray, levels: FloatArray, inside: Mask) -> Mask:
    """Return the places (a, b) of regions with hills and bowls, which no surface of one K has: lines of mean curvature 0 divide them."""
    low, high = levels[levels < 0.0].max(initial=-np.inf), levels[levels > 0.0].min(initial=np.inf)
    regions, count = label((curvature > low) & (curvature < high) & inside)
    raised = (curvature > 0.0) & (regions > 0)
    areas = [np.bincount(regions[raised & (sign * mean > 0.0)], minlength=count + 1) for sign in (1.0, -1.0)]
    has_both = np.minimum(areas[0], areas[1]) >= (SMALLEST * GRID) ** 2
    return has_both[regions]


def _smooth(line: FloatArray) -> FloatArray:
    """Return a level line (k, 2) without the corners of the grid it was traced on."""
    closed = bool(np.allclose(line[0], line[-1]))
    smooth = gaussian_filter(line[:-1] if closed else line, [2.0, 0.0], mode="wrap" if closed else "nearest")
    if closed:
        return np.concatenate([smooth, smooth[:1]])
    smooth[0], smooth[-1] = line[0], line[-1]
    return smooth
