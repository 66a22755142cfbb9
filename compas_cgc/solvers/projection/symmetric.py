"""The symmetry of a drawing, kept in its surface to rounding."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from .gauss_newton import FINISH
from .gauss_newton import Taken
from .gauss_newton import descend
from .iterate import Point
from .symmetry import Image
from .system import System

__all__ = ["kept_symmetries", "made_symmetric", "symmetric_start"]

# distance of a surface from its image relative to the size, below which symmetry is intended; half and twice it give the same surfaces
NEAR = 2e-3
SYMMETRIC = (
    1e-14  # distance from its image relative to the size, up to which a surface is symmetric; 45 rounding errors of a turned coordinate
)


def kept_symmetries(vertices: FloatArray, size: float, symmetries: list[Image]) -> Optional[list[Image]]:
    """Return those symmetries of the drawing that a surface (n, 3) has nearly, None where they are no group or need no help.

    A saddle over a square has fewer than the square; those that it has lost are its own affair.
    """
    gaps = [_gap(vertices, image) for image in symmetries]
    kept = [image for image, gap in zip(symmetries, gaps) if gap <= NEAR * size]
    if len(kept) < 2 or max(gap for gap in gaps if gap <= NEAR * size) <= SYMMETRIC * size:
        return None
    known = {tuple(image.to.tolist()) for image in kept}
    closed = all(tuple(one.to[other.to].tolist()) in known for one in kept for other in kept)
    return kept if closed else None


def made_symmetric(system: System, equations: CurvatureEquations, vertices: FloatArray) -> Iterator[Taken]:
    """Take steps from the symmetric shape next to a surface to the equations, all of which a system with symmetries keeps."""
    yield from descend(system, equations, symmetric_start(system, equations, vertices), patience=FINISH)


def symmetric_start(system: System, equations: CurvatureEquations, vertices: FloatArray) -> Point:
    """Return the symmetric shape next to a surface."""
    return system.at(system.settled(system.places.symmetric(vertices)), equations)


def _gap(vertices: FloatArray, image: Image) -> float:
    moved = vertices @ image.turn.T + image.shift
    return float(np.abs(moved - vertices[image.to]).max())
