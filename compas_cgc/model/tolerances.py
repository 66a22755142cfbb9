"""Relative tolerances that the model and the solvers share."""

from __future__ import annotations

__all__ = ["DRAWING_ACCURACY", "NEGLIGIBLE", "ROUNDING", "UPRIGHT_COSINE"]

ROUNDING = 1e-12  # relative size up to which a number counts as zero; 4,500 rounding errors, as sums over the vertices of a mesh collect
NEGLIGIBLE = 1e-9  # relative difference up to which shapes and numbers count as equal; a micrometre on a roof of one kilometre
DRAWING_ACCURACY = 1e-6  # distance relative to the size that a drawing does not resolve; files often hold six decimals
UPRIGHT_COSINE = 1e-12  # 1 - cosine of the tilt up to which an axis counts as vertical; a tilt of 1.4e-6, as accurate as drawings are
