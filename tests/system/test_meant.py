"""Natural calls that are none get one sentence with what to write instead; what Python asks for by itself goes on as ever."""

from __future__ import annotations

import copy
import pickle

import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve


@pytest.fixture(scope="module")
def result():
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return solve(mesh)


@pytest.mark.parametrize(
    "named, said",
    [
        ({"tolerance": 1e-3}, "settings={'tolerance': ...}"),
        ({"target": 0.01}, "mesh.set_target(0.005)"),
        ({"supports": "boundary"}, 'mesh.set_supports("boundary")'),
        ({"rise": 4}, "goals=[compas_cgc.Rise(...)]"),
        ({"methods": "flow"}, "did you mean 'method'?"),
    ],
)
def test_arguments_of_solve(result, named, said):
    with pytest.raises(TypeError) as told:
        solve(result.mesh, **named)
    assert said in str(told.value) and "\n" not in str(told.value)


def test_a_method_needs_its_name(result):
    with pytest.raises(TypeError, match="pass the others by name, such as method="):
        solve(result.mesh, "flow")


def test_attributes_of_a_result_and_a_mesh(result):
    for value, name, said in (
        (result, "to_3dm", "result.mesh.to_3dm"),
        (result, "verdicts", "did you mean 'verdict'?"),
        (result.mesh, "solve", "compas_cgc.solve(mesh)"),
        (result.mesh, "save", "compas_cgc.write("),
        (result.mesh, "set_targets", "did you mean 'set_target'?"),
    ):
        with pytest.raises(AttributeError) as told:
            getattr(value, name)
        assert said in str(told.value)


def test_copies_and_what_goes_wrong_inside(result):
    assert pickle.loads(pickle.dumps(result)).status == result.status and not hasattr(copy.deepcopy(result.mesh), "oops")

    class Broken(CGCMesh):
        @property
        def wrong(self):
            return self.inner.oops

        @property
        def inner(self):
            return 3

    with pytest.raises(AttributeError, match="'int' object has no attribute 'oops'"):
        Broken().wrong  # noqa: B018


def test_what_is_said_is_true(result, tmp_path):
    """What the sentences tell to write works."""
    assert solve(result.mesh, settings={"tolerance": 1e-3}).converged
    result.mesh.to_3dm(tmp_path / "roof.3dm")
    assert (tmp_path / "roof.3dm").stat().st_size
