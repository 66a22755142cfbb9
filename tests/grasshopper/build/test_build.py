"""``compas-cgc grasshopper``: what is made, that it is the same every time, and where it is put."""

from __future__ import annotations

import io
import re
import shutil
import zipfile
from base64 import b64decode
from pathlib import Path

import pytest

from compas_cgc._version import __version__
from compas_cgc.cli.main import main
from compas_cgc.errors import FileError
from compas_cgc.grasshopper.build import component_manifest as bundle
from compas_cgc.grasshopper.build.archive import from_bytes
from compas_cgc.grasshopper.build.archive import read_archive
from compas_cgc.grasshopper.build.build_all import built_files
from compas_cgc.grasshopper.build.component_manifest import read_bundles
from compas_cgc.grasshopper.build.component_manifest import sources_folder
from compas_cgc.grasshopper.build.install import install
from compas_cgc.grasshopper.build.install import uninstall
from compas_cgc.grasshopper.build.install import user_objects_folder

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def files():
    return built_files()


def test_the_command_makes_the_whole_set(tmp_path, capsys, files):
    assert main(["grasshopper", "build", "-o", str(tmp_path / "out")]) == 0
    made = {path.relative_to(tmp_path / "out").as_posix(): path.read_bytes() for path in (tmp_path / "out").rglob("*.*")}
    assert made == files, "a second build must give the same bytes"
    said = capsys.readouterr().out.splitlines()
    assert len(said) == len(files)
    for path in (tmp_path / "out").rglob("*.gh*"):
        assert read_archive(path).name in ("Root", "UserObject")
    components = {path.name for path in sources_folder().iterdir()}
    assert {name.split("/")[1][:-7] for name in files if name.startswith("components/")} == components


def test_the_package_is_what_rhino_expects(files):
    (name,) = [name for name in files if name.endswith(".yak")]
    assert name == f"compas_cgc-{__version__}-rh8-any.yak"
    package = zipfile.ZipFile(io.BytesIO(files[name]))
    assert package.testzip() is None
    names = package.namelist()
    assert names[0] == "manifest.yml" and names[1:] == sorted(names[1:])
    manifest = package.read("manifest.yml").decode("utf-8")
    assert manifest.startswith(f"---\nname: compas_cgc\nversion: {__version__}\nauthors:\n- ") and "\ndescription: " in manifest
    assert package.read("icon.png")[16:24] == b"\0\0\0\x40" * 2, "64 x 64"
    for entry in package.infolist():
        assert entry.date_time == (1980, 1, 1, 0, 0, 0) and entry.compress_type == zipfile.ZIP_DEFLATED and not entry.is_dir()
        if entry.filename.endswith(".ghuser"):
            assert package.read(entry) == files[f"components/{entry.filename}"]
    assert {f"examples/{path[12:]}" for path in files if path.endswith(".gh")} < set(names)


def directives(archive):
    """Return the lines that Rhino acts on in all scripts of a user object or a definition."""
    texts = [b64decode(part.get("Text")).decode("utf-8") for part in chunks_of(archive, "Script") if part.get("Text")]
    return [[line for line in text.splitlines() if line.startswith(("# r:", "# venv:", "# env:"))] for text in texts]


def chunks_of(chunk, name):
    found = [from_bytes(chunk.get("Object"))] if chunk.get("Object") else []
    inner = [part for own in (*chunk.chunks, *found) for part in chunks_of(own, name)]
    return [chunk, *inner] if chunk.name == name else inner


@pytest.mark.parametrize("package", [None, "https://packages.example.com/wheels", "WHEEL", "FOLDER"])
def test_one_component_installs_the_package_from_the_source_of_the_office(tmp_path, package):
    name = f"compas_cgc-{__version__}-py3-none-any.whl"
    wheel = tmp_path / "our wheels" / name
    wheel.parent.mkdir()
    wheel.write_bytes(b"")
    given = {"WHEEL": str(wheel), "FOLDER": str(wheel.parent)}.get(package, package)
    wanted = {None: f"compas_cgc=={__version__}", "https://packages.example.com/wheels": f"compas_cgc @ {package}/{name}"}
    requirement = wanted.get(package, f"compas_cgc @ {wheel.as_uri()}")
    out = tmp_path / "out"
    assert main(["grasshopper", "build", "-o", str(out), *(["--package", given] if given else [])]) == 0
    users = {path.stem: directives(read_archive(path))[0] for path in (out / "components").glob("*.ghuser")}
    assert users.pop("CGC_Install") == ["# venv: compas_cgc", f"# r: {requirement}"]
    assert len(users) == 22 and all(own == ["# venv: compas_cgc"] for own in users.values())
    for path in (out / "definitions").glob("*.gh"):
        found = directives(read_archive(path))
        if not path.stem.startswith("hops"):
            assert found[0] == ["# venv: compas_cgc", f"# r: {requirement}"], "it comes before the components that import the package"
            assert all(own == ["# venv: compas_cgc"] for own in found[1:]) and len(found) > 2


@pytest.mark.parametrize(
    ("package", "sentence"),
    [
        ("nowhere", "there is no wheel .*nowhere"),
        ("https://packages.example.com/compas_cgc-0.0.1-py3-none-any.whl", "compas_cgc-0.0.1-py3-none-any.whl is not compas_cgc "),
    ],
)
def test_a_package_that_rhino_could_not_install_is_refused(tmp_path, capsys, package, sentence):
    out = tmp_path / "out"
    assert main(["grasshopper", "build", "-o", str(out), "--package", package]) != 0
    assert re.search(sentence, capsys.readouterr().err) and not out.exists()


