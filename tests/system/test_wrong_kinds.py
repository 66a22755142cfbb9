"""Arguments of a wrong kind, swept through all public names: whoever is refused is refused by a sentence of the package."""

from __future__ import annotations

import inspect
import typing
import warnings

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

from ..docs.test_docstrings import PUBLIC

# Beside the names of the package itself. What serves, starts processes or talks to other programs has its own tests.
PACKAGES = ("analysis", "datastructures", "discrete", "fabrication", "io", "meshing", "plot", "solvers", "study")
LEFT_OUT = {"workers", "executor"}  # arguments that start processes
TWICE = "compas_cgc.plot.studio"  # takes long, and gives its arguments to studio_image, which is swept
WRONG = {
    "None": None,
    "a word": "text",
    "a number": 3,
    "nothing": [],
    "no numbers": np.full((4, 3), np.nan),
    "another shape": np.zeros((2, 5)),
}


def swept() -> dict[str, object]:
    top = {f"compas_cgc.{name}": getattr(compas_cgc, name) for name in compas_cgc.__all__ if name != "__version__"}
    inner = {name: value for name, value in PUBLIC.items() if name.split(".")[1] in PACKAGES}
    found = {id(value): (name, value) for name, value in {**inner, **top}.items()}
    return {name: value for name, value in found.values() if not is_made_by_the_package(name, value)}


def is_made_by_the_package(name, value) -> bool:
    """Tell whether nobody gives the fields by hand: meshes are made by COMPAS, tuples, sentences and findings by the package itself."""
    made = issubclass(value, (BaseException, tuple, str, Mesh)) if inspect.isclass(value) else False
    return made or name == TWICE or inspect.isclass(value) and name.split(".")[1] in ("analysis", "fabrication")


SWEPT = swept()


@pytest.fixture(scope="module")
def fitting():
    """Return arguments that fit, by their names."""
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=6.0, nx=6)
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


SMALL = {"width": 40}  # of pictures, which are drawn for nobody


def parameters_of(value) -> list:
    try:
        found = list(inspect.signature(value).parameters.values())
    except (TypeError, ValueError):
        return []
    return [each for each in found if each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD) and each.name not in LEFT_OUT]


def calls_of(value, fitting) -> typing.Iterator[tuple[str, dict]]:
    """Yield calls with one wrong argument each, and what is wrong."""
    own = parameters_of(value)
    needed = {each.name: fitting.get(each.name) for each in own if each.default is each.empty}
    needed.update({each.name: SMALL[each.name] for each in own if each.name in SMALL})
    for each in own:
        for kind, wrong in WRONG.items():
            yield f"{each.name} = {kind}", {**needed, each.name: wrong}
    yield "an unknown name", {**needed, "nonsense": 3}


def refused(value, arguments) -> typing.Optional[BaseException]:
    """Return the error of a call where it is none of the package's sentences."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value(**arguments)
    except Exception as error:
        return None if is_own_sentence(error) else error
    return None


@pytest.mark.parametrize("name", SWEPT)
def test_what_is_wrong_is_said_in_a_sentence(name, fitting, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    value = SWEPT[name]
    found = {what: refused(value, arguments) for what, arguments in calls_of(value, fitting)}
    assert {what: repr(error) for what, error in found.items() if error is not None} == {}
