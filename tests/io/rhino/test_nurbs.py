"""NURBS surfaces of regions: near the mesh, and of the curvature asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCMesh
from compas_cgc import read
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.analysis.nurbs import fit_surface
from compas_cgc.errors import MeshError
from compas_cgc.io.rhino.nurbs_layer import nurbs_surface

ROOF = Path(__file__).parents[3] / "examples" / "nine_regions.3dm"


def cap(n, radius=10.0, side=8.0):
    """Return a square piece of a sphere."""
    mesh = CGCMesh.from_meshgrid(dx=side, nx=n)
    V, F = mesh.arrays()
    V = V - [side / 2, side / 2, 0]
    V[:, 2] = np.sqrt(radius**2 - V[:, 0] ** 2 - V[:, 1] ** 2)
    return V, F


def test_a_fitted_sphere_has_its_curvature_and_comes_nearer_with_the_mesh():
    gaps, errors = [], []
    for n in (6, 12, 24):
        fit = fit_surface(*cap(n))
        gaps.append(fit.deviation)
        errors.append(np.median(np.abs(fit.gaussian * 100 - 1)))
    assert gaps[-1] < 2e-3 and errors[-1] < 5e-3
    assert errors[-1] < 0.5 * errors[0]


def test_rhino_evaluates_what_was_fitted():
    V, F = cap(8)
    surface = nurbs_surface(fit_surface(V, F))
    assert surface.IsValid
    u, v = surface.Domain(0), surface.Domain(1)
    places = [surface.PointAt(a, b) for a in np.linspace(u.T0, u.T1, 9) for b in np.linspace(v.T0, v.T1, 9)]
    assert np.allclose([np.linalg.norm([p.X, p.Y, p.Z]) for p in places], 10.0, atol=5e-3)


def test_a_region_with_a_hole_is_not_fitted():
    V, F = cap(6)
    with pytest.raises(MeshError, match="holes"):
        fit_surface(V, np.delete(F, 30, axis=0))


def test_nine_regions_are_written_side_by_side(tmp_path):
    result = solve(read(ROOF))
    path = tmp_path / "roof.3dm"
    notes = write(path, result, source=ROOF, nurbs=True)
    assert len(notes) == 9 and all("as NURBS" in note for note in notes)
    archive = rhino3dm.File3dm.Read(str(path))
    layers = {layer.Index: layer.FullPath for layer in archive.Layers}
    drawn = [one for one in archive.Objects if layers[one.Attributes.LayerIndex] == "CGC::NURBS"]
    assert len(drawn) == 9
    for one in drawn:
        wanted = 0.04 if one.Attributes.GetUserString("region") == "4" else 0.01
        assert float(one.Attributes.GetUserString("deviation")) < 1e-3
        assert float(one.Attributes.GetUserString("K")) == pytest.approx(wanted, rel=0.03)
    again = write(path, result, source=path, nurbs=True)
    assert len(again) == 9 and len(rhino3dm.File3dm.Read(str(path)).Objects) == len(archive.Objects)
