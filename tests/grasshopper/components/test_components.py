"""Component bundles and the user objects made from them."""

from __future__ import annotations

import base64
import io
import json
import shutil
from dataclasses import dataclass

import pytest

from compas_cgc._version import __version__
from compas_cgc.errors import FileError
from compas_cgc.grasshopper.build.archive import from_bytes
from compas_cgc.grasshopper.build.archive import to_bytes
from compas_cgc.grasshopper.build.build_all import user_object_files
from compas_cgc.grasshopper.build.component_manifest import read_bundle
from compas_cgc.grasshopper.build.component_manifest import read_bundles
from compas_cgc.grasshopper.build.component_manifest import sources_folder
from compas_cgc.grasshopper.build.guids import HINTS
from compas_cgc.grasshopper.build.placeholders import option_text
from compas_cgc.grasshopper.build.placeholders import placeholders
from compas_cgc.grasshopper.build.userobject import is_ours
from compas_cgc.grasshopper.build.userobject import user_object
from compas_cgc.solvers import METHODS
from compas_cgc.solvers import Method
from compas_cgc.solvers import Settings
from compas_cgc.solvers import options
from compas_cgc.solvers import register
from compas_cgc.solvers import settings_for
from compas_cgc.solvers.settings import option

BUNDLES = {bundle.key: bundle for bundle in read_bundles()}
each = pytest.mark.parametrize("bundle", BUNDLES.values(), ids=BUNDLES)


def inner_archive(archive):
    """Return the component in a user object."""
    assert archive.name == "UserObject"
    return from_bytes(archive.get("Object"))


@each
def test_a_component_tells_its_user_what_it_does(bundle):
    assert bundle.category == "COMPAS CGC" and bundle.subcategory[:3] in ("01_", "02_", "03_", "04_")
    assert bundle.description.endswith(".") and all(p.description.endswith(".") for p in bundle.inputs + bundle.outputs)
    for parameter in bundle.inputs:
        assert parameter.optional, "an unconnected input is answered in a sentence, not by Grasshopper"
        takes = parameter.hint in ("none", "mesh", "point", "curve", "plane") or parameter.name in ("path", "K")
        assert takes or "Defaults to" in parameter.description, f"{parameter.name} must say its default"
    assert bundle.code.startswith("#! python 3\n# venv: compas_cgc\n") and "{{" not in bundle.code
    pinned = [f"# r: compas_cgc=={__version__}"] if bundle.key == "CGC_Install" else []
    assert [line for line in bundle.code.splitlines() if line.startswith("# r:")] == pinned, "one component installs the package"


def test_names_guids_and_icons_tell_the_components_apart():
    for name in ("name", "guid", "icon", "code"):
        assert len({getattr(bundle, name) for bundle in BUNDLES.values()}) == len(BUNDLES)
    names = "Server|CGC Mesh|Target|Constraints|Goals|Settings|Solve|Analyse|Regions|History|Read 3dm|Write 3dm|Example|Info|Mould"
    assert set(names.split("|")) <= {bundle.name for bundle in BUNDLES.values()}


@each
def test_icons_are_pictures_of_one_size_on_a_clear_ground(bundle):
    image = pytest.importorskip("matplotlib.image").imread(io.BytesIO(bundle.icon), format="png")
    assert image.shape == (24, 24, 4)
    assert image[0, 0, 3] == 0 and 0.1 < (image[..., 3] > 0.5).mean() < 0.9


# ----------------------------------------------------------------------
# What is refused
# ----------------------------------------------------------------------


def change(data, path, value):
    *path, last = path
    for key in path:
        data = data[key]
    if value is None:
        del data[last]
    else:
        data[last] = value


