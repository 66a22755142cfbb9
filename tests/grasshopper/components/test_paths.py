"""Paths on wires: relative to the definition, with or without quotes."""

from __future__ import annotations

import pytest

from compas_cgc import solve

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from .test_solve import dome

pytestmark = pytest.mark.usefixtures("rhino")


@pytest.mark.parametrize("text", ["roofs/dome.obj", '"roofs/dome.obj"', " 'roofs/dome.obj' "])
def test_relative_paths_begin_in_the_folder_of_the_definition(tmp_path, monkeypatch, text):
    (tmp_path / "roofs").mkdir()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    write, read = place("Write3dm"), place("Read3dm")
    for placed in (write, read):
        placed.component.document.FilePath = str(tmp_path / "roof.gh")
    out = write.run(path=text, cgc_mesh=dome(), write=True)
    assert out["written"].AllData() == [str(tmp_path / "roofs" / "dome.obj")] and (tmp_path / "roofs" / "dome.obj").exists()
    assert read.run(path=text)["cgc_mesh"].number_of_vertices() == 100


def test_without_a_saved_definition_they_begin_in_the_current_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place("Write3dm").run(path="dome.obj", cgc_mesh=dome(), write=True)
    assert (tmp_path / "dome.obj").exists()


def test_two_branches_do_not_write_one_file(tmp_path):
    placed, (one, two) = place("Membrane"), (str(tmp_path / f"{name}.json") for name in ("one", "two"))

    def solution(*rows):
        errors = []
        for placed.component.RunCount, (mesh, path) in enumerate(rows, 1):
            out = placed.settle(cgc_mesh=mesh, pressure=1.0, path=path, write=True)
            errors.append(placed.said("Error"))
            assert (out["report"] is None) == (mesh is None or bool(errors[-1]))
        return errors

    first, second = solve(dome(0.01)).mesh, solve(dome(0.02)).mesh
    sentence = f"an earlier branch writes {one}; connect one path for each surface"
    assert solution((first, one), (second, one)) == [[], [sentence]]
    text = (tmp_path / "one.json").read_text(encoding="utf-8")
    assert solution((first, one), (second, two)) == [[], []]
    assert (tmp_path / "one.json").read_text(encoding="utf-8") == text != (tmp_path / "two.json").read_text(encoding="utf-8")
    assert solution((None, one), (second, one)) == [[], []], "a null writes nothing"
