"""The paper's examples: meshes, figures of the notes, published errors, scripts."""

from __future__ import annotations

import runpy
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from compas_cgc import solve
from compas_cgc.paper.examples import CATALOGUE
from compas_cgc.paper.examples import SurfaceExample
from compas_cgc.paper.examples import example1
from compas_cgc.paper.examples import examples_of
from compas_cgc.paper.examples import table2
from compas_cgc.solvers.flow import curve_flow
from compas_cgc.solvers.flow.curve import edge_angles

SURFACES = [example for example in CATALOGUE if isinstance(example, SurfaceExample)]


@cache
def solved(number, variant=""):
    (example,) = examples_of(number, variant)
    mesh, settings = example.build()
    return solve(mesh, settings=settings)


def heights(result):
    mesh = result.mesh
    creases = mesh.vertices_where_role("crease")
    return max(mesh.vertices_attribute("z")), max((mesh.vertex_coordinates(v)[2] for v in creases), default=0.0)


# ----------------------------------------------------------------------
# Example 1
# ----------------------------------------------------------------------

ARCHES = [
    ("C1", dict(crease=False), 1.249, 4.1e-3),
    ("C1", dict(s=0.8), 0.353, 1e-9),
    ("C1", dict(e=3), 0.415, 1e-8),
    ("C2", dict(crease=False), 0.643, 1e-13),
    ("C2", dict(s=0.8), 0.189, 1e-13),
    ("C2", dict(e=3), 0.341, 1e-13),
]


@pytest.mark.parametrize("kind, options, height, error", ARCHES)
def test_arches_have_the_heights_and_curvatures_of_the_notes(kind, options, height, error):
    points, arguments = example1(kind, **options)
    arch = curve_flow(points, **arguments)
    assert arch.points[:, 1].max() == pytest.approx(height, abs=6e-4)
    assert arch.max_error < error
    assert np.array_equal(arch.points[[0, -1]], points[[0, -1]])


def test_each_half_of_the_broken_arch_turns_by_nine_tenths_of_its_nine_vertices():
    points, arguments = example1("C1", s=0.8)
    _, angles = edge_angles(curve_flow(points, **arguments).points)
    assert angles[0] - angles[9] == pytest.approx(1.8, abs=1e-7)
    assert angles[10] - angles[19] == pytest.approx(1.8, abs=1e-7)


def test_waiting_makes_the_edges_at_the_break_the_shortest():
    points, arguments = example1("C1", e=3)
    lengths, _ = edge_angles(curve_flow(points, **arguments).points)
    assert lengths[9:11] == pytest.approx([0.032, 0.032], abs=5e-4)
    assert lengths[9:11].max() < np.delete(lengths, [9, 10]).min()


def test_the_papers_step_length_tears_a_c2_curve():
    points, arguments = example1("C2", crease=False)
    torn = curve_flow(points, **{**arguments, "mu": 0.05, "steps": 500})
    assert not torn.max_error < 1.0


# ----------------------------------------------------------------------
# Examples 2 to 7
# ----------------------------------------------------------------------


@pytest.mark.parametrize("example", SURFACES, ids=lambda example: example.name)
def test_meshes_are_sound_and_of_the_papers_size_where_it_is_known(example):
    mesh, _ = example.build()
    assert mesh.check() == []
    size = (mesh.number_of_vertices(), mesh.number_of_faces())
    if example.counterpart:
        assert size == pytest.approx(example.paper_size, rel=0.11)
    else:
        assert size == example.paper_size


@pytest.mark.parametrize(
    "number, variant, error, top, crease",
    [
        (2, "", 1e-3, 0.1519, 0),
        (3, "", 1e-2, 0.2435, 0),
        (4, "", 1e-6, 0.2508, None),
        (4, "a", 1e-6, 0.1917, 0.1121),
        (4, "b", 1e-6, 0.1165, 0.0353),
        (4, "c", 0.12, 0.3945, 0.2970),
        (4, "d", 1e-7, 0.1615, 0.0775),
        (5, "", 1e-5, None, 0),
        (6, "", 6.031e-4 * 0.03, None, 0),
        (7, "a", 2.071e-7, None, None),
        (7, "b", 3.268e-3, None, None),
    ],
)
def test_errors_are_at_or_below_the_published_and_heights_those_of_the_notes(number, variant, error, top, crease):
    result = solved(number, variant)
    assert result.max_error <= error, result.message
    highest, highest_crease = heights(result)
    if top is not None:
        assert highest == pytest.approx(top, rel=0.03)
    if crease:
        assert highest_crease == pytest.approx(crease, rel=0.03)
    assert not result.mesh.vertices_where_role("dummy")


@pytest.mark.parametrize("number", [2, 3])
def test_without_a_filter_they_diverge_as_the_paper_says(number):
    assert solved(number, "nofilter").status == "diverged"


def test_a_developable_cone_is_straight():
    """Between the two circles of Example 5, the generators of the cone are straight lines."""
    vertices, _ = solved(5).mesh.arrays()
    radius = np.linalg.norm(vertices[:, :2], axis=1)
    on_cone = 3.0 + (1.5 - 3.0) * vertices[:, 2] / 3.0
    inner = vertices[22:-22]
    assert np.ptp(inner[:, 2]) > 1.5
    # A triangulated cone touches the smooth one at its vertices up to the faceting.
    assert np.abs(radius - on_cone).max() < 0.03


@pytest.mark.parametrize("n, error, size", [(5, 1e-7, (64, 98)), (10, 1e-6, (169, 288)), (15, 1e-4, (324, 578)), (20, 5e-4, (529, 968))])
def test_table_2(n, error, size):
    mesh, settings = table2(n)
    assert (mesh.number_of_vertices(), mesh.number_of_faces()) == size
    assert solve(mesh, settings=settings).max_error <= error


def test_unknown_examples_are_refused_in_words():
    with pytest.raises(ValueError, match="Examples 1 to 7"):
        examples_of(8)
    with pytest.raises(ValueError, match="Example 7 has no variant 'z'; its variants are 'a', 'b'"):
        examples_of(7, "z")


SCRIPTS = sorted((Path(__file__).parents[2] / "examples").glob("example*.py"))


@pytest.mark.parametrize("script", [*SCRIPTS, Path(__file__).parents[2] / "examples" / "cushion_field.py"], ids=lambda script: script.stem)
def test_scripts_run(script, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out


def test_every_example_has_a_script():
    assert [int(script.stem[7]) for script in SCRIPTS] == list(range(1, 8))


@pytest.mark.parametrize("name", ["nine_regions", "curved_crease"])
def test_the_rhino_files_are_what_their_script_makes(name, tmp_path):
    from compas_cgc.io import read_mesh

    folder = Path(__file__).parents[2] / "examples"
    runpy.run_path(str(folder / "make_inputs.py"))["main"](tmp_path)
    kept, _ = read_mesh(folder / f"{name}.3dm")
    made, _ = read_mesh(tmp_path / f"{name}.3dm")
    assert np.array_equal(kept.arrays()[0], made.arrays()[0]) and np.array_equal(kept.arrays()[1], made.arrays()[1])
    assert kept.supports() == made.supports() and kept.creases() == made.creases()
    assert len(kept.regions()) == {"nine_regions": 9, "curved_crease": 2}[name]
