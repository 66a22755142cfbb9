"""Example 5: a ring with a waist that becomes a developable cone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...datastructures import CGCMesh
from ...solvers.flow import FlowSettings
from .grids import PAPER

__all__ = ["example5", "waisted_ring"]


def waisted_ring(bottom: float, top: float, height: float, waist: float, rows: int, around: int) -> CGCMesh:
    """Return a surface of revolution between two horizontal circles, with a waist at half height.

    Parameters
    ----------
    bottom, top
        Radii of the circles [L].
    height
        Distance between the circles [L].
    waist
        Inward offset of the middle from the cone [L].
    rows, around
        Number of vertices in both directions; every row is rotated by half an edge.
    """
    t, j = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, rows), np.arange(around), indexing="ij"))
    radius = bottom + (top - bottom) * t - 4 * waist * t * (1 - t)
    angle = 2 * np.pi * (j + 0.5 * t * (rows - 1)) / around
    vertices = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height * t])
    row = np.arange(rows - 1)[:, None] * around
    a, b = (row + np.arange(around)).ravel(), (row + (np.arange(around) + 1) % around).ravel()
    faces = np.column_stack([a, b, a + around, b, b + around, a + around]).reshape(-1, 3)
    return CGCMesh.from_vertices_and_faces(vertices, faces)


def example5() -> tuple[CGCMesh, FlowSettings]:
    """Return the counterpart of Example 5: K̄ = 0 between two fixed circles, 220 vertices with dummies.

    The paper shows its mesh (226 vertices) in a picture only.

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> example5()[0].number_of_vertices()
    220
    """
    mesh = waisted_ring(bottom=3.0, top=1.5, height=3.0, waist=0.3, rows=8, around=22)
    mesh.set_supports("boundary")
    mesh.set_target(0.0)
    mesh.add_dummy_ring()
    return mesh, replace(PAPER, steps=500, mu0=1.0, filter_radius=1.5)
