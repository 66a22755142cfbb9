"""Benchmark of the curvature kernel against libigl."""

from __future__ import annotations

from functools import partial

import numpy as np

from ...discrete import gaussian_curvature
from .timing import best_of

__all__ = ["kernel_ratio"]


def kernel_ratio(sizes: tuple[int, ...] = (23, 71, 224)) -> list[dict]:
    """Return the time of :func:`gaussian_curvature` relative to the two corresponding functions of libigl, on wavy grids.

    Parameters
    ----------
    sizes
        Number of squares per side.

    Returns
    -------
    list of dict
        Results by name, one dict per size.

    Raises
    ------
    ImportError
        If libigl is not installed.

    Examples
    --------
    >>> kernel_ratio((23,))[0]["ratio"]  # doctest: +SKIP
    """
    import igl

    rows = []
    for n in sizes:
        i, j = np.divmod(np.arange(n * n), n)
        vertices = np.column_stack([i, j, np.sin(0.3 * i) * np.cos(0.2 * j)]).astype(float)
        a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        faces = np.column_stack([a, a + n, a + n + 1, a, a + n + 1, a + 1]).reshape(-1, 3)

        def theirs(vertices: np.ndarray = vertices, faces: np.ndarray = faces) -> None:
            igl.gaussian_curvature(vertices, faces)
            igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_VORONOI)

        ours = best_of(partial(gaussian_curvature, vertices, faces), budget=0.3)
        other = best_of(theirs, budget=0.3)
        rows.append({"vertices": n * n, "seconds": ours, "libigl_seconds": other, "ratio": ours / other})
    return rows
