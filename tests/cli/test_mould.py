"""``compas-cgc mould``: from a solved file to moulds, panels, labels and a page, or one sentence and nothing written."""

from __future__ import annotations

import json

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.cli import main
from compas_cgc.io.rhino import write_problem
from compas_cgc.io.rhino import write_result
from compas_cgc.io.rhino.meshes import mesh_to_arrays

from ..support.roofs import nine_regions
from ..support.shapes import grid


@pytest.fixture(scope="module")
def result():
    return solve(nine_regions(12, centre=-0.01), method="projection", settings={"measure": "exact"})


@pytest.fixture
def solved(result, tmp_path):
    """A drawing with its result, as solve writes it."""
    drawing, path = tmp_path / "roof.3dm", tmp_path / "solved.3dm"
    write_problem(drawing, nine_regions(12, centre=-0.01))
    write_result(path, result, source=drawing)
    return path


def things(path):
    """Return the objects of a file by layer, with name and user text."""
    file = rhino3dm.File3dm.Read(str(path))
    layers = {layer.Index: layer.FullPath for layer in file.Layers}
    found: dict = {}
    for item in file.Objects:
        text = dict(item.Attributes.GetUserStrings() or ())
        found.setdefault(layers[item.Attributes.LayerIndex], []).append((item.Attributes.Name, item.Geometry, text))
    return found, file


def test_panels_that_would_break_give_an_exit_code(solved, tmp_path, capsys):
    given = ["mould", str(solved), "-o", str(tmp_path / "moulds.csv"), "--size", "2.5", "--material", "glass", "--no-page"]
    assert main([*given, "--thickness", "0.1"]) == 0 and "NOT BUILDABLE" not in capsys.readouterr().out
    assert main([*given, "--thickness", "100"]) == 3 and "NOT BUILDABLE like this: " in capsys.readouterr().out
    assert (tmp_path / "moulds.csv").exists()


def test_moulds_panels_and_labels_on_layers(solved, result, tmp_path, capsys):
    output, figures = tmp_path / "moulds.3dm", tmp_path / "moulds.json"
    given = ["mould", str(solved), "-o", str(output), "--size", "2.5", "--material", "gfrp", "--thickness", "8", "--report", str(figures)]
    assert main(given) == 0
    said = capsys.readouterr().out
    assert (
        "36 panels on 2 moulds" in said
        and "8 mm of glass-fibre reinforced plastic (gfrp)" in said
        and f"wrote {tmp_path / 'moulds.pdf'}" in said
    )
    assert (tmp_path / "moulds.pdf").read_bytes().startswith(b"%PDF")
    record = json.loads(figures.read_text(encoding="utf-8"))
    found, file = things(output)
    surfaces = [one for _, one, _ in found["CGC Moulds::Moulds"] if isinstance(one, rhino3dm.NurbsSurface)]
    assert len(surfaces) == 2 and len(found["CGC Moulds::Outlines"]) == 36
    offsets = {name: text["offset"] for name, one, text in found["CGC Moulds::Faces"] if isinstance(one, rhino3dm.NurbsSurface)}
    assert offsets == {
        f"{side} face on mould {mould}": offset for mould in (1, 2) for side, offset in (("lower", "-0.004"), ("upper", "0.004"))
    }
    assert len(found["CGC Moulds::Labels"]) == 2 + 2 * 36
    assert json.loads(file.Strings["compas_cgc.moulds"])["panels"] == record["panels"]
    assert "CGC Result::Mesh" in found and "CGC::Mesh" in found  # what was in the file stays
    on = {name: mesh_to_arrays(mesh) for name, mesh, _ in found["CGC Moulds::Panels on moulds"]}
    figures_of = {own["panel"]: own for own in record["panels"]}
    for name, mesh, text in found["CGC Moulds::Panels in place"]:
        own = figures_of.pop(name)
        assert float(text["deviation without bending mm"]) == own["rigid"] and own["edge_error"] <= 1e-11
        (V, F), (W, G) = mesh_to_arrays(mesh), on[name]
        distance, _ = nearest(V, result.vertices)
        assert distance.max() == 0.0
        if record["moulds"][own["mould"] - 1]["K"] > 0:
            assert np.array_equal(np.sort(F[:, :3], axis=1), np.sort(G[:, :3], axis=1))
            there, here = lengths(V, F), lengths(W, F)
            assert np.allclose(here, there, rtol=1e-11)
    assert not figures_of


