"""The Lagrangian to second order about a shape, and its least value within a trust region."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ..constants import KRYLOV
from ..constants import LOOSE_RESIDUAL
from .bordered import Linearised
from .iterate import Point
from .system import System
from .vectors import dot

__all__ = ["InnerStep", "QuadraticModel"]

FORCING = 1e-1  # fraction of the squared gradient that a step leaves; smaller near convergence (Eisenstat and Walker)
NO_BEND = 1e-6  # curvature along a direction relative to that of the metric, below which it is zero; a step then ends at the trust region


class InnerStep(NamedTuple):
    """A step among the moves that the linear equations do not see."""

    move: FloatArray  # (q,)
    multipliers: FloatArray  # (l,) after the step
    promised: float  # decrease of the model
    length: float  # in the metric
    inside: bool  # whether it is a minimum, and was not cut off by the trust region
    left: float  # of the gradient, as a part


class QuadraticModel:
    """The quadratic model of the Lagrangian at a shape.

    Its second derivative is the metric plus the defects' own, weighed by the multipliers. Conjugate gradients
    find the step among the moves that the linear equations do not see, preconditioned by the metric, up to the
    trust region or along a direction that curves downwards.

    Parameters
    ----------
    system, equations
        The problem.
    linear
        Its equations about the shape.
    point
        The shape.
    multipliers
        ``(l,)`` of the leading equations.

    References
    ----------
    Gould, Hribar, Nocedal, doi:10.1137/S1064827598345667. Steihaug, doi:10.1137/0720042.
    """

    def __init__(self, system: System, equations: CurvatureEquations, linear: Linearised, point: Point, multipliers: FloatArray):
        self._system, self._linear, self._metric = system, linear, linear.solver.metric
        self._weights = system.spread(multipliers)
        self._along = system.hessian(equations, point.vertices, self._weights)
        self.energy, gradient = system.fairness.energy(point.vertices)
        self.normal = linear.solver.cheapest(linear.right, LOOSE_RESIDUAL).move
        downhill = -(linear.reduced(gradient) + linear.solver.transposed @ multipliers) - self._bend(self.normal)
        self._first = self._seen(downhill, multipliers, LOOSE_RESIDUAL)

    @property
    def slope(self) -> float:
        """Length of the first direction, the gradient in the metric."""
        residual, direction, _ = self._first
        return math.sqrt(max(0.0, dot(residual, direction)))

    def lagrangian(self, point: Point) -> float:
        """Return energy and weighed residuals of a shape."""
        return self._system.fairness.energy(point.vertices)[0] + dot(self._weights, point.residual)

    def within(self, radius: float) -> InnerStep:
        """Return the step to the least value within a radius."""
        residual, direction, multipliers = self._first
        z, product = direction, dot(direction, residual)
        first, promised, done = product, 0.0, 0
        # The smaller the step, the more precise: quadratic convergence for no more rounds than needed.
        forcing = FORCING * min(1.0, math.sqrt(max(0.0, first) / self.energy)) if self.energy > 0.0 else FORCING
        step = np.zeros_like(residual)
        while done < KRYLOV and product > forcing * first:
            turned = self._metric.times(direction)
            square, image = dot(direction, turned), turned + self._bend(direction)
            bend = dot(direction, image)
            length = product / bend if bend > NO_BEND * square else math.inf
            reach = self._to_edge(step, direction, turned, radius)
            cut = min(length, reach)
            promised += cut * dot(residual, direction) - 0.5 * cut * cut * bend
            step = step + cut * direction
            if length >= reach:
                return InnerStep(step, multipliers, promised, radius, False, 1.0)
            before = residual
            residual, z, multipliers = self._seen(residual - length * image, multipliers, LOOSE_RESIDUAL)
            # Polak and Ribière's form forgives that the preconditioner is not the same in every round.
            turn = max(0.0, dot(z, residual - before) / product)
            product = dot(z, residual)
            direction = z + turn * direction
            done += 1
        size = math.sqrt(max(0.0, dot(step, self._metric.times(step))))
        return InnerStep(step, multipliers, promised, size, True, math.sqrt(max(0.0, product) / first) if first > 0.0 else 0.0)

    def _seen(self, residual: FloatArray, multipliers: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return a residual without what the multipliers account for, the move along it, and the multipliers."""
        move, more = self._linear.solver.without_effect(residual, tolerance)
        return residual - self._linear.solver.transposed @ more, move, multipliers + more

    def _bend(self, move: FloatArray) -> FloatArray:
        moves = self._system.full(self._linear.expanded(move))
        return self._linear.reduced(self._along(moves)[self._system.columns].ravel())

    def _to_edge(self, step: FloatArray, direction: FloatArray, turned: FloatArray, radius: float) -> float:
        """Return how far it is along a direction to the edge of the trust region."""
        square, along = dot(direction, turned), dot(step, turned)
        inside = radius**2 - dot(step, self._metric.times(step))
        return (math.sqrt(max(0.0, along * along + square * inside)) - along) / square
