"""A Rhino file goes out: nothing that was in it is lost, and it is a valid input again."""

from __future__ import annotations

import json

import numpy as np
import pytest
import rhino3dm

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc import OnPlane
from compas_cgc import Rise
from compas_cgc import analyse
from compas_cgc import solve
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.discrete import vertex_areas
from compas_cgc.errors import FileError
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino import write_problem
from compas_cgc.io.rhino import write_result
from compas_cgc.io.rhino.designs import read_drawn_design
from compas_cgc.model.constraint_data import constraint_data
from compas_cgc.paper.examples import CATALOGUE
from compas_cgc.paper.examples import SurfaceExample

from ...support.rhino_models import ORIGINS
from ...support.rhino_models import Sketch
from ...support.rhino_models import corners_of
from ...support.rhino_models import quads
from ...support.rhino_models import row
from ...support.tiers import push_only

N = 9


def problem():
    mesh = CGCMesh.from_meshgrid(dx=N, nx=N)
    mesh.set_supports("boundary")
    mesh.set_creases([row(N, 3)])
    mesh.set_target(0.01)
    mesh.set_target(0.02, region=1)
    mesh.attributes.update(units="Feet", tolerance=0.25e-3)
    return mesh


def mesh_of(model):
    """Return the mesh of what was read, if all of it could be used."""
    return CGCMesh.from_problem(model.checked())


def same_problem(one, other):
    for name in ("vertices", "faces", "roles", "targets", "s", "e"):
        a, b = getattr(one, name), getattr(other, name)
        assert a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), name
    assert one.crease_paths() == other.crease_paths() and one.drawing == other.drawing


def objects(path):
    """Return the objects of a file by layer."""
    file = rhino3dm.File3dm.Read(str(path))
    found = {}
    for entry in file.Objects:
        found.setdefault(file.Layers[entry.Attributes.LayerIndex].FullPath, []).append(entry)
    return file, found


@pytest.mark.parametrize("version", [7, 8])
def test_a_problem_goes_out_and_comes_in(tmp_path, version):
    mesh = problem()
    write_problem(tmp_path / "a.3dm", mesh, version=version)
    file, found = objects(tmp_path / "a.3dm")
    assert file.ArchiveVersion == 10 * version and file.ApplicationName == "compas_cgc"
    assert {layer: len(entries) for layer, entries in found.items()} == {
        "CGC::Mesh": 1,
        "CGC::Supports": 4 * N,
        "CGC::Creases": 1,
        "CGC::Targets": 2,
    }
    back = mesh_of(read_3dm(tmp_path / "a.3dm"))
    assert back.attributes["units"] == "Feet" and back.attributes["tolerance"] == 0.25e-3
    assert back.vertices_role() == mesh.vertices_role() and [back.region_target(r) for r in range(2)] == [0.01, 0.02]
    with pytest.raises(ValueError, match="version"):
        write_problem(tmp_path / "b.3dm", mesh, version=6)


def test_targets_and_strategies_of_single_vertices_are_kept(tmp_path):
    mesh = problem()
    mesh.set_target(1 / 3, vertices=[55])
    mesh.set_strategy(s=0.25, vertices=[33])
    mesh.set_strategy(e=3, vertices=[34])
    write_problem(tmp_path / "a.3dm", mesh)
    back = mesh_of(read_3dm(tmp_path / "a.3dm"))
    for name in ("target", "s", "e"):
        inside = [v for v in mesh.vertices() if mesh.vertex_role(v) in ("internal", "crease")]
        assert mesh.vertices_attribute(name, keys=inside) == back.vertices_attribute(name, keys=inside)


@pytest.mark.parametrize("example", [e for e in CATALOGUE if isinstance(e, SurfaceExample)], ids=lambda e: e.name)
@pytest.mark.parametrize("origin", push_only(ORIGINS, ORIGINS[-1]))
def test_every_example_of_the_paper_survives_bit_for_bit(tmp_path, example, origin):
    mesh, _ = example.build()
    mesh = mesh.without_dummies()
    mesh = mesh.with_coordinates(mesh.arrays()[0] + np.array(origin) / 3)
    write_problem(tmp_path / "a.3dm", mesh)
    model = read_3dm(tmp_path / "a.3dm")
    back = mesh_of(model)
    one, other = mesh.to_problem(), back.to_problem()
    assert one.vertices.tobytes() == other.vertices.tobytes() and np.array_equal(one.faces, other.faces)
    assert np.array_equal(one.roles, other.roles) and np.array_equal(one.regions(), other.regions())
    assert np.array_equal(one.creases, other.creases) and np.array_equal(one.targets[one.asked], other.targets[other.asked])
    K, L = gaussian_curvature(one.vertices, one.faces), gaussian_curvature(other.vertices, other.faces)
    assert np.array_equal(K, L, equal_nan=True)