def nearest(points, others):
    from scipy.spatial import cKDTree

    return cKDTree(others).query(points)


def lengths(V, F):
    return np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1)


def test_panels_along_curves_of_a_layer(solved, result, tmp_path):
    file = rhino3dm.File3dm.Read(str(solved))
    layer = rhino3dm.Layer()
    layer.Name = "Joints"
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = file.Layers.Add(layer)
    row = result.vertices[6 * 13 + np.arange(13)]
    file.Objects.AddPolyline([rhino3dm.Point3d(*point) for point in row.tolist()], attributes)
    file.Write(str(solved), 7)
    output = tmp_path / "moulds.3dm"
    assert main(["mould", str(solved), "-o", str(output), "--curves", "Joints", "--material", "gfrp", "--no-page", "-q"]) == 0
    assert len(things(output)[0]["CGC Moulds::Panels in place"]) == 12
    assert not (tmp_path / "moulds.pdf").exists()


def test_a_file_without_targets_takes_them_by_region(result, tmp_path, capsys):
    vertices, faces = grid(8)
    flat = tmp_path / "flat.obj"
    write(flat, CGCProblem(vertices, faces).with_supports("boundary"))
    output = tmp_path / "moulds.3dm"
    assert main(["mould", str(flat), "-o", str(output), "--count", "4", "--target", "0=0", "--no-page"]) == 0
    assert "plane of K = 0" in capsys.readouterr().out


@pytest.mark.parametrize(
    "given, sentence",
    [
        (["--size", "0"], "the size of panels must be a positive length"),
        (["--size", "1", "--material", "cheese"], "there is no material 'cheese'"),
        (["--size", "1", "--target", "1.0"], "the surface is rough"),
        (["--curves", "Nowhere"], "the layer 'Nowhere' has no curves"),
        (["--size", "1", "--along", "laths"], "along must be one of plan, curvature"),
        (["--size", "1", "--schedule", "{folder}/moulds.pdf"], "the page of pictures is"),
        (["--size", "3", "--no-page", "--schedule", "{folder}/moulds.csv", "--schedule", "{folder}/moulds.csv"], "two outputs would be"),
        (["--size", "1", "--target", "wide"], "--target must be a number or REGION=NUMBER"),
    ],
)
def test_what_makes_no_sense_is_told_in_a_sentence_and_nothing_is_written(solved, tmp_path, capsys, given, sentence):
    before = sorted(tmp_path.iterdir())
    given = [own.format(folder=tmp_path) for own in given]
    output, figures = tmp_path / "moulds.3dm", tmp_path / "moulds.json"
    assert main(["mould", str(solved), "-o", str(output), "--report", str(figures), *given]) == 2
    error = capsys.readouterr().err
    assert sentence in error and error.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


def test_a_drawing_that_was_never_solved_and_other_suffixes_are_refused(tmp_path, capsys):
    drawing = tmp_path / "roof.3dm"
    write_problem(drawing, nine_regions(9))
    assert main(["mould", str(drawing), "-o", str(tmp_path / "moulds.3dm"), "--size", "2.5"]) == 2
    assert "the surface is rough" in capsys.readouterr().err
    assert main(["mould", str(drawing), "-o", str(tmp_path / "moulds.obj"), "--size", "1"]) == 2
    assert "moulds.obj" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [drawing]
