"""Flattening of panels with K other than 0 at least distortion, and the width that a strain allows."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from numpy.typing import NDArray

from ..discrete import mesh_arrays
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing import boundary_loops
from ..model.given import checked_number

__all__ = ["LONG_ASPECT", "STRAIN", "Flattening", "flatten", "flattening_constant", "strain_of_width", "widest_panel"]


STRAIN = 2e-3  # strain quoted in reports, which many flat sheet materials can take when pressed into double curvature
SQUARE_CONSTANT = 24.0  # k of a roughly square panel (rule of thumb)
STRIP_CONSTANT = 16.0  # k of an infinitely long panel
LONG_ASPECT = 10.0  # length over width that counts as infinitely long


class Flattening(NamedTuple):
    """A curved panel flattened to the plane."""

    plane: FloatArray  # (n, 2) vertices in the plane [L]
    strains: FloatArray  # (m, 2) principal strains of every face in flattening, the larger first
    directions: FloatArray  # (m, 2) unit direction of the larger strain in the plane

    @property
    def largest(self) -> float:
        """Largest absolute strain."""
        return float(np.abs(self.strains).max(initial=0.0))


@names_what_was_meant()
def widest_panel(K: float, strain: float, aspect: Optional[float] = None) -> float:
    """Return the largest width of a panel for a flattening strain: ``w = sqrt(k strain / |K|)`` [L].

    For roughly square panels k = 24 is a slightly conservative rule of thumb; see :func:`flattening_constant` for others.

    Parameters
    ----------
    K
        Gaussian curvature [1/L^2].
    strain
        Largest strain, such as 0.002.
    aspect
        Length over width of the panel. Default: roughly square, k = 24.

    Returns
    -------
    float
        Width [L]; infinite for K = 0.

    Examples
    --------
    >>> round(widest_panel(0.01, 0.001), 3)
    1.549
    """
    K, strain = checked_number(K, "K"), checked_number(strain, "strain")
    k = SQUARE_CONSTANT if aspect is None else flattening_constant(aspect)
    return math.sqrt(k * strain / abs(K)) if K else math.inf


def strain_of_width(K: float, width: float, aspect: Optional[float] = None) -> float:
    """Return the largest strain of a flattened panel: ``|K| w^2 / k``, see :func:`widest_panel`."""
    return abs(K) * width * width / (SQUARE_CONSTANT if aspect is None else flattening_constant(aspect))


def flattening_constant(aspect: float) -> float:
    r"""Return k of a rectangle: the best conformal map strains it by ``|K| w^2 / k`` at most.

    A conformal map stretches by :math:`e^u` with :math:`\Delta u = K`. The map of least strain has constant u along the boundary
    (Chebyshev), so u is K times the torsion function of the panel; scaling divides its largest value between stretch and
    compression. k is 27.1 for a square, 17.6 for an aspect of 2 and 16 for a long strip, in which the lengths of the middle and
    of the edges differ by ``K w^2 / 8``.

    Parameters
    ----------
    aspect
        Length over width, or width over length.

    References
    ----------
    Timoshenko and Goodier, *Theory of Elasticity*, torsion of a rectangular bar. Milnor, *A problem in cartography*, doi:10.2307/2317182.
    """
    if not (math.isfinite(aspect) and aspect > 0.0):
        raise CGCError(f"the aspect of a panel must be a positive ratio of length to width, such as 2, not {aspect!r}")
    long = max(aspect, 1.0 / aspect)
    terms = sum((-1) ** ((n - 1) // 2) / (n**3 * math.cosh(min(0.5 * n * math.pi * long, 700.0))) for n in range(1, 40, 2))
    return STRIP_CONSTANT / (1.0 - 32.0 / math.pi**3 * terms)


@names_what_was_meant()
def flatten(vertices: ArrayLike, faces: ArrayLike) -> Flattening:
    """Flatten a curved panel by a least-squares conformal map, scaled to equal stretch and compression.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices of a disk.

    Returns
    -------
    Flattening
        Plane positions and strains.

    Raises
    ------
    CGCError
        If the panel is closed or has a hole, or libigl is not installed.

    References
    ----------
    Levy, Petitjean, Ray, Maillot, doi:10.1145/566654.566590.

    Examples
    --------
    >>> bent = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]])
    >>> len(flatten(bent, np.array([[0, 1, 2], [0, 2, 3]]))) > 1
    True
    """
    V, F = mesh_arrays(vertices, faces)
    used, corners = np.unique(F, return_inverse=True)
    own, own_faces = V[used], corners.reshape(-1, 3).astype(np.int64)
    loops = boundary_loops(own_faces)
    if len(loops) != 1:
        raise CGCError(f"a panel with {len(loops)} boundary loops cannot be flattened; cut it to have one")
    plane = np.zeros((len(V), 2))
    plane[used] = _scaled(own, own_faces, _conformal(own, own_faces, loops[0]))
    strains, directions = principal_strains(V, F, plane[F])
    return Flattening(plane, strains, directions)


def principal_strains(vertices: Vertices, faces: Faces, corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the principal strains (m, 2) of faces with plane corners (m, 3, 2), and the direction of the larger one (m, 2)."""
    flat = _flat_triangles(vertices, faces)
    own = np.stack([flat.real, flat.imag], axis=2)
    before = np.stack([own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]], axis=2)
    after = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
    turned, stretch, _ = np.linalg.svd(after @ np.linalg.inv(before))
    return stretch - 1.0, turned[:, :, 0]


def _conformal(V: Vertices, F: Faces, loop: np.ndarray) -> FloatArray:
    try:
        import igl
    except ImportError:
        raise CGCError("flattening panels with K other than 0 needs the package libigl; install compas_cgc[fabrication]") from None
    # LSCM needs two fixed vertices: those farthest apart on the boundary.
    start = loop[np.argmax(np.linalg.norm(V[loop] - V[loop].mean(axis=0), axis=1))]
    end = loop[np.argmax(np.linalg.norm(V[loop] - V[start], axis=1))]
    held = np.array([start, end], dtype=np.int64)
    targets = np.array([[0.0, 0.0], [float(np.linalg.norm(V[end] - V[start])), 0.0]])
    # Versions before 2.6 return a success flag too.
    found = igl.lscm(V, F, held, targets)
    plane = next(part for part in found if isinstance(part, np.ndarray) and part.shape == (len(V), 2))
    return np.ascontiguousarray(plane, dtype=np.float64)


def _scaled(V: Vertices, F: Faces, plane: FloatArray) -> FloatArray:
    """Return plane positions scaled to equal stretch and compression, with normals up."""
    corners = plane[F]
    ahead, back = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    if (ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0]).sum() < 0:
        plane = plane * [1.0, -1.0]
        corners = plane[F]
    stretch = principal_strains(V, F, corners)[0] + 1.0
    scale = 2.0 / (stretch.max() + stretch.min())
    return (plane - plane.mean(axis=0)) * scale


def _flat_triangles(vertices: Vertices, faces: Faces) -> NDArray[np.complex128]:
    """Return every face in its own plane, with the first corner at 0 and the first edge along x: complex (m, 3) [L]."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    ab, ac = b - a, c - a
    length = np.linalg.norm(ab, axis=1)
    x = np.einsum("ij,ij->i", ab, ac) / length
    y = np.linalg.norm(np.cross(ab, ac), axis=1) / length
    return np.column_stack([0.0 * length, length, x + 1j * y])
