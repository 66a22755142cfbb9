"""What names of supports stand for."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.cli import arguments
from compas_cgc.meshing.boundary import SUPPORT_NAMES
from compas_cgc.meshing.boundary import named_supports

# Two frames of 8 triangles: a square of 3 with a hole of 1, and the same again beside it.
RING = np.array([[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]], float)
FRAME = np.array([[k, (k + 1) % 4, 4 + k] for k in range(4)] + [[(k + 1) % 4, 4 + (k + 1) % 4, 4 + k] for k in range(4)])
VERTICES, FACES = np.concatenate([RING, RING + [5, 0, 0]]), np.concatenate([FRAME, FRAME + 8])


@pytest.mark.parametrize(
    "name, expected",
    [("boundary", range(16)), ("outline", [0, 1, 2, 3, 8, 9, 10, 11]), ("corners", range(16))],
)
def test_the_outline_is_that_of_each_piece_without_its_holes(name, expected):
    assert name in SUPPORT_NAMES and sorted(named_supports(VERTICES, FACES, name).tolist()) == list(expected)


def test_the_command_line_takes_the_same_names():
    assert arguments.SUPPORT_NAMES == SUPPORT_NAMES


def test_another_name_is_refused_with_those_that_there_are():
    with pytest.raises(ValueError, match="'boundary', 'outline' or 'corners', not 'edge'"):
        named_supports(VERTICES, FACES, "edge")
