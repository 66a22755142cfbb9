r"""The paper's energy for general constants, Eq. 1, and its first variation."""

from __future__ import annotations

from typing import cast

import numpy as np

from ..discrete import enclosed_volume
from ..discrete import energy
from ..discrete import energy_gradient
from ..discrete import face_areas
from ..discrete.arrays import Faces
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices
from ..discrete.laplacian import cotangent_laplacian
from ..model.laws import LinearWeingarten

__all__ = ["law_of_constants", "weingarten_energy", "weingarten_gradient"]


def law_of_constants(alpha: float, beta: float, gamma: float) -> LinearWeingarten:
    r"""Return the law of the stationary points of :math:`E = \int (\alpha H + \beta) dA + \gamma V` (Eq. 1).

    With the paper's sign of H its first variation is :math:`\int (\gamma - 2 \beta H - \alpha K) \psi \, dA`, so that
    :math:`2 \beta H + \alpha K = \gamma`; here H has the opposite sign. The law is elliptic for :math:`\beta^2 + \alpha \gamma > 0`.

    Parameters
    ----------
    alpha, beta, gamma
        Constants [L], [1] and [1/L], or multiples of these.

    Examples
    --------
    >>> print(law_of_constants(1.0, 0.0, 0.04))
    0.0 H + 1.0 K = 0.04
    """
    return LinearWeingarten(0.0 - 2.0 * beta, alpha, gamma)


def weingarten_energy(vertices: Vertices, faces: Faces, law: LinearWeingarten) -> float:
    r"""Return :math:`\Phi = b M + \tfrac12 a A - c V`, whose stationary points obey a H + b K = c.

    With the total mean curvature M by Steiner's formula, the area A and the enclosed volume V. It is Eq. 1 with its sign reversed, see
    :func:`compas_cgc.discrete.energy`, which it equals for a = 0 and b = 1.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    law
        Coefficients a, b, c.
    """
    a, b, c = _coefficients(law)
    area, volume = float(face_areas(vertices, faces).sum()), enclosed_volume(vertices, faces)
    return b * energy(vertices, faces, 0.0) + 0.5 * a * area - c * volume


def weingarten_gradient(vertices: Vertices, faces: Faces, law: LinearWeingarten) -> Vectors:
    r"""Return the exact gradient (n, 3) of :func:`weingarten_energy`, close to :math:`(a H + b K - c) A_i n_i` on a smooth mesh.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    law
        Coefficients a, b, c.
    """
    a, b, c = _coefficients(law)
    of_mean = energy_gradient(vertices, faces, 0.0)
    of_volume = of_mean - energy_gradient(vertices, faces, 1.0)
    of_area = -(cotangent_laplacian(vertices, faces) @ vertices)
    return np.asarray(b * of_mean + 0.5 * a * of_area - c * of_volume)


def _coefficients(law: LinearWeingarten) -> tuple[float, float, float]:
    return cast("tuple[float, float, float]", law.coefficients)
