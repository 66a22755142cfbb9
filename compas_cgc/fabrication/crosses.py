"""Crosses: principal forces as two lines per face."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .membrane_state import MembraneState

__all__ = ["Crosses", "crosses"]

MAX_CROSSES = 1500  # more crosses cannot be distinguished in a picture


class Crosses(NamedTuple):
    """Lines with lengths proportional to principal forces."""

    faces: IntArray  # (k,)
    lines: FloatArray  # (2, k, 2, 3) start and end of the lines of N1 and N2 [L]
    forces: FloatArray  # (k, 2) [F/L]
    reaction_scale: float  # length per force for reactions [L/F]


def crosses(state: MembraneState, most: int = MAX_CROSSES) -> Crosses:
    """Return crosses at evenly chosen faces, scaled not to overlap; the largest 5 % of the forces are clipped."""
    V, F = state.problem.vertices, state.problem.faces
    chosen = np.unique(np.linspace(0, len(F) - 1, min(most, len(F))).astype(np.int64))
    corners = V[F[chosen]]
    room = float(np.median(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1))) * np.sqrt(len(F) / len(chosen))
    forces = state.forces[chosen]
    limit = float(np.percentile(np.abs(forces), 95)) or 1.0
    half = 0.5 * room * np.clip(np.abs(forces) / limit, 0.0, 1.0)
    centre = corners.mean(axis=1)
    reach = half.T[:, :, None] * state.directions[chosen].transpose(1, 0, 2)
    lines = np.stack([centre - reach, centre + reach], axis=2)
    size = np.linalg.norm(state.reactions, axis=1)
    typical = float(np.median(size[size > 0])) if (size > 0).any() else 1.0
    return Crosses(chosen, lines, forces, 2.0 * room / typical)
