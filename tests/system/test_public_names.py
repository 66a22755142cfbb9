"""One sweep over all public names: docstrings are complete, examples run, and arguments of a wrong kind get a sentence of the package."""

from __future__ import annotations

import dataclasses
import doctest
import functools
import importlib
import inspect
import operator
import pickle
import pkgutil
import re
import typing
import warnings
from pathlib import Path

import numpy as np
import pytest
from compas.datastructures import Mesh

import compas_cgc
from compas_cgc.errors import is_own_sentence
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.plot import Curve
from compas_cgc.plot import Shape
from compas_cgc.plot import history_figure
from compas_cgc.study import Study

# Components are documented on the canvas, commands by their help.
UNDOCUMENTED = {"compas_cgc.cli", "compas_cgc.grasshopper.components"}
# Packages whose names are called with wrong arguments, beside the top level. Servers and clients have their own tests.
PACKAGES = ("analysis", "datastructures", "discrete", "fabrication", "io", "meshing", "plot", "solvers", "study")
SKIPPED = {"workers", "executor", "nurbs"}  # they start processes, or are switches that take any value
TWICE = "compas_cgc.plot.studio"  # passes its arguments to studio_image
WRONG = {
    "None": None,
    "a word": "text",
    "a number": 3,
    "nothing": [],
    "no numbers": np.full((4, 3), np.nan),
    "another shape": np.zeros((2, 5)),
}


def public() -> dict[str, object]:
    """Return the public classes and functions of all packages, each under one name."""
    packages = ["compas_cgc", *(own.name for own in pkgutil.walk_packages(compas_cgc.__path__, "compas_cgc.") if own.ispkg)]
    found: dict[int, tuple[str, object]] = {}
    for package in packages:
        if package in UNDOCUMENTED or any(part.startswith("_") for part in package.split(".")[1:]):
            continue
        module = importlib.import_module(package)
        for name in getattr(module, "__all__", ()):
            value = getattr(module, name)
            if (inspect.isclass(value) or inspect.isroutine(value)) and str(value.__module__).startswith("compas_cgc"):
                found.setdefault(id(value), (f"{package}.{name}", value))
    return dict(found.values())


PUBLIC = public()


def sections(doc: str) -> dict[str, str]:
    """Return the sections of a numpydoc docstring by their titles."""
    parts = re.split(r"^(\w[\w ]*)\n-{3,}\n", inspect.cleandoc(doc), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def described(text: str) -> set[str]:
    """Return the names that a section describes."""
    heads = [line for line in text.splitlines() if line and not line.startswith(" ")]
    return {name.strip().lstrip("*") for head in heads for name in head.split(":")[0].split(",")}


def parameter_names(value: object) -> list[str]:
    """Return the names of the parameters of a function or a class."""
    if inspect.isclass(value) and issubclass(value, BaseException) and value.__init__ is BaseException.__init__:
        return []
    if dataclasses.is_dataclass(value):
        return [field.name for field in dataclasses.fields(value) if field.init]
    try:
        names = list(inspect.signature(value).parameters)
    except (TypeError, ValueError):
        return []
    return [name for name in names if name not in ("self", "cls", "args", "kwargs", "options")]


def faults(value: object) -> list[str]:
    """Return what a docstring omits, and the parameters it describes that do not exist."""
    found = sections(value.__doc__ or "")
    known = set().union(*(described(found.get(title, "")) for title in ("Parameters", "Other Parameters", "Attributes")))
    missing = [f"the parameter {name}" for name in parameter_names(value) if name not in known]
    if inspect.isroutine(value):
        takes = set(inspect.signature(value).parameters)
        missing += [f"no parameter {name}" for name in sorted(described(found.get("Parameters", "")) - takes)]
    if inspect.isroutine(value) and inspect.signature(value).return_annotation not in ("None", None, inspect.Signature.empty):
        missing += [] if "Returns" in found or "Yields" in found else ["Returns"]
    if not inspect.isclass(value) or not issubclass(value, BaseException):
        missing += [] if ">>> " in found.get("Examples", "") else ["an example"]
    return missing


def swept() -> dict[str, object]:
    top = {f"compas_cgc.{name}": getattr(compas_cgc, name) for name in compas_cgc.__all__ if name != "__version__"}
    inner = {name: value for name, value in PUBLIC.items() if name.split(".")[1] in PACKAGES}
    found = {id(value): (name, value) for name, value in {**inner, **top}.items()}
    return {name: value for name, value in found.values() if not is_made_by_the_package(name, value)}


def is_made_by_the_package(name, value) -> bool:
    """Check whether only COMPAS or the package itself constructs a class."""
    made = issubclass(value, (BaseException, tuple, str, Mesh)) if inspect.isclass(value) else False
    return made or name == TWICE or inspect.isclass(value) and name.split(".")[1] in ("analysis", "fabrication")


SWEPT = swept()


@pytest.fixture(scope="module")
def fitting():
    """Return valid arguments by parameter name."""
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=6.0, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    result = compas_cgc.solve(mesh)
    problem = result.problem
    vertices, faces = problem.vertices, problem.faces
    per_vertex = np.linspace(0.0, 1.0, len(vertices))
    surfaces = dict.fromkeys(("problem", "mesh", "surface", "result", "drawing", "solved", "drawn"), result)
    return {
        **surfaces,
        "vertices": vertices,
        "points": vertices,
        "faces": faces,
        "roles": problem.roles,
        "creases": problem.creases,
        "edges": faces[:, :2],
        "K": per_vertex,
        "curvature": per_vertex,
        "values": per_vertex,
        "targets": per_vertex,
        "normals": vertices,
        "wanted": per_vertex > 0.5,
        "path": "made.obj",
        "study": Study.from_dict({"parameters": {"K": [0.01]}}),
        "folder": "study",
        "method": "newton",
        "shapes": [Shape("roof", vertices, faces, problem.roles, errors=per_vertex)],
        "curves": [Curve("K", np.column_stack([per_vertex, per_vertex]))],
        "history": result.history,
        "figure": history_figure(result.history),
        "report": moulds(result, panels(result, 3.0)),
        "label": np.zeros(len(faces), int),
        "labels": np.zeros(len(faces), int),
    }


SMALL = {"width": 40, "oversampling": 1}  # pixels of pictures
COARSE = {"compas_cgc.fabrication.plane_quads": {"spacing": 3.0}}  # for fewer faces


def parameters_of(value) -> list:
    try:
        found = list(inspect.signature(value).parameters.values())
    except (TypeError, ValueError):
        return []
    return [each for each in found if each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD) and each.name not in SKIPPED]


