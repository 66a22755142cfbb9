"""Strains of flat pieces."""

from __future__ import annotations

import numpy as np

from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from .flattening import principal_strains
from .patchwork import Patchwork

__all__ = ["strains_of"]

NO_AREA = 1e-20  # area of a face, relative to the squared size, that counts as zero


def strains_of(own: Patchwork, faces: np.ndarray) -> FloatArray:
    """Return the principal strains of faces (k, 2), for every mesh face those of its largest part."""
    areas, parents = face_areas(own.space, own.faces[faces]), own.parent[faces]
    order = np.lexsort((-areas, parents, own.piece[faces]))
    key = own.piece[faces].astype(np.int64) * (int(parents.max()) + 1) + parents
    _, first, inverse = np.unique(key[order], return_index=True, return_inverse=True)
    # A part without area has no strain of its own.
    largest = order[first]
    sound = areas[largest] > NO_AREA * own.size() ** 2
    flat = np.zeros((len(largest), 2))
    flat[sound] = principal_strains(own.space, own.faces[faces][largest[sound]], own.plane[faces][largest[sound]])[0]
    strains = np.empty((len(areas), 2))
    strains[order] = flat[inverse.ravel()]
    return strains
