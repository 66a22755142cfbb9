"""Jumps of the bending of a surface, measured in its tangent planes."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.model.faults import _within


def test_only_the_part_of_a_tensor_in_the_tangent_plane_counts():
    draw = np.random.default_rng(3)
    tensors, normals = draw.normal(size=(20, 3, 3)), draw.normal(size=(20, 3))
    tensors += np.swapaxes(tensors, 1, 2)
    n = normals / np.linalg.norm(normals, axis=1)[:, None]
    P = np.eye(3) - n[:, :, None] * n[:, None, :]
    twice = np.sqrt(2.0)
    rows = np.stack([tensors[:, i, j] * (1.0 if i == j else twice) for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))], axis=1)
    assert _within(rows, normals) == pytest.approx(np.linalg.norm(P @ tensors @ P, axis=(1, 2)))
