"""Starts for patchworks: many regions, some of K > 0 and some of K < 0, whose gentlest moves leave most of them flat."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import ArpackError

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from .iterate import Point
from .modes import bending_modes
from .system import System

__all__ = ["combined_modes"]

FEWEST = 4  # regions of a patchwork
UNEVEN = 0.3  # what the best single mode leaves of the regions' curvature, by squares, from which others are combined
MODES = 24  # that are combined, and of how many the searches set out
SINGLE, PAIRED = 8, 6
SMALL = 0.1  # weight of the coefficients against what the regions lack: of two combinations as near the smaller one
STEPS = 30  # of the searches
PROBE = 1e-3  # length of a move, against the size, by which its curvature is measured
FOUND = 2  # combinations that are handed back
ALIKE = 0.9  # cosine of coefficients from which two are the same
DAMPED = 1e-3, 0.3, 4.0  # damping of a step at first, and its change after a good and a bad one


class _Curvature(NamedTuple):
    """What combinations of modes bring to every region, weighed so that squares sum up to one where nothing is brought."""

    forms: FloatArray  # (r, m, m) quadratic in the coefficients
    wanted: FloatArray  # (r,)

    def lacking(self, c: FloatArray) -> FloatArray:
        """Return what coefficients (s, m) miss, and the coefficients themselves with their weight (s, r + m)."""
        brought = np.einsum("rij,si,sj->sr", self.forms, c, c, optimize=True)
        return np.concatenate([brought - self.wanted, SMALL * c], axis=1)


def combined_modes(system: System, equations: CurvatureEquations, plate: Point, modes: list[FloatArray]) -> list[FloatArray]:
    """Return moves of a plate (n, 3) that bring all regions of a patchwork near to their curvature at once, the nearest first.

    A single mode bends a few regions and leaves the others flat. These then take either of the ways to bend that
    are mirror images of each other, and a line is left where the one meets the other. What several modes bring together is
    quadratic in their coefficients: least squares over the regions, from single modes and pairs of them, say how much of each.

    Parameters
    ----------
    system, equations
        The problem.
    plate
        The flat shape.
    modes
        Of the plate, (n, 3) each, the most effective first.

    Returns
    -------
    list of (n, 3) float64
        None where the regions are few, have K of one sign, or a single mode serves them.
    """
    patches, lacking = system.patches, -plate.residual[: len(system.rows)]
    patchwork = patches.max(initial=-1) + 1 >= FEWEST and (lacking > 0.0).any() and (lacking < 0.0).any()
    if not patchwork or not modes or min(_left(_curvature(system, equations, plate, [mode])) for mode in modes) <= UNEVEN:
        return []
    try:
        many = bending_modes(system, equations, plate.vertices, lacking, min(MODES, len(system.columns) // 3))
    except ArpackError:
        return []
    curvature = _curvature(system, equations, plate, many)
    signed = np.einsum("rii,r->i", curvature.forms, curvature.wanted)
    scale = 1.0 / np.sqrt(np.maximum(signed, 1e-12 * signed.max(initial=0.0)))
    curvature = curvature._replace(forms=curvature.forms * (scale[:, None] * scale))
    found = _least_squares(curvature, _guesses(len(many)))
    order = np.argsort((curvature.lacking(found) ** 2).sum(axis=1), kind="stable")
    kept: list[FloatArray] = []
    for c in found[order]:
        if len(kept) < FOUND and all(abs(c @ other) < ALIKE * np.linalg.norm(c) * np.linalg.norm(other) for other in kept):
            kept.append(c)
    return [np.einsum("i,ijk->jk", c * scale, np.asarray(many)) for c in kept]


def _curvature(system: System, equations: CurvatureEquations, plate: Point, modes: list[FloatArray]) -> _Curvature:
    patches, m, a = system.patches, len(modes), PROBE * system.size
    count = int(patches.max()) + 1

    def brought(move: FloatArray) -> FloatArray:
        change = system.at(plate.vertices + a * move, equations).residual - plate.residual
        return np.bincount(patches, change[: len(patches)], count) / a**2

    own = [brought(mode) for mode in modes]
    forms = np.zeros((count, m, m))
    for i in range(m):
        forms[:, i, i] = own[i]
        for j in range(i):
            forms[:, i, j] = forms[:, j, i] = 0.5 * (brought(modes[i] + modes[j]) - own[i] - own[j])
    wanted = np.bincount(patches, -plate.residual[: len(patches)], count)
    total = max(float(np.abs(wanted).sum()), np.finfo(float).tiny)
    # By the roots of what is wanted, so that a region counts as its curvature does.
    weight = 1.0 / np.sqrt(np.maximum(np.abs(wanted), 1e-9 * total) * total)
    return _Curvature(weight[:, None, None] * forms, weight * wanted)


def _left(curvature: _Curvature) -> float:
    """Return what the best amount of a single mode leaves of the curvature, by squares."""
    form, wanted = curvature.forms[:, 0, 0], curvature.wanted
    amount = max(0.0, float(form @ wanted) / max(float(form @ form), np.finfo(float).tiny))
    return float(np.sum((amount * form - wanted) ** 2))


def _guesses(m: int) -> FloatArray:
    """Return coefficients (s, m) of single modes and of pairs, either way."""
    single = np.eye(m)[:SINGLE]
    pairs = [np.sqrt(0.5) * (single[i] + side * single[j]) for i in range(min(PAIRED, len(single))) for j in range(i) for side in (1, -1)]
    return np.vstack([single, *pairs])


def _least_squares(curvature: _Curvature, c: FloatArray) -> FloatArray:
    """Return the coefficients (s, m) that the method of Levenberg and Marquardt comes to from others, all at once."""
    s, m = c.shape
    damping, better, worse = np.full(s, DAMPED[0]), DAMPED[1], DAMPED[2]
    missed = curvature.lacking(c)
    for _ in range(STEPS):
        slope = np.concatenate(
            [2.0 * np.einsum("rij,sj->sri", curvature.forms, c, optimize=True), np.broadcast_to(SMALL * np.eye(m), (s, m, m))], axis=1
        )
        normal = slope.transpose(0, 2, 1) @ slope
        held = damping * np.trace(normal, axis1=1, axis2=2) / m
        down = (slope.transpose(0, 2, 1) @ missed[..., None])[..., 0]
        tried = c - np.linalg.solve(normal + held[:, None, None] * np.eye(m), down[..., None])[..., 0]
        then = curvature.lacking(tried)
        good = (then**2).sum(axis=1) < (missed**2).sum(axis=1)
        c, missed = np.where(good[:, None], tried, c), np.where(good[:, None], then, missed)
        damping = np.where(good, better * damping, worse * damping)
    return c
