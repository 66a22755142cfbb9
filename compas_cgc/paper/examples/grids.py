"""Square grids with a ring of dummy squares: Examples 2, 3 and 4, and Table 2."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...datastructures import CGCMesh
from ...solvers.flow import FlowSettings

__all__ = ["example2", "example3", "example4", "grid_with_ring", "table2"]

PAPER = FlowSettings(finish=False, tolerance=0.0, xi=0.01, tau=0.5, zeta=1.1, q=5, filter_power=3.0)


def grid_with_ring(n: int, cell: float) -> CGCMesh:
    """Return n by n squares inside a ring of dummy squares, with one corner of the real mesh at the origin.

    Parameters
    ----------
    n
        Number of squares per side, without the ring.
    cell
        Side of a square [L].
    """
    side = n + 3
    i, j = np.divmod(np.arange(side**2), side)
    vertices = np.column_stack([(i - 1) * cell, (j - 1) * cell, np.zeros(side**2)])
    a = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    # Each square split along the same diagonal: every internal vertex has six edges.
    faces = np.column_stack([a, a + side, a + side + 1, a, a + side + 1, a + 1]).reshape(-1, 3)
    mesh = CGCMesh.from_vertices_and_faces(vertices, faces)
    for key in np.flatnonzero((np.minimum(i, j) == 0) | (np.maximum(i, j) == side - 1)).tolist():
        mesh.vertex_role(key, "dummy")
    mesh.update_roles()
    return mesh


def lattice_vertex(n: int, i: int, j: int) -> int:
    """Return the vertex in row i and column j of the real mesh of :func:`grid_with_ring`."""
    return (i + 1) * (n + 3) + j + 1


def example2(filtered: bool = True) -> tuple[CGCMesh, FlowSettings]:
    """Return Example 2: 9 x 9 squares of 0.1 with a fixed boundary, K̄ = 1.

    Parameters
    ----------
    filtered
        Whether to use the filter; without it, the flow diverges as in the paper.

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> example2()[0].number_of_faces()
    242
    """
    mesh = grid_with_ring(9, 0.1)
    mesh.set_supports([lattice_vertex(9, i, j) for i in range(10) for j in range(10) if {i, j} & {0, 9}])
    mesh.set_target(1.0)
    return mesh, replace(PAPER, steps=200, mu0=0.1, filter_radius=0.5 if filtered else 0.0)


def example3(filtered: bool = True) -> tuple[CGCMesh, FlowSettings]:
    """Return Example 3: the same grid, fixed at its four corners only.

    Parameters
    ----------
    filtered
        Whether to use the filter; without it, the flow diverges as in the paper.

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> len(example3()[0].supports())
    4
    """
    mesh = grid_with_ring(9, 0.1)
    mesh.set_supports([lattice_vertex(9, i, j) for i in (0, 9) for j in (0, 9)])
    mesh.set_target(1.0)
    return mesh, replace(PAPER, steps=200, mu0=0.1, filter_radius=0.5 if filtered else 0.0)


def example4(s: float = 0.8, e: int = 0, centre: float = 4.0, around: float = 4.0) -> tuple[CGCMesh, FlowSettings]:
    """Return Example 4: 15 x 15 squares of 0.1, fixed at four corners, in nine square regions.

    Parameters
    ----------
    s, e
        Strategy S1 (``e`` zero) or S2 (``s`` one).
    centre, around
        Targets of the region in the centre and of the other eight [1/L^2].

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> len(example4()[0].regions())
    9
    """
    n = 15
    mesh = grid_with_ring(n, 0.1)
    mesh.set_supports([lattice_vertex(n, i, j) for i in (0, n) for j in (0, n)])
    lines = [[lattice_vertex(n, i, k) for i in range(n + 1)] for k in (5, 10)]
    lines += [[lattice_vertex(n, k, j) for j in range(n + 1)] for k in (5, 10)]
    mesh.set_creases(lines)
    mesh.set_target(around)
    mesh.set_target(centre, region=4)
    return mesh, replace(PAPER, steps=200, mu0=0.1, filter_radius=0.5, s=s, e=e)


def table2(n: int) -> tuple[CGCMesh, FlowSettings]:
    """Return a row of Table 2: n x n squares on a square 10 wide with a fixed boundary, K̄ = 0.01.

    The values μ0 = 100 and d̄ = 5 of the paper correspond to a mesh ten times larger than
    that of Example 2, and thus to a target a hundred times smaller.

    Parameters
    ----------
    n
        Number of squares per side.

    Returns
    -------
    mesh, settings
        For :func:`compas_cgc.solve`.

    Examples
    --------
    >>> table2(5)[1].steps
    200
    """
    mesh = grid_with_ring(n, 10.0 / n)
    mesh.set_supports([lattice_vertex(n, i, j) for i in range(n + 1) for j in range(n + 1) if {i, j} & {0, n}])
    mesh.set_target(0.01)
    return mesh, replace(PAPER, steps=200, mu0=100.0, filter_radius=5.0)