# ----------------------------------------------------------------------
# Installing
# ----------------------------------------------------------------------


def test_where_rhino_8_looks(tmp_path):
    windows = tmp_path / "Grasshopper"
    windows.mkdir()
    assert user_objects_folder("Windows", {"APPDATA": str(tmp_path)}) == windows / "UserObjects"
    mac = tmp_path / "Library/Application Support/McNeel/Rhinoceros/8.0/Plug-ins/Grasshopper (b45a29b1-4343-4035-989e-044e8580d9cf)"
    mac.mkdir(parents=True)
    assert user_objects_folder("Darwin", {"HOME": str(tmp_path)}) == mac / "UserObjects"
    with pytest.raises(FileError, match="start Rhino 8 and Grasshopper once"):
        user_objects_folder("Windows", {"APPDATA": str(tmp_path / "other")})
    with pytest.raises(FileError, match="Windows and macOS only; choose a folder with --to"):
        user_objects_folder("Linux", {})


def test_there_and_away_again(tmp_path, capsys):
    folder = tmp_path / "UserObjects"
    folder.mkdir()
    (folder / "Other.ghuser").write_bytes(b"somebody else's")
    to = ["--to", str(folder)]
    assert main(["grasshopper", "install", *to, "--dry-run"]) == 0
    assert "would write" in capsys.readouterr().out and len(list(folder.iterdir())) == 1
    assert main(["grasshopper", "install", *to]) == 0
    count = len(list(sources_folder().iterdir()))
    assert "restart Rhino 8" in capsys.readouterr().out and len(list(folder.iterdir())) == count + 1
    assert main(["grasshopper", "install", *to]) == 0, "a second time renews them"
    assert len(list(folder.iterdir())) == count + 1
    assert main(["grasshopper", "uninstall", *to, "--dry-run"]) == 0
    assert len(list(folder.iterdir())) == count + 1
    assert main(["grasshopper", "uninstall", *to]) == 0
    assert [path.name for path in folder.iterdir()] == ["Other.ghuser"]
    capsys.readouterr()
    assert main(["grasshopper", "uninstall", *to]) == 0 and capsys.readouterr().out == "there is nothing to remove\n"


def test_components_that_are_no_more_are_taken_away_and_those_of_others_are_not(tmp_path, files):
    data = files["components/CGC_Solve.ghuser"]
    assert install({"CGC_Old.ghuser": data, "CGC_Solve.ghuser": data}, tmp_path) == (
        [tmp_path / "CGC_Old.ghuser", tmp_path / "CGC_Solve.ghuser"],
        [],
    )
    assert install({"CGC_Solve.ghuser": data}, tmp_path) == ([tmp_path / "CGC_Solve.ghuser"], [tmp_path / "CGC_Old.ghuser"])
    (tmp_path / "CGC_Mine.ghuser").write_bytes(b"somebody else's")
    with pytest.raises(FileError, match="does not belong to compas_cgc; move it"):
        install({"CGC_Mine.ghuser": data}, tmp_path)
    assert uninstall(tmp_path) == [tmp_path / "CGC_Solve.ghuser"] and (tmp_path / "CGC_Mine.ghuser").exists()


def test_the_components_are_in_the_package_or_beside_it(tmp_path, monkeypatch):
    assert sources_folder() == ROOT / "ghuser" / "components", "of the clone that these tests are in"
    package = tmp_path.resolve() / "site-packages" / "compas_cgc"
    monkeypatch.setattr(bundle, "__file__", str(package / "grasshopper" / "build" / "bundle.py"))
    with pytest.raises(FileError, match="reinstall compas_cgc, or give their folder with --source"):
        sources_folder()
    for parent in (package.parent, package):
        (parent / "ghuser" / "components").mkdir(parents=True)
        assert sources_folder() == parent / "ghuser" / "components", "its own come first"


def test_wrong_sources_end_in_one_sentence(tmp_path, capsys):
    assert main(["grasshopper", "build", "-o", str(tmp_path / "out"), "--source", str(tmp_path)]) == 2
    assert "there are no components in" in capsys.readouterr().err
    shutil.copytree(sources_folder() / "CGC_Info", tmp_path / "components" / "CGC_Info")
    (tmp_path / "components" / "CGC_Info" / "code.py").write_text("def", encoding="utf-8")
    assert main(["grasshopper", "build", "-o", str(tmp_path / "out"), "--source", str(tmp_path / "components")]) == 2
    assert "CGC_Info: code.py is not valid Python 3.9" in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_the_pictures_of_the_guide_are_those_of_the_definitions(files):
    folder = ROOT / "docs" / "images" / "grasshopper"
    pictures = {path.name: path.read_bytes() for path in folder.glob("*.svg")}
    assert pictures == {path[12:]: data for path, data in files.items() if path.endswith(".svg")}, "copy them from the build"
    guide = (ROOT / "docs" / "grasshopper.md").read_text(encoding="utf-8")
    assert all(f"(images/grasshopper/{name})" in guide for name in pictures)
    assert all(f"**{one.name}**" in guide for one in read_bundles())
