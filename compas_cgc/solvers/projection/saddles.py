"""Saddles: the last step to K < 0 on irregular meshes.

Faces have angles of more than 2π between them only where their edges go up and down by turns. Where the layout of a mesh lies across
the saddle that is asked for no small move of a vertex changes its angles towards that, so least-norm steps come to rest beside it, or
creep. Then its star is folded by itself, along the normal and the way in which its angles grow fastest, to second order.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Optional

import numpy as np

from ...discrete import face_normals
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import space_form_angle_sums
from ...model.laws import types_of
from ..constants import WORTHWHILE
from .gauss_newton import FINISH
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .gauss_newton import descend
from .gauss_newton import descend_to_rounding
from .iterate import Point
from .system import System

__all__ = ["descend_over_saddles"]

ROUNDS = 40  # rounds of folding stars and steps [rounds]; bounds the time
CREEPING = 0.3  # factor on the merit in FINISH steps, above which a star is stuck; steps that are not stuck gain more
PATIENCE = 5  # rounds that have to gain [rounds]; folding one star may need its neighbours folded, too
GAIN = 0.7  # factor on the residual in PATIENCE rounds; slower searches do not converge within ROUNDS
STUCK = 0.1  # residual relative to the largest from which a star is folded; smaller ones follow from their neighbours
# step of second differences over the mean edge; near the fourth root of the rounding error, which balances truncation and rounding
STEP = 1e-3
FIRST = 1e-4  # smallest fold of a star over the mean edge; below, the star stays at the saddle point
FARTHEST = 0.3  # largest fold of a star over the mean edge; larger ones turn faces over


def descend_over_saddles(system: System, equations: CurvatureEquations, start: Point) -> Iterator[Taken]:
    """Take steps from a start to rounding; where they creep at vertices of K̄ < 0, fold these and go on."""
    alone = system.places.trivial and len(start.residual) == len(system.rows)
    if not alone or not (types_of(equations.targets[system.rows]) < 0).any():
        yield from descend_to_rounding(system, equations, start)
        return
    here, rests = start, [start.merit]
    for _ in range(ROUNDS):
        merits = [here.merit]
        for taken in descend_to_rounding(system, equations, here):
            here = system.at(taken.vertices, equations)
            yield taken
            merits.append(here.merit)
            creeps = len(merits) > FINISH and merits[-1] > CREEPING * merits[-1 - FINISH]
            if creeps and system.missing(here, equations) > FULFILLED:
                break
        if system.missing(here, equations) <= FULFILLED:
            return
        rests.append(here.merit)
        if len(rests) > PATIENCE and rests[-1] > GAIN * rests[-1 - PATIENCE]:
            break
        folded = _folded(system, equations, here)
        if folded is None:
            break
        here = system.at(folded, equations)
        yield Taken(folded, 1.0, 1, False)
    yield from descend(system, equations, here, WORTHWHILE, finish=FINISH)


def _folded(system: System, equations: CurvatureEquations, point: Point) -> Optional[Vertices]:
    """Return the shape (n, 3) with the stars of stuck vertices folded, those of the largest residual first; None where none is."""
    faces, rows, targets = system.faces, system.rows, equations.targets
    stuck = (types_of(targets[rows]) < 0) & (point.residual > STUCK * np.abs(point.residual).max(initial=0.0))
    order = np.flatnonzero(stuck)[np.argsort(-point.residual[stuck], kind="stable")]
    free = np.zeros(len(point.vertices), bool)
    free[system.columns] = True
    vertices = point.vertices.copy()
    for vertex in rows[order].tolist():
        own = faces[(faces == vertex).any(axis=1)]
        star = np.append(vertex, np.setdiff1d(own, vertex))
        if not free[star].all():
            continue
        ranks = np.argsort(star)[np.searchsorted(np.sort(star), own)]
        places = _saddle(vertices[star], ranks, float(targets[vertex]))
        if places is not None:
            vertices[star] = places
            # Neighbours are folded in another round, if they still have to be.
            free[star] = False
    return None if (vertices == point.vertices).all() else vertices


def _saddle(star: FloatArray, faces: Faces, K: float) -> Optional[FloatArray]:
    """Return places (k, 3) of a vertex, the first, and its neighbours with angles that K asks for, None where there are none near.

    They are moved along the normal: up or down the direction in which the second derivative of the angles is largest, or along the
    first derivative, whichever is the shortest.
    """
    targets = np.zeros(len(star))
    targets[0] = K
    edge = float(np.linalg.norm(star[1:] - star[0], axis=1).mean())
    normal = face_normals(star, faces).sum(axis=0)
    normal /= np.linalg.norm(normal)

    def lift(heights: FloatArray) -> FloatArray:
        return star + heights[:, None] * normal

    def excess(heights: FloatArray) -> float:
        return float(space_form_angle_sums(lift(heights), faces, targets)[0]) - 2 * np.pi

    lacks = excess(np.zeros(len(star)))
    goal = -lacks  # as much beyond the target, so that smooth steps come back to it from where they can
    steps = STEP * edge * np.eye(len(star))
    slope = np.array([excess(step) - excess(-step) for step in steps])
    bends = np.empty((len(star), len(star)))
    for i, one in enumerate(steps):
        for j, other in enumerate(steps[: i + 1]):
            bends[i, j] = bends[j, i] = excess(one + other) + excess(-one - other) - excess(one - other) - excess(other - one)
    steepest = np.linalg.eigh(bends)[1][:, -1]
    ways = [steepest, -steepest] + ([slope / np.linalg.norm(slope)] if slope.any() else [])
    found = []
    for way in ways:
        far = FIRST * edge
        while excess(far * way) < goal and far < FARTHEST * edge:
            far *= 2.0
        if excess(far * way) < goal:
            continue
        near = 0.0
        for _ in range(40):  # to rounding level
            middle = 0.5 * (near + far)
            near, far = (middle, far) if excess(middle * way) < goal else (near, middle)
        found.append((far, way))
    if not found:
        return None
    far, way = min(found, key=lambda one: one[0])
    return lift(far * way)