@pytest.mark.parametrize(
    "path, value, sentence",
    [
        (["nickName"], "x", "unknown key 'nickName'"),
        (["name"], None, "has no key 'name'"),
        (["exposure"], 3, "exposure must be one of"),
        (["exposure"], True, "'exposure' of metadata.json must be of type int, not True"),
        (["ghpython", "hideOutput"], True, "ghpython has the unknown key 'hideOutput'"),
        (["ghpython", "inputParameters", 0, "typeHint"], "mesh", "inputParameters 0 has the unknown key 'typeHint'"),
        (["ghpython", "inputParameters", 0, "typeHintID"], "Mesh", "the type hint 'Mesh' of mesh is none of"),
        (["ghpython", "inputParameters", 1, "scriptParamAccess"], "lists", "scriptParamAccess of supports must be one of"),
        (["ghpython", "inputParameters", 0, "name"], "my mesh", "must be a valid name of a variable"),
        (["ghpython", "inputParameters", 0, "name"], "surface", "RunScript takes"),
        (["ghpython", "inputParameters", 1, "name"], "mesh", "inputParameters has 'mesh' twice"),
        (["ghpython", "outputParameters", 1, "name"], "notes", "RunScript returns"),
        (["ghpython", "outputParameters", 1], None, "RunScript returns"),
    ],
)
def test_metadata_that_are_not_as_they_must_be(tmp_path, path, value, sentence):
    folder = tmp_path / "CGC_Mesh"
    shutil.copytree(sources_folder() / "CGC_Mesh", folder)
    data = json.loads((folder / "metadata.json").read_text(encoding="utf-8"))
    change(data, path, value)
    (folder / "metadata.json").write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(FileError, match=f"CGC_Mesh: .*{sentence}"):
        read_bundle(folder)


@pytest.mark.parametrize(
    "old, new, sentence",
    [
        ("#! python 3\n", "", "must begin with the line"),
        ("# venv: compas_cgc", "# venv: other", "must name the environment of the package"),
        ("def RunScript", "def Run", "a method RunScript"),
        ("return out.cgc_mesh, out.problems", "return out.problems, out.cgc_mesh", "RunScript returns"),
        ("return out.cgc_mesh, out.problems", "pass", "returns nothing"),
        ("flip: bool,", "flip: bool, more=1,", "RunScript takes"),
        ("import System", "match 1:\n    case 1: pass", "is not valid Python 3.9"),
    ],
)
def test_code_that_does_not_fit_its_metadata(tmp_path, old, new, sentence):
    folder = tmp_path / "CGC_Mesh"
    shutil.copytree(sources_folder() / "CGC_Mesh", folder)
    code = (folder / "code.py").read_text(encoding="utf-8")
    assert old in code
    (folder / "code.py").write_text(code.replace(old, new), encoding="utf-8")
    with pytest.raises(FileError, match=sentence):
        read_bundle(folder)


def test_a_placeholder_that_there_is_not_is_named(tmp_path):
    folder = tmp_path / "CGC_Settings"
    shutil.copytree(sources_folder() / "CGC_Settings", folder)
    text = (folder / "metadata.json").read_text(encoding="utf-8")
    (folder / "metadata.json").write_text(text.replace("{{options.delay}}", "{{options.wait}}"), encoding="utf-8")
    with pytest.raises(FileError, match="CGC_Settings: unknown placeholder {{options.wait}}; the placeholders are version, methods"):
        read_bundle(folder)


# ----------------------------------------------------------------------
# What is made from the registry of methods and the table of options
# ----------------------------------------------------------------------


def test_the_inputs_of_settings_are_those_of_the_table():
    inputs = {parameter.name: parameter for parameter in BUNDLES["CGC_Settings"].inputs}
    assert list(inputs) == "method steps tolerance s delay filter_radius nearness smoothness crease_stiffness measure".split(), (
        "saved canvases"
    )
    assert set(inputs) <= {"method", *options()}
    hints = {int: "int", float: "float", bool: "bool", str: "str"}
    for name, own in options().items():
        if name in inputs:
            assert inputs[name].hint == hints[own.kind] and inputs[name].description == option_text(own)
    assert inputs["s"].description.endswith("For the method flow. Defaults to 0.8, or 1 with a delay of creases.")
    assert all(repr(name) in inputs["method"].description for name in METHODS)


@dataclass(frozen=True)
class ToySettings(Settings):
    """Settings of a method that does nothing."""

    steps: int = option(7, "Most steps to take.", int, low=1)
    tolerance: float = option(1e-3, "As everywhere.", float, low=0)
    sparkle: float = option(1.0, "How much it sparkles.", float, low=0)


@pytest.fixture
def toy():
    """Register a fourth method for a while."""
    yield register(Method("toy", "Leaves everything as it is.", ToySettings, lambda problem, settings, callback: None))
    del METHODS["toy"]


