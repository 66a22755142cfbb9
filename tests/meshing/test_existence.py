"""What a plane boundary can carry: nothing is refused that exists."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve
from compas_cgc.paper.examples.plan import hexagonal_disk


def disk(rings, target):
    faces, ring, place = hexagonal_disk(rings)
    angle = 2 * np.pi * place / np.maximum(1, 6 * ring)
    vertices = np.column_stack([ring / rings * np.cos(angle), ring / rings * np.sin(angle), 0.0 * angle])
    mesh = CGCMesh.from_vertices_and_faces(vertices, faces)
    mesh.set_supports("boundary")
    mesh.set_target(target)
    return mesh


@pytest.mark.parametrize("rings", [2, 3, 6])
def test_over_a_circle_of_radius_1_curvatures_below_1_exist_on_coarse_meshes_too(rings):
    """They are caps of spheres of radius K^-1/2; a polygon in the circle has less area, and may carry a little more."""
    mesh = disk(rings, 0.9)
    assert mesh.check() == [] and solve(mesh).converged
    assert any("too large for this boundary" in problem for problem in disk(rings, 1.1).check())
