"""Values in other units than the drawing get a sentence that names the unit or the size of the surface."""

from __future__ import annotations

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import check
from compas_cgc.errors import CGCError
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import unroll
from compas_cgc.io import read_problem
from compas_cgc.rationalisation import rationalise


def courtyard(unit=1.0):
    """Return a plan of 12 x 9 m with a hole, in a unit [m]."""
    mesh = CGCMesh.from_meshgrid(dx=12.0 / unit, nx=12, dy=9.0 / unit, ny=9)
    V, F = mesh.arrays()
    middle = V[F].mean(axis=1)[:, :2] * unit - [6.0, 4.5]
    used, faces = np.unique(F[np.abs(middle).max(axis=1) > 2.0], return_inverse=True)
    mesh = CGCMesh.from_vertices_and_faces(V[used].tolist(), faces.reshape(-1, 3).tolist())
    mesh.set_supports("boundary")
    return mesh


@pytest.fixture(scope="module")
def result():
    return compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")), settings={"measure": "exact"})


@pytest.fixture(scope="module")
def design():
    x, y = np.meshgrid(np.linspace(-6, 6, 25), np.linspace(-4, 4, 17), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), (2 - 0.03 * x**2 - 0.05 * y**2).ravel()])
    return vertices, [[i * 17 + j, i * 17 + 17 + j, i * 17 + 18 + j, i * 17 + 1 + j] for i in range(24) for j in range(16)]


@pytest.mark.parametrize(
    ("K", "unit", "strange"),
    [
        (0.01, 1e-3, True),  # K in 1/m², plan in mm, with a hole
        (0.01, 1e-2, True),  # plan in cm
        (0.005, 0.0254, True),  # plan in inches
        (1e-8, 1.0, True),  # K in 1/mm², plan in m
        (-0.01, 1e-3, True),
        (-1e-8, 1.0, True),
        (0.01, 1.0, False),
        (1e-8, 1e-3, False),
        (-0.02, 1.0, False),
        (0.0, 1e-3, False),
    ],
)
def test_curvatures_in_other_units_are_noticed_by_check(K, unit, strange):
    mesh = courtyard(unit)
    mesh.set_target(K)
    assert any("check the units: K is in 1/(model unit)²" in str(one) for one in check(mesh)) == strange


@pytest.mark.parametrize(
    ("goal", "strange"),
    [
        (compas_cgc.Below(1500.0), "has no effect on a mesh of size 15"),
        (compas_cgc.Above(-1500.0), "has no effect on a mesh of size 15"),
        (compas_cgc.Below(0.002), "0.002 from the level of a support, which is negligible"),
        (compas_cgc.Above(-0.0015), "0.0015 from the level of a support"),
        (compas_cgc.Below(0.0), ""),
        (compas_cgc.Below(2.0), ""),
        (compas_cgc.Above(-1.0), ""),
    ],
)
def test_bounds_of_the_height_in_other_units_are_noticed_by_check(goal, strange):
    mesh = courtyard()
    mesh.set_target(0.01)
    found = [str(one) for one in check(mesh.to_problem().with_goals([goal])) if "check its units" in str(one)]
    assert len(found) == bool(strange) and all(strange in one for one in found)


@pytest.mark.parametrize(("weld", "strange"), [(10.0, True), (0.001, False)])
def test_welding_distances_longer_than_edges_are_noticed(weld, strange, tmp_path):
    compas_cgc.write(tmp_path / "plan.obj", courtyard())
    found = [note for note in read_problem(tmp_path / "plan.obj", tolerance=weld).notes if "check the unit" in note]
    assert len(found) == strange and all("10 is longer than the mean edge of the mesh, 1.14; 0.0114 was used" in note for note in found)


LONG_RING = np.array([[0.0, 0, 0], [12, 0, 0], [12, 9, 0], [0, 9, 0], [0, 0, 0]])


@pytest.mark.parametrize(
    ("run", "sentence"),
    [
        (lambda result, design: CGCMesh.from_outline(LONG_RING, 500.0), "larger than the outline, whose size is 15"),
        (lambda result, design: CGCMesh.from_outline(1e3 * LONG_RING, 0.5), "the outline and the edge length have the same unit"),
        (lambda result, design: panels(result, 2500.0), "the size of panels, 2500 meters, is far larger than the surface"),
        (lambda result, design: panels(result, columns=[1200.0, 800.0]), "the width of columns, 800 meters, is far larger"),
        (lambda result, design: panels(result, 0.0025), "use larger ones"),
        (lambda result, design: moulds(result, panels(result, 3.0), thickness=0.006), "give it in mm, such as 6"),
        (lambda result, design: unroll(result, (3000.0, 1500.0)), "add its unit"),
        (lambda result, design: unroll(result, (3.0, 1.5), allowance=20.0), "in meters|in the units of the drawing"),
        (lambda result, design: unroll(result, (3.0, 1.5), spacing=20.0), "give it in the units of the drawing"),
        (lambda result, design: curve_net(result, 500.0), "the spacing, 500 meters, is far larger than the surface"),
        (lambda result, design: curve_net(result, 0.0005), "use 0.0036 or more"),
        (lambda result, design: compas_cgc.solve(result.problem, goals=[compas_cgc.Rise(1500.0)]), "check its units"),
        (lambda result, design: rationalise(design, panel=2500.0), "the width of panels, 2500 .* is far larger"),
        (lambda result, design: rationalise(design, panel=0.0025), "more than 1000 times"),
        (lambda result, design: rationalise(design, panel=2.0, moulds=None, within=30.0), "more than a tenth of the design"),
        (lambda result, design: rationalise(design, panel=2.0, moulds=[12000.0, np.inf]), "does not fit a design of size"),
        (lambda result, design: rationalise(design, panel=2.0, moulds=[0.012, np.inf]), "does not fit a design of size"),
    ],
)
def test_lengths_in_other_units_get_a_sentence(result, design, run, sentence):
    with pytest.raises(CGCError, match=sentence):
        run(result, design)