def test_a_method_that_is_registered_is_in_the_built_component(toy):
    built = inner_archive(from_bytes(user_object_files()["CGC_Settings.ghuser"]))
    part = built.child("ParameterData").child("InputParam", 0)
    assert part.get("Name") == "method"
    assert part.get("Description").startswith("'auto', 'flow', 'newton', 'projection', 'bending' or 'toy'.")
    assert placeholders()["options.sparkle"] == "How much it sparkles. For the method toy. Defaults to 1."
    assert settings_for("toy", steps=9) == ToySettings(steps=9)


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(FileError, match="there are no components in"):
        read_bundles(tmp_path)
    folder = tmp_path / "CGC_Mesh"
    shutil.copytree(sources_folder() / "CGC_Mesh", folder)
    (folder / "icon.png").write_bytes(b"GIF89a")
    with pytest.raises(FileError, match="icon.png must be a PNG of 24 x 24"):
        read_bundle(folder)
    (folder / "icon.png").unlink()
    with pytest.raises(FileError, match="CGC_Mesh: .*icon.png"):
        read_bundle(folder)


# ----------------------------------------------------------------------
# User objects
# ----------------------------------------------------------------------

# What every user object that Rhino 8 saved holds, and nothing else.
OUTER = "BaseID Category Description Exposure Icon InstanceGuid Name NickName Object SubCategory".split()
ALWAYS = set(
    "Description GraftStandardOutputLines InstanceGuid MarshGuids MarshInputs MarshOutputs Name NickName ScriptComponentVersion Tooltip "
    "UsingLibraryInputParam UsingScriptInputParam UsingScriptOutputParam UsingStandardOutputParam".split()
)
PARAMETER = set(
    "AllowTreeAccess Description InstanceGuid Name NickName Optional ScriptParamAccess ScriptParameterVersion ShowTypeHints SourceCount "
    "ToolTip TypeHintID".split()
)


@each
def test_a_user_object_has_the_keys_that_rhino_writes(bundle):
    outer = from_bytes(to_bytes(user_object(bundle)))
    assert [entry.name for entry in outer.items] == OUTER and not outer.chunks
    assert outer.get("Icon") == bundle.icon and outer.get("Exposure") == bundle.exposure
    inner = inner_archive(outer)
    assert inner.name == "UserObject" and [part.name for part in inner.chunks] == ["ParameterData", "Script"]
    names = {entry.name for entry in inner.items}
    assert ALWAYS <= names <= ALWAYS | {"IconOverride", "IconDisplay"}
    script = inner.child("Script")
    assert base64.b64decode(script.get("Text")).decode("utf-8") == bundle.code
    language = script.child("LanguageSpec")
    assert (language.get("Taxon"), language.get("Version")) == ("*.*.python", "3.*")


@each
def test_parameters_come_back_as_declared(bundle):
    data = inner_archive(user_object(bundle)).child("ParameterData")
    guids = []
    for side, declared in (("Input", bundle.inputs), ("Output", bundle.outputs)):
        parts = data.children(f"{side}Param")
        assert data.get(f"{side}Count") == len(parts) == len(declared)
        assert all(data.has(f"{side}Id", i) for i in range(len(parts)))
        for part, parameter in zip(parts, declared):
            names = {entry.name for entry in part.items}
            assert names == PARAMETER | ({"Access"} if parameter.access != "item" else set())
            assert part.get("Name") == part.get("NickName") == parameter.name
            assert part.get("TypeHintID") == HINTS[parameter.hint].guid
            assert part.get("Access", default=0) == part.get("ScriptParamAccess") == ("item", "list", "tree").index(parameter.access)
            assert part.get("Optional") is part.get("AllowTreeAccess") is (side == "Input")
            assert part.child("ConverterData").get("TypeName") == HINTS[parameter.hint].type
            guids.append(part.get("InstanceGuid"))
    assert len(set(guids)) == len(guids)


def test_the_same_sources_give_the_same_bytes():
    again = {bundle.key: bundle for bundle in read_bundles()}
    for key, bundle in BUNDLES.items():
        assert to_bytes(user_object(bundle)) == to_bytes(user_object(again[key]))
    assert is_ours(to_bytes(user_object(BUNDLES["CGC_Solve"])))
    assert not is_ours(b"noise") and not is_ours(to_bytes(inner_archive(user_object(BUNDLES["CGC_Solve"]))))
