"""NURBS surfaces of regions in .3dm files: their sides coincide, and they lie on the fitted surfaces."""

from __future__ import annotations

import numpy as np
import pytest
import rhino3dm

import compas_cgc
from compas_cgc.fabrication.shell import fit as shell_fit
from compas_cgc.fabrication.shell import patches as shell_patches
from compas_cgc.fabrication.shell import regions
from compas_cgc.fabrication.shell.patches import curvature_errors
from compas_cgc.fabrication.shell.patches import patches
from compas_cgc.fabrication.shell.patches import region_patches
from compas_cgc.fabrication.shell.regions import region_surfaces
from compas_cgc.io.rhino.nurbs import nurbs_surface


@pytest.fixture(scope="module")
def facade():
    return compas_cgc.solve(compas_cgc.read(compas_cgc.get("facade.3dm")))


def objects_on(path):
    """Return the objects on the layer of the surfaces."""
    archive = rhino3dm.File3dm.Read(str(path))
    layers = {layer.Index: layer.FullPath for layer in archive.Layers}
    return [one for one in archive.Objects if layers[one.Attributes.LayerIndex] == "CGC::NURBS"]


def grid_of(surface, n=41):
    """Return points (n, n, 3) of a surface."""
    u, v = surface.Domain(0), surface.Domain(1)
    places = [[surface.PointAt(a, b) for b in np.linspace(v.T0, v.T1, n)] for a in np.linspace(u.T0, u.T1, n)]
    return np.array([[[p.X, p.Y, p.Z] for p in row] for row in places])


def test_sides_of_neighbours_coincide_in_the_file(facade, tmp_path):
    (note,) = compas_cgc.write(tmp_path / "facade.3dm", facade, nurbs=True)
    assert note.startswith("3 NURBS surfaces")
    surfaces = [one.Geometry for one in objects_on(tmp_path / "facade.3dm") if isinstance(one.Geometry, rhino3dm.NurbsSurface)]
    assert len(surfaces) == 3 and all(surface.IsValid for surface in surfaces)
    sides = []
    for surface in surfaces:
        grid = grid_of(surface)
        sides.append([grid[0], grid[-1], grid[:, 0], grid[:, -1]])
    for one, other in ((0, 1), (1, 2)) if _meet(sides[0], sides[1]) < 1.0 else ((0, 2), (2, 1)):
        assert _meet(sides[one], sides[other]) < 1e-9


def _meet(one, other):
    """Return the distance of the nearest two sides of two patches."""
    return min(np.abs(a - b[::way]).max() for a in one for b in other for way in (1, -1))


def test_patches_lie_on_the_fitted_surfaces(facade):
    fit = region_surfaces(facade.problem)
    made = patches(fit, 4)
    for piece, patch in zip(fit.pieces, made):
        assert patch.sides
        points = grid_of(nurbs_surface(patch.nurbs)).reshape(-1, 3)
        local = piece.local((points - fit.centre) / fit.scale)
        off = np.abs(piece.space.basis(local[:, :2]) @ piece.coefficients - local[:, 2]) * fit.scale
        assert np.median(off) < 1e-6 and np.percentile(off, 95) < 1e-4 and off.max() < 1e-3
    # The rim at the supports is singular; elsewhere the patches have the prescribed K.
    errors = curvature_errors(facade.problem, fit, made)
    assert np.median(errors) < 0.002 and np.percentile(errors, 95) < 0.02


def test_patches_of_a_vault_are_refined_until_they_are_developable():
    result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    fit = region_surfaces(result.problem)
    made = region_patches(result.problem, fit)
    coarse = np.percentile(curvature_errors(result.problem, fit, patches(fit, 4)), 95)
    assert made.percentiles[1] < 0.05 < coarse
    assert len(made.patches[0].control) > len(patches(fit, 4)[0].control)


def test_patches_without_the_curvature_of_the_regions_are_refused(facade, tmp_path, monkeypatch):
    monkeypatch.setattr(shell_patches, "MAX_CURVATURE_ERROR", 1e-12)
    (note,) = compas_cgc.write(tmp_path / "facade.3dm", facade, nurbs=True)
    assert "their K differs from its target" in note and not objects_on(tmp_path / "facade.3dm")


def test_refused_surfaces_leave_the_mesh_and_one_sentence(facade, tmp_path, monkeypatch):
    monkeypatch.setattr(shell_fit, "MAX_CURVATURE_ERROR", 1e-12)
    monkeypatch.setattr(regions, "TRIALS", regions.TRIALS[:1])
    (note,) = compas_cgc.write(tmp_path / "facade.3dm", facade, nurbs=True)
    assert "no smooth surfaces of the regions were written" in note and not objects_on(tmp_path / "facade.3dm")
    archive = rhino3dm.File3dm.Read(str(tmp_path / "facade.3dm"))
    assert any(isinstance(one.Geometry, rhino3dm.Mesh) for one in archive.Objects)
