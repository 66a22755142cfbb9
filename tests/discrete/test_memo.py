"""Memory of meshes: what is returned belongs to the caller, and other arguments are other results."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import topology
from compas_cgc.discrete._memo import MAX_BYTES
from compas_cgc.discrete._memo import MAX_SOLVE_BYTES
from compas_cgc.discrete._memo import remembered
from compas_cgc.discrete._memo import remembering
from compas_cgc.paper.benchmarks.solves import square

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

    small, large = np.arange(5.0), np.arange(float(MAX_BYTES))
    for values in (small, small, large, large):
        assert np.array_equal(doubled(values, 2), 2 * values)
    assert calls == [5, MAX_BYTES, MAX_BYTES]
    assert np.array_equal(doubled(small.astype(int), 2), 2 * small) and doubled(small, 3)[1] == 3.0
    for k in range(20):
        doubled(np.full(3, k), 2)
    calls.clear()
    doubled(small, 2)
    assert calls == [5]


def test_larger_ones_are_kept_for_the_time_of_a_block_and_no_longer():
    calls = []

    @remembered
    def doubled(values):
        calls.append(len(values))
        return 2.0 * values

    large, huge = np.arange(float(MAX_BYTES)), np.empty(MAX_SOLVE_BYTES // 8 + 1)
    with pytest.raises(KeyError), remembering():
        doubled(large)[0] = 7.0
        with remembering():
            assert doubled(large)[0] == 0.0
        assert doubled(large)[0] == 0.0 and doubled(1.0 + large)[0] == 2.0
        assert doubled(large.astype(np.float32)).dtype == np.float32
        assert calls == 3 * [MAX_BYTES]
        doubled(huge)
        doubled(huge)
        raise KeyError
    doubled(large)
    assert calls == [*3 * [MAX_BYTES], *2 * [len(huge)], MAX_BYTES]


@pytest.mark.nightly
def test_a_solve_looks_for_the_edges_of_a_large_mesh_once(monkeypatch):
    looked = []
    lexsort = np.lexsort
    monkeypatch.setattr(topology.np, "lexsort", lambda keys: looked.append(b"".join(own.tobytes() for own in keys)) or lexsort(keys))
    problem = square(211)
    assert problem.faces.nbytes > MAX_BYTES
    assert solve(problem).verdict.fair
    # Curvature is read on other triangles in the corners, whose edges are looked for once, too.
    assert len(set(looked)) == len(looked) >= 2