def calls_of(name, value, fitting) -> typing.Iterator[tuple[str, dict]]:
    """Yield calls with one wrong argument each, under a description."""
    own = parameters_of(value)
    needed = {each.name: fitting.get(each.name) for each in own if each.default is each.empty}
    needed.update({each.name: SMALL[each.name] for each in own if each.name in SMALL}, **COARSE.get(name, {}))
    for each in own:
        for kind, wrong in WRONG.items():
            if wrong is not each.default:
                yield f"{each.name} = {kind}", {**needed, each.name: wrong}
    yield "an unknown name", {**needed, "nonsense": 3}


def refused(value, arguments) -> typing.Optional[BaseException]:
    """Return the error of a call unless its message is a sentence of the package."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value(**arguments)
    except Exception as error:
        return None if is_own_sentence(error) else error
    return None


def test_every_public_name_is_documented():
    assert {name: faults(value) for name, value in PUBLIC.items() if faults(value)} == {}


def part_of(name: str) -> str:
    """Return the package of a public name, without that of the whole."""
    return ".".join(name.split(".")[1:-1][:1])


@pytest.mark.parametrize("part", sorted(set(map(part_of, SWEPT))))
def test_wrong_arguments_get_a_sentence(part, fitting, small_pictures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = {
        f"{name}: {what}": repr(error)
        for name, value in SWEPT.items()
        if part_of(name) == part
        for what, arguments in calls_of(name, value, fitting)
        if (error := refused(value, arguments)) is not None
    }
    assert found == {}


def remembered(function):
    """Return a function that computes equal calls once: many examples begin alike, and none changes a result."""
    kept: dict[bytes, object] = {}

    @functools.wraps(function)
    def call(*arguments, **named):
        # Meshes have identifiers of their own.
        problems = [each.to_problem() if isinstance(each, compas_cgc.CGCMesh) else each for each in arguments]
        try:
            key = pickle.dumps((problems, named))
        except (AttributeError, TypeError, pickle.PicklingError):  # listeners
            return function(*arguments, **named)
        if key not in kept:
            kept[key] = function(*arguments, **named)
        return kept[key]

    return call


@pytest.fixture(scope="module")
def shared_surfaces():
    with pytest.MonkeyPatch.context() as patch:
        for name in ("solve", "fabrication.unroll", "fabrication.curve_net"):
            patch.setattr(f"compas_cgc.{name}", remembered(operator.attrgetter(name)(compas_cgc)))
        yield


@pytest.mark.parametrize("part", ["__init__", *(part.name for part in pkgutil.iter_modules(compas_cgc.__path__))])
def test_examples_in_docstrings_run(part, shared_surfaces, small_pictures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    package = Path(compas_cgc.__file__).parent
    failed = {}
    for path in sorted([*package.glob(f"{part}.py"), *(package / part).rglob("*.py")]):
        if ">>> " in path.read_text(encoding="utf-8"):
            name = ".".join(("compas_cgc", *path.relative_to(package).with_suffix("").parts))
            tried = doctest.testmod(importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE)
            failed.update({name: tried.failed} if tried.failed else {})
    assert failed == {}