def test_units_that_are_none_are_refused(tmp_path):
    mesh = problem()
    mesh.attributes["units"] = "Cubits"
    with pytest.raises(FileError, match="unknown unit 'Cubits'"):
        write_problem(tmp_path / "a.3dm", mesh)
    assert not list(tmp_path.iterdir())


def test_a_result_has_the_version_of_its_source(tmp_path):
    result = solve(problem())
    for version in (7, 8):
        write_problem(tmp_path / "a.3dm", problem(), version=version)
        write_result(tmp_path / "b.3dm", result, tmp_path / "a.3dm")
        assert objects(tmp_path / "b.3dm")[0].ArchiveVersion == 10 * version
    write_result(tmp_path / "b.3dm", result)
    assert objects(tmp_path / "b.3dm")[0].ArchiveVersion == 70


@pytest.fixture
def handed_over(tmp_path):
    """Return a file with everything in it that has to survive."""
    sketch = Sketch("Centimeters", 0.02)
    vertices, faces = quads(N, 900.0)
    vertices = vertices + [1e5, 0, 0]
    roof = sketch.mesh(vertices, faces, "CGC::Mesh", {"architect": "Ä. Müller"}, name="roof")
    sketch.points(vertices[corners_of(N)], "CGC::Supports")
    sketch.curve(vertices[row(N, 3)], "CGC::Creases", {"s": "0.7"})
    sketch.dot("K=1e-6", vertices[11] + [5, 5, 0], "CGC::Targets")
    sketch.dot("K=2e-6", vertices[55] + [5, 5, 0], "CGC::Targets")
    circle = rhino3dm.Circle(rhino3dm.Point3d(0, 0, 0), 3.0)
    attributes = sketch.on("Site::Trees", {"kind": "oak"}, "tree")
    attributes.ObjectColor, attributes.ColorSource = (1, 2, 3, 255), rhino3dm.ObjectColorSource.ColorFromObject
    tree = str(sketch.file.Objects.AddCurve(circle.ToNurbsCurve(), attributes))
    sketch.file.Strings["project"] = "Hall 7"
    sketch.file.Layers[attributes.LayerIndex].SetUserString("plan", "A1")
    view = rhino3dm.ViewInfo()
    view.Name = "entrance"
    sketch.file.NamedViews.Add(view)
    return sketch.save(tmp_path / "hall.3dm"), roof, tree


