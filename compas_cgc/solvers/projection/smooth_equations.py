"""Curvature equations in the smooth measure: angle defects, less what the layout of the mesh puts into them on the shape as it is."""

from __future__ import annotations

from typing import Optional
from typing import TypeVar
from typing import Union

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.jacobian import CurvatureEquations
from ...discrete.smooth_measure import layout_errors
from ...discrete.smooth_measure import layout_errors_and_slopes
from ...linalg.work import count
from ...linalg.work import rights
from .found_curvature import FoundCurvature

__all__ = ["SmoothEquations", "SmoothFoundCurvature", "in_smooth_measure"]

FITS = 20  # work of fits [right sides]; estimate of the time, which affects the work limit only
SLOPES = 45  # work of fits with their derivatives [right sides]; estimate of the time, which affects the work limit only

Plain = TypeVar("Plain", bound=CurvatureEquations)


class _Layout:
    """What the layout of a mesh puts into angle defects over areas, and its derivatives, for the shape that was last asked for."""

    def __init__(self, faces: IntArray, asked: Mask, columns: IntArray):
        self._faces, self._asked = faces, asked
        self._coordinates = (3 * columns[:, None] + np.arange(3)).ravel()
        self._at: Optional[FloatArray] = None
        self._errors: FloatArray = np.zeros(0)
        self._slopes: Optional[sparse.csr_matrix] = None

    def errors(self, vertices: FloatArray) -> FloatArray:
        """Return the errors (n,) [1/L^2]."""
        if self._at is None or not np.array_equal(self._at, vertices):
            count(rights(FITS, 3 * len(vertices)))
            self._at, self._slopes = vertices.copy(), None
            self._errors = layout_errors(vertices, self._faces, self._asked)
        return self._errors

    def slopes(self, vertices: FloatArray) -> sparse.csr_matrix:
        """Return their derivatives by the coordinates that may move (n, 3c) [1/L^3]."""
        self.errors(vertices)
        if self._slopes is None:  # Of a shape that is tried only, they are not asked for.
            count(rights(SLOPES, 3 * len(vertices)))
            self._slopes = layout_errors_and_slopes(vertices, self._faces, self._asked)[1][:, self._coordinates]
        return self._slopes


class SmoothEquations(CurvatureEquations):
    r"""One equation per vertex where K is asked for, ``defect_i - (K̄_i + τ_i) A_i``, with τ the error of the layout on the shape.

    With τ kept from an earlier shape it is a deferred correction, which for K < 0 does not always come to rest.
    """

    layout: _Layout

    def told(self, vertices: FloatArray) -> CurvatureEquations:
        """Return the equations with the errors of the layout of a shape (n, 3) added to their targets."""
        return _with(CurvatureEquations, self, self.targets + self.layout.errors(vertices))

    def measure(self, vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals [rad] and the mixed areas [L^2] at the rows, ``(k,)`` each, of a shape (n, 3)."""
        return self.told(vertices).measure(vertices)

    def jacobian(self, vertices: FloatArray, directions: Optional[FloatArray] = None, areas: bool = True) -> sparse.csr_matrix:
        """Return the derivatives of the residuals by all coordinates that may move (k, 3c) [rad/L]."""
        return _less_layout(self, self.told(vertices), vertices)


class SmoothFoundCurvature(FoundCurvature):
    """The same for regions whose K is found."""

    layout: _Layout

    def told(self, vertices: FloatArray) -> FoundCurvature:
        """Return the equations with the errors of the layout of a shape (n, 3) added to their first guesses."""
        return _with(FoundCurvature, self, self.targets + self.layout.errors(vertices))

    def measure(self, vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals for the K of the shape [rad], and the mixed areas [L^2], (k,) each."""
        return self.told(vertices).measure(vertices)

    def targets_of(self, vertices: FloatArray) -> FloatArray:
        """Return the targets (n,) with the K of a shape where it is not given."""
        return self.told(vertices).targets_of(vertices) - self.layout.errors(vertices)

    def jacobian(self, vertices: FloatArray, directions: Optional[FloatArray] = None, areas: bool = True) -> sparse.csr_matrix:
        """Return the derivatives of the residuals by all coordinates that may move (k, 3c) [rad/L], their common part yet to be removed."""
        return _less_layout(self, self.told(vertices), vertices)


def in_smooth_measure(equations: CurvatureEquations, asked: Mask) -> Union[SmoothEquations, SmoothFoundCurvature]:
    """Return equations for the same targets in the smooth measure; fits reach through the vertices `asked` (n,)."""
    kind: type[Union[SmoothEquations, SmoothFoundCurvature]] = (
        SmoothFoundCurvature if isinstance(equations, FoundCurvature) else SmoothEquations
    )
    smooth = _with(kind, equations, equations.targets)
    smooth.layout = _Layout(equations.faces, asked, equations.columns)
    return smooth


def _with(kind: type[Plain], equations: CurvatureEquations, targets: FloatArray) -> Plain:
    """Return equations of a kind that are like others, but for their targets (n,)."""
    made = kind.__new__(kind)
    made.__dict__.update(equations.__dict__)
    made.targets = targets
    return made


def _less_layout(smooth: Union[SmoothEquations, SmoothFoundCurvature], told: CurvatureEquations, vertices: FloatArray) -> sparse.csr_matrix:
    areas = sparse.diags(told.measure(vertices)[1])
    return (told.jacobian(vertices) - areas @ smooth.layout.slopes(vertices)[told.rows]).tocsr()
