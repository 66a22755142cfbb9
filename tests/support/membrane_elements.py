"""An elastic membrane by finite elements (scikit-fem), as a second opinion on forces."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu


def membrane_stresses(vertices, faces, pressure, edges, traction, poisson=0.3, spring=1e-9):
    """Return N of every element (m, 3, 3) under a pressure, with line loads on edges and soft springs against drifting.

    Linear triangles over the plan, strains by the metric of the surface; nothing is taken from the package.
    """
    from skfem import Basis
    from skfem import BilinearForm
    from skfem import ElementTriP1
    from skfem import ElementVector
    from skfem import LinearForm
    from skfem import MeshTri

    basis = Basis(MeshTri(vertices[:, :2].T.copy(), faces.T.copy()), ElementVector(ElementTriP1(), 3), intorder=1)
    height = basis.with_element(ElementTriP1()).interpolate(vertices[:, 2])

    def metric(z):
        zx, zy = z.grad
        one, none = np.ones_like(zx), np.zeros_like(zx)
        g = 1 + zx**2 + zy**2
        inverse = np.array([[1 + zy**2, -zx * zy], [-zx * zy, 1 + zx**2]]) / g
        return np.array([[one, none, zx], [none, one, zy]]), inverse, np.sqrt(g)

    def strain(tangents, u):
        change = np.einsum("ai...,ib...->ab...", tangents, u.grad)
        return 0.5 * (change + np.swapaxes(change, 0, 1))

    def stress(inverse, e):
        raised = np.einsum("ac...,bd...,cd...->ab...", inverse, inverse, e)
        return ((1 - poisson) * raised + poisson * inverse * np.einsum("cd...,cd...->...", inverse, e)) / (1 - poisson**2)

    @BilinearForm
    def stiffness(u, v, w):
        tangents, inverse, area = metric(w["z"])
        return np.einsum("ab...,ab...->...", stress(inverse, strain(tangents, u)), strain(tangents, v)) * area

    @LinearForm
    def load(v, w):
        zx, zy = w["z"].grad
        return pressure * (-zx * v[0] - zy * v[1] + v[2])

    K, f = stiffness.assemble(basis, z=height), load.assemble(basis, z=height)
    length = np.linalg.norm(vertices[edges[:, 1]] - vertices[edges[:, 0]], axis=1)
    for end in (0, 1):
        for axis in range(3):
            np.add.at(f, basis.nodal_dofs[axis, edges[:, end]], 0.5 * length * traction[:, axis])
    held = (K + spring * K.diagonal().mean() * sparse.identity(K.shape[0])).tocsc()
    u = splu(held, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve(f)
    tangents, inverse, _ = metric(height)
    found = stress(inverse, strain(tangents, basis.interpolate(u)))
    return np.einsum("ab...,ai...,bj...->ij...", found, tangents, tangents)[..., 0].transpose(2, 0, 1)
