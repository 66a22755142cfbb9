"""Memory of small meshes: what is returned belongs to the caller, and other arguments are other results."""

from __future__ import annotations

import numpy as np

from compas_cgc.discrete import edge_faces
from compas_cgc.discrete._memo import SMALL
from compas_cgc.discrete._memo import remembered

FACES = np.array([[0, 1, 2], [0, 2, 3]])


def test_what_is_returned_can_be_changed_without_changing_what_is_returned_next():
    first = edge_faces(FACES)
    known = first.copy()
    first[:] = -7
    assert np.array_equal(edge_faces(FACES), known)
    assert not np.array_equal(edge_faces(FACES[:, ::-1]), known)


def test_only_small_arguments_are_kept_and_only_the_last_ones():
    calls = []

    @remembered
    def doubled(values, factor):
        calls.append(len(values))
        return factor * values

    small, large = np.arange(5.0), np.arange(float(SMALL))
    for values in (small, small, large, large):
        assert np.array_equal(doubled(values, 2), 2 * values)
    assert calls == [5, SMALL, SMALL]
    assert np.array_equal(doubled(small.astype(int), 2), 2 * small) and doubled(small, 3)[1] == 3.0
    for k in range(20):
        doubled(np.full(3, k), 2)
    calls.clear()
    doubled(small, 2)
    assert calls == [5]