def test_the_input_is_kept_and_the_result_stands_beside_it(handed_over, tmp_path):
    source, roof, tree = handed_over
    before = source.read_bytes()
    model = read_3dm(source)
    result = solve(mesh_of(model), settings={"s": 0.7})
    out = tmp_path / "out.3dm"
    write_result(out, result, source)
    assert source.read_bytes() == before
    file, found = objects(out)
    old, old_found = objects(source)

    assert (file.Settings.ModelUnitSystem, file.Settings.ModelAbsoluteTolerance) == (rhino3dm.UnitSystem.Centimeters, 0.02)
    assert [view.Name for view in file.NamedViews] == ["entrance"] and file.Strings["project"] == "Hall 7"
    for layer, entries in old_found.items():
        assert [str(e.Attributes.Id) for e in found[layer]] == [str(e.Attributes.Id) for e in entries]
        for one, other in zip(entries, found[layer]):
            assert one.Geometry.Encode()["data"] and one.Attributes.GetUserStrings() == other.Attributes.GetUserStrings()
            assert (one.Attributes.Name, one.Attributes.ObjectColor) == (other.Attributes.Name, other.Attributes.ObjectColor)
    (site,) = [layer for layer in file.Layers if layer.FullPath == "Site::Trees"]
    assert site.GetUserString("plan") == "A1" and any(str(e.Attributes.Id) == tree for e in found["Site::Trees"])

    parts = {layer.split("::")[1]: entries for layer, entries in found.items() if layer.startswith("CGC Result")}
    assert set(parts) - {"Rough"} == {"Mesh", "Drawn", "Regions", "Supports", "Creases", "Curvature", "Error", "Report"}
    vertices, faces = result.mesh.arrays()
    drawn, solved = (read_3dm(out, result=own) for own in (False, True))
    assert np.ptp(drawn.problem.vertices[:, 2]) == 0.0 < np.ptp(solved.problem.vertices[:, 2])
    assert "the drawing in the file is used, not its result" in drawn.notes and "result in the file is used" in solved.notes[0]
    with pytest.warns(UserWarning, match="the drawing in the file is used, not its result"):
        read_again = compas_cgc.read(out)
    assert np.array_equal(read_again.to_problem().vertices, drawn.problem.vertices)
    assert np.array_equal(compas_cgc.read(out, result=True).to_problem().vertices, solved.problem.vertices)
    design = read_drawn_design(out)
    assert np.array_equal(np.unique(design.vertices, axis=0), np.unique(drawn.problem.vertices, axis=0))
    assert design.notes[0] == "the drawing in the file is used, not its result"
    assert not any("result" in note for note in model.notes)
    (mesh,) = parts["Mesh"]
    written = np.array([(p.X, p.Y, p.Z) for p in mesh.Geometry.Vertices.ToPoint3dArray()])
    assert written.tobytes() == vertices.tobytes() and mesh.Attributes.GetUserString("status") == result.status
    assert float(mesh.Attributes.GetUserString("max error")) == analyse(result).max_error
    regions = [dict(entry.Attributes.GetUserStrings()) for entry in parts["Regions"]]
    assert [float(region["K"]) for region in regions] == [1e-6, 2e-6]
    for region in regions:
        assert float(region["K reached"]) == pytest.approx(float(region["K"]), rel=1e-3)
        assert float(region["error"]) <= 1e-6 * 2e-6 and float(region["area"]) > 0
    assert len(parts["Supports"]) == 4 and len(parts["Creases"]) == 1
    for name in ("Curvature", "Error"):
        coloured = [e.Geometry for e in parts[name] if isinstance(e.Geometry, rhino3dm.Mesh)]
        legend = [e for e in parts[name] if isinstance(e.Geometry, rhino3dm.TextDot)]
        assert len(coloured) == 1 and len(coloured[0].VertexColors) == len(vertices) and len(legend) == 6
        assert len({e.Attributes.ObjectColor for e in legend}) == 6
    (report,) = parts["Report"]
    lines = report.Geometry.Text.splitlines()
    assert lines[0].startswith("hall.3dm: ") and result.status in lines[0]
    text = report.Attributes.GetUserString("report")
    assert text == file.Strings["compas_cgc.report"] and text.count("\n") > 3
    dots = [e.Geometry.Text for own in parts.values() for e in own if isinstance(e.Geometry, rhino3dm.TextDot)]
    assert len(dots) > 10 and all(text.count("\n") < 3 and max(map(len, text.splitlines())) <= 40 for text in dots)
    record = json.loads(file.Strings["compas_cgc.result"])
    assert record["status"] == result.status and record["units"] == "Centimeters" and len(record["regions"]) == 2
    assert json.loads(file.Strings["compas_cgc.settings"])["s"] == 0.7 == result.settings.s


def test_what_was_reached_is_measured_on_the_surface_and_not_what_was_asked(tmp_path):
    """After five steps of the flow the regions are far from their targets: the file says how far each is."""
    result = solve(problem(), settings=FlowSettings(steps=5, finish=False))
    write_result(tmp_path / "a.3dm", result)
    _, found = objects(tmp_path / "a.3dm")
    mesh = result.problem
    K, area = gaussian_curvature(mesh.vertices, mesh.faces), vertex_areas(mesh.vertices, mesh.faces)
    regions = [dict(entry.Attributes.GetUserStrings()) for entry in found["CGC Result::Regions"]]
    for number, region in enumerate(regions):
        inside = np.unique(mesh.faces[mesh.regions() == number])
        inside = inside[mesh.asked[inside]]
        assert float(region["K"]) == [0.01, 0.02][number]
        assert float(region["K reached"]) == pytest.approx((K * area)[inside].sum() / area[inside].sum(), rel=1e-9)
        assert float(region["error"]) == pytest.approx(np.abs(K[inside] - float(region["K"])).max(), rel=1e-9)
        assert abs(float(region["K reached"]) - float(region["K"])) > 1e-3
    (report,) = found["CGC Result::Report"]
    assert f"largest error of K {result.max_error:.3g} 1/ft²" in report.Geometry.Text


@pytest.mark.parametrize("source", [True, False])
def test_a_result_keeps_the_constraints(tmp_path, source):
    mesh = problem()
    mesh.set_goals([Height([55], 0.5), OnPlane([36], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0])])
    write_problem(tmp_path / "a.3dm", mesh)
    result = solve(mesh, method="projection")  # alone, without a search for why a roof held down at a vertex is rough
    write_result(tmp_path / "b.3dm", result, tmp_path / "a.3dm" if source else None)
    back = read_3dm(tmp_path / "b.3dm").checked()
    assert list(map(constraint_data, back.goals)) == list(map(constraint_data, mesh.goals()))


