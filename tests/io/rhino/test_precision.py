"""One rule for coordinates that have been rounded to single precision."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.io.rhino.precision import rounding_of

THIRDS = np.array([[1 / 3, 2 / 3, 1000 / 3], [5.0, -2000 / 3, 0.0]])


@pytest.mark.parametrize(
    "vertices, double, rounded",
    [
        (THIRDS, True, False),
        (THIRDS.astype(np.float32).astype(float), True, True),
        (THIRDS.astype(np.float32).astype(float), False, True),
        (np.array([[0.5, 2.0, 0.25]]), True, False),  # short decimals by design
        (np.array([[0.5, 2.0, 0.25]]), False, True),
        (np.array([[1e300, 1 / 3, 0.0]]), True, False),
        (np.empty((0, 3)), True, False),
    ],
)
def test_singles_are_told_from_doubles(vertices, double, rounded):
    rounding = rounding_of(vertices, double)
    assert (rounding > 0) is rounded
    if rounded:
        assert np.abs(THIRDS - THIRDS.astype(np.float32)).max() <= rounding_of(THIRDS.astype(np.float32).astype(float), double)