def test_the_result_is_an_input_for_the_same_problem_even_on_top_of_itself(handed_over, tmp_path):
    source, *_ = handed_over
    model = read_3dm(source)
    result = solve(mesh_of(model))
    write_result(source, result, source)
    first = objects(source)[1]
    same_problem(read_3dm(source).problem, model.problem)
    write_result(source, result, source)
    again = objects(source)[1]
    assert {layer: len(entries) for layer, entries in first.items()} == {layer: len(entries) for layer, entries in again.items()}


def test_targets_given_elsewhere_come_back_from_the_regions_of_the_result(tmp_path):
    sketch = Sketch()
    vertices, faces = quads(N, float(N))
    sketch.mesh(vertices, faces)
    sketch.curve(vertices[row(N, 3)])
    sketch.points(vertices[corners_of(N)])
    source = sketch.save(tmp_path / "a.3dm")
    mesh = mesh_of(read_3dm(source))
    mesh.set_target(0.01)
    mesh.set_target(0.02, region=1)
    write_result(tmp_path / "b.3dm", solve(mesh), source)
    back = read_3dm(tmp_path / "b.3dm")
    assert [mesh_of(back).region_target(r) for r in range(2)] == [0.01, 0.02]
    assert back.problem.vertices.tobytes() == vertices.tobytes()
    sketch.curve(vertices[row(N, 6)])
    write_result(tmp_path / "c.3dm", solve(mesh), sketch.save(tmp_path / "a.3dm"))
    changed = read_3dm(tmp_path / "c.3dm")
    assert any("do not match this mesh" in note for note in changed.notes) and np.isnan(changed.problem.targets).all()


def test_a_note_says_where_drawn_targets_differ_from_those_of_an_earlier_result(tmp_path):
    write_problem(tmp_path / "a.3dm", problem().to_problem())
    drawn = read_3dm(tmp_path / "a.3dm")
    result = solve(mesh_of(drawn), method="bending", goals=[Rise(2.0)], unknown=[1])
    write_result(tmp_path / "b.3dm", result, tmp_path / "a.3dm")
    back = read_3dm(tmp_path / "b.3dm")
    assert [mesh_of(back).region_target(r) for r in range(2)] == [mesh_of(drawn).region_target(r) for r in range(2)]
    assert any("other values than the targets drawn in 1 region; the drawn ones were used" in note for note in back.notes)
    assert not any("without other targets" in note for note in back.notes)


def test_a_result_alone_is_the_next_input(tmp_path):
    result = solve(problem())
    write_result(tmp_path / "a.3dm", result)
    model = read_3dm(tmp_path / "a.3dm")
    back = mesh_of(model)
    assert any("earlier result" in note for note in model.notes)
    assert back.arrays()[0].tobytes() == result.mesh.arrays()[0].tobytes()
    assert back.vertices_role() == result.mesh.vertices_role() and back.region_target(1) == 0.02
    K = gaussian_curvature(*back.arrays())
    assert np.array_equal(K, gaussian_curvature(*result.mesh.arrays()), equal_nan=True)


def test_a_result_that_was_edited_in_rhino_is_a_drawing(tmp_path):
    result, path = solve(problem()), str(tmp_path / "a.3dm")
    write_result(path, result)
    assert np.array_equal(read_3dm(path).problem.drawn.vertices, result.start)
    file, found = objects(path)
    (solved,) = found["CGC Result::Mesh"]
    moved = solved.Geometry.Vertices[22]
    solved.Geometry.Vertices[22] = rhino3dm.Point3f(moved.X, moved.Y, moved.Z + 0.5)
    file.Write(path, 7)
    assert read_3dm(path).problem.origin is None


@pytest.mark.parametrize("damage", ["replace", "Write"])
def test_half_a_file_is_never_left(handed_over, tmp_path, monkeypatch, damage):
    source, *_ = handed_over
    result = solve(mesh_of(read_3dm(source)))
    before = source.read_bytes()
    if damage == "replace":

        def full(*_):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("compas_cgc._atomic_write.os.replace", full)
    else:
        monkeypatch.setattr(rhino3dm.File3dm, "Write", lambda *_: False)
    with pytest.raises(FileError, match="cannot be written"):
        write_result(source, result, source)
    assert source.read_bytes() == before and [p.name for p in tmp_path.iterdir()] == ["hall.3dm"]
