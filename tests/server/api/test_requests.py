"""A request: checked, stored, and turned into one problem; results as bytes and back."""

from __future__ import annotations

import json
from typing import NamedTuple

import compas
import numpy as np
import pytest

from compas_cgc import AutoSettings
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc import solve
from compas_cgc.execution.worker import connected
from compas_cgc.io import write
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.problem import Drawing
from compas_cgc.server import Limits
from compas_cgc.server.api.decoding import packed
from compas_cgc.server.api.options import check_options
from compas_cgc.server.api.requests import READERS
from compas_cgc.server.api.requests import accept
from compas_cgc.server.api.serialization import pack_problem
from compas_cgc.server.api.serialization import pack_result
from compas_cgc.server.api.serialization import unpack_problem
from compas_cgc.server.api.serialization import unpack_result
from compas_cgc.server.api.submissions import json_submission
from compas_cgc.server.api.tasks import run_request
from compas_cgc.server.api.tasks import solve_job
from compas_cgc.server.errors import Unprocessable
from compas_cgc.server.hops.inputs import read_hops_request

from ...support.shapes import grid

LIMITS = Limits()


def asked(n=6, **more):
    vertices, faces = grid(n, 6.0)
    return {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.01, **more}


def read(value):
    return READERS["json"]({}, accept(value, LIMITS), LIMITS)


def hops_request(**inputs):
    data = {"Mesh": [mesh_from_arrays(*grid(6, 6.0)).Encode()], "K": [0.01], **inputs}
    values = [{"ParamName": name, "InnerTree": {"{0}": [{"data": item} for item in items]}} for name, items in data.items()]
    context = {"modelunits": "Meters", "absolutetolerance": 0.001}
    return read_hops_request({}, json.dumps({"values": values, "context": context}).encode(), LIMITS)


def roof():
    mesh = CGCMesh.from_meshgrid(dx=6, nx=6)
    mesh.set_supports("corners")
    mesh.set_creases([[7 * i + 3 for i in range(7)]])
    mesh.set_target(0.01)
    mesh.set_target(0.02, region=1)
    mesh.set_goals([Height([3], 0.5)])
    return mesh


def same(one, other):
    for name in ("vertices", "faces", "roles", "targets", "s", "e", "creases"):
        assert np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True), name
    assert one.goals == other.goals and one.drawing == other.drawing
    assert all(np.array_equal(a, b) for a, b in zip(one.names, other.names))


@pytest.mark.parametrize("given", [{"delay": 5}, {"e": 5}, {"e": 5.0}])
def test_a_delay_alone_lets_creases_follow_all_the_way(given):
    settings = read(asked(settings=given)).settings
    assert settings == FlowSettings(s=1.0, e=5)


def test_a_delay_in_hops_lets_creases_follow_all_the_way_too():
    assert hops_request(S=[0.8], Delay=[5], Tolerance=[0.0]).settings == FlowSettings(s=1.0, e=5)
    assert hops_request(S=[0.5], Delay=[5]).settings == FlowSettings(s=0.5, e=5)
    # What Hops sends for inputs that nobody touched.
    assert hops_request(S=[0.8], Delay=[0], Tolerance=[0.0]).settings is None
    assert hops_request(Tolerance=[0.01]).settings == AutoSettings(tolerance=0.01)


def test_steps_and_tolerance_need_no_method():
    assert read(asked(settings={"steps": 7.0, "tolerance": 0.1})).settings == AutoSettings(steps=7, tolerance=0.1)
    with pytest.raises(Unprocessable, match="at most 100000 steps"):
        accept(asked(settings={"steps": 100_001}), LIMITS)


@pytest.mark.parametrize(
    "settings, part", [({"steps": 1.5}, "steps must be a whole number"), ({"s": [1]}, "the setting s must be"), (5, "object")]
)
def test_settings_that_are_none_are_refused_before_the_job_is_queued(settings, part):
    with pytest.raises(Unprocessable, match=part):
        accept(asked(settings=settings), LIMITS)


def test_a_request_is_the_problem_that_the_mesh_methods_make():
    vertices, faces = grid(6, 6.0)
    crease = [7 * i + 3 for i in range(7)]
    got = read(asked(supports=[0, 6, 42, 48], creases=[crease], targets={"0": 0.01, "1": 0.02}, name="roof", flip=True)).problem
    expected = CGCProblem(vertices, faces, drawing=Drawing("roof")).flipped().with_creases([crease]).with_supports([0, 6, 42, 48])
    same(got, expected.with_targets({0: 0.01, 1: 0.02}))
    roles = ["fixed" if role == 1 else "internal" for role in got.roles.tolist()]
    same(read(asked(supports=None, roles=roles, creases=[crease], targets={"0": 0.01, "1": 0.02}, name="roof", flip=True)).problem, got)


def test_constraints_of_a_mesh_of_a_file_and_of_the_request_all_hold(tmp_path):
    mesh = roof()
    more = [{"kind": "height", "vertices": [24], "height": 0.7}]
    request = {"mesh": json.loads(compas.json_dumps(mesh)), "goals": more}
    assert read(request).problem.goals == (Height([3], 0.5), Height([24], 0.7))
    write(tmp_path / "roof.3dm", mesh)
    from_file = READERS["3dm"]({"goals": more}, (tmp_path / "roof.3dm").read_bytes(), LIMITS)
    assert [(len(own.vertices), own.height) for own in from_file.problem.goals] == [(1, 0.5), (1, 0.7)]
    output = solve_job("json", {}, accept(request, LIMITS), LIMITS)
    heights = unpack_result(output.content)[0].vertices[[3, 24], 2]
    assert np.allclose(heights, [0.5, 0.7], atol=1e-9), output.message
    with pytest.raises(Unprocessable, match="only the method projection or bending supports constraints"):
        accept({**request, "settings": {"s": 0.5}}, LIMITS)


def test_goals_and_unknown_k_of_a_request():
    vertices, faces = grid(8, 8.0)
    goals = [{"kind": "rise", "rise": 1.5}, {"kind": "clearance", "where": [3, 0, 5, 2], "height": 0.8}]
    drawn = {"vertices": vertices.tolist(), "faces": faces.tolist()}
    request = {**drawn, "supports": "corners", "goals": goals, "unknown": [0]}
    assert read(request).problem.goals == (Rise(1.5), Clearance([3.0, 0.0, 5.0, 2.0], 0.8), Unknown([0]))
    result = unpack_result(solve_job("json", {}, accept(request, LIMITS), LIMITS).content)[0]
    assert result.converged and result.vertices[:, 2].max() == pytest.approx(1.5, abs=1e-10)
    K = result.problem.region_targets()[0]
    assert K is not None and f"K = {K:.6g} was found for region 0" in result.message
    held = {**request, "supports": "boundary", "goals": goals[:1], "unknown": "all", "method": "newton"}
    assert unpack_result(solve_job("json", {}, accept(held, LIMITS), LIMITS).content)[0].method == "newton"
    for more, part in (
        ({"unknown": [-1]}, "'unknown' refers to region -1"),
        ({"unknown": "roof"}, "'unknown' must be a list of the regions"),
        ({"goals": {"kind": "rise", "rise": 2}}, "'goals' must be a list of objects"),
        ({"goals": [{"kind": "rise", "rise": "4 m"}]}, "rise of a constraint of kind rise must be a finite number"),
        ({"goals": [{"kind": "above", "vertices": [99], "height": 2}]}, "names vertex 99"),
        ({"method": "flow"}, "only the method projection or bending supports constraints"),
    ):
        with pytest.raises(Unprocessable, match=part):
            accept({**request, **more}, LIMITS)


def test_a_job_gives_the_bits_of_a_solve_here():
    for more in ({}, {"method": "flow", "settings": {"delay": 2}}):
        output = solve_job("json", {}, accept(asked(**more), LIMITS), LIMITS)
        mesh = CGCMesh.from_vertices_and_faces(*grid(6, 6.0))
        mesh.set_supports("boundary")
        mesh.set_target(0.01)
        assert np.array_equal(unpack_result(output.content)[0].vertices, solve(mesh, **more).vertices)


def test_a_request_of_another_version_is_told_of():
    assert "submit the job again" in solve_job("arrays", {}, b"", LIMITS).message


def test_problems_and_results_come_back_from_bytes():
    problem = roof().to_problem()
    same(unpack_problem(pack_problem(problem)), problem)
    result = solve(problem, settings={"steps": 50, "tolerance": 1e-3})
    again, report = unpack_result(pack_result(result, {"notes": ["a"]}))
    same(again.problem, result.problem)
    assert report == {"notes": ["a"]} and again.to_dict() == result.to_dict() and again.settings == result.settings


def test_a_surface_is_shown_while_it_is_judged():
    """A live job tells its surface, to the last bit, before it gives its verdict; another sends it once, as the result."""
    for live in (True, False):
        told = Told([])
        with connected(told):
            output = solve_job("json", {}, accept(asked(live=live), LIMITS), LIMITS)
        arrived = [news["arrived"] for news in told.news if "arrived" in news]
        result = unpack_result(output.content)[0]
        assert arrived == ([result.vertices.tobytes()] if live else [])
        judged = [news["judged"] for news in told.news if "judged" in news]
        assert [said["message"] for said in judged] == ([result.message] if live else [])


class Told(NamedTuple):
    """The channel of a task that nobody stops."""

    news: list

    def report(self, progress):
        self.news.append(progress)

    def stop_wanted(self):
        return False


def test_laws_reach_the_problem_and_the_stored_result():
    for laws in ("H = 0.1", {"0": "H = 0.1"}):
        problem = read(asked(laws=laws)).problem
        assert str(problem.laws[0]) == "H = 0.1"
    assert unpack_problem(pack_problem(problem)).laws == problem.laws
    result = solve(problem)
    assert unpack_result(pack_result(result, {}))[0].problem.laws == problem.laws
    for wrong, part in (("H of 2", "is not a law"), ({"x": "minimal"}, "region numbers as keys"), (3, "must be a text")):
        with pytest.raises(Unprocessable, match=part):
            accept(asked(laws=wrong), LIMITS)


@pytest.mark.parametrize("wrong", ["x", True, [], 1e13, -1e13, 10**20])
def test_a_target_that_is_none_is_named_wherever_it_stands(wrong):
    for place in (0, 20, 48):
        targets = [0.01, None, 1] * 16 + [0.01]
        accept(asked(targets=targets), LIMITS)
        targets[place] = wrong
        with pytest.raises(Unprocessable, match=f"the target of vertex {place} must be a"):
            accept(asked(targets=targets), LIMITS)


@pytest.mark.parametrize(
    "wrong, part",
    [
        (
            {"faces": [[1, 2, 9], [2, 10, 9], [9, 10, 49]]},
            "a face refers to vertex 49, but there are 49 vertices, counted from 0; these faces count from 1, so subtract 1",
        ),
        ({"faces": [[0, 1, 8], [1, 9, 49]]}, "a face refers to vertex 49, but there are 49 vertices, counted from 0$"),
        ({"supports": [[0.0, 0.0, 0.0]]}, "counted from 0, not coordinates such as .0.0, 0.0, 0.0.$"),
        ({"supports": [999]}, "'supports' refers to vertex 999, which does not exist; there are 49 vertices, counted from 0"),
    ],
)
def test_vertices_that_are_counted_otherwise_are_told_how(wrong, part):
    with pytest.raises(Unprocessable, match=part):
        accept(asked(**wrong), LIMITS)


def test_supports_that_do_not_exist_are_all_named():
    with pytest.raises(Unprocessable, match="'supports' refers to vertices 77, -1, which do not exist"):
        check_options({"supports": [0, 77, -1]}, 10, Limits())


def corner_roof(K, creases=(), last=None):
    """A request for a roof on its corners, on from a result for another K where there is one."""
    vertices, faces = grid(10, 6.0)
    before = {} if last is None else {"last": {"vertices": packed(last.vertices), "targets": last.problem.targets.tolist()}}
    return {"vertices": packed(vertices), "faces": packed(faces), "supports": "corners", "creases": list(creases), "targets": K, **before}


def solved(value):
    plain = json.loads(json.dumps(value).replace("NaN", "null"))
    return run_request(read(plain))


@pytest.mark.parametrize(
    ("creases", "targets"), [((), (0.021, 0.018, -0.01, -0.011)), ((list(range(55, 66)),), (0.021, 0.018, 0.024))], ids=["plain", "creased"]
)
def test_a_request_with_the_last_surface_comes_to_what_the_drawing_alone_does(creases, targets):
    """K up, K down, and K below 0, to which no way leads from a dome."""
    here = solved(corner_roof(0.02, creases))
    for K in targets:
        there, cold = solved(corner_roof(K, creases, here)), solved(corner_roof(K, creases))
        assert ("starting from the previous surface" in there.message) == (K * here.problem.targets[14] > 0)
        assert there.converged and np.abs(there.vertices - cold.vertices).max() < 1e-6 * 6.0
        assert np.array_equal(there.start, cold.start)
        here = there


def test_the_last_surface_leaves_other_ways_to_solve_as_they_are():
    """The same targets, a rim that is held all round, and methods that take the vertices for the drawing."""
    here = solved(corner_roof(0.02))
    for more in ({}, {"targets": 0.021, "supports": "boundary"}, {"targets": 0.0205, "method": "flow", "supports": "boundary"}):
        there, cold = solved({**corner_roof(0.02, last=here), **more}), solved({**corner_roof(0.02), **more})
        assert np.array_equal(there.vertices, cold.vertices) and there.message == cold.message


@pytest.mark.parametrize(
    ("last", "part"),
    [
        (7, "must be an object with the 'vertices'"),
        ({"vertices": [[0, 0, 0]]}, "must be an object with the 'vertices'"),
        ({"vertices": [[0, 0, 0]] * 3, "targets": 0.01}, "the surface has 3 vertices, but the mesh has 49"),
        ({"vertices": [[0, 0]] * 49, "targets": 0.01}, "three numbers each"),
        ({"vertices": {"base64": "AAAA", "type": "f8", "shape": [49, 3]}, "targets": 0.01}, "do not match its shape"),
        ({"vertices": [[0, 0, 0]] * 49, "targets": [0.01]}, "1 numbers for 49 vertices"),
        ({"vertices": [[0, 0, 0]] * 49, "targets": None}, "is null"),
    ],
)
def test_a_last_surface_that_is_none_is_refused_by_a_sentence(last, part):
    with pytest.raises(Unprocessable, match="last") as refused:
        accept(asked(last=last), LIMITS)
    assert part in str(refused.value)


def test_a_last_surface_goes_with_a_solve_of_arrays_alone():
    last = {"vertices": grid(6, 6.0)[0].tolist(), "targets": 0.01}
    mesh = json.loads(compas.json_dumps(roof()))
    with pytest.raises(Unprocessable, match="requires 'vertices' and 'faces'"):
        accept({"mesh": mesh, "last": last}, LIMITS)
    with pytest.raises(Unprocessable, match="'last' is an option of a solve, but the task is unroll"):
        json_submission(json.dumps({"task": "unroll", **asked(last=last)}).encode(), LIMITS)


def test_a_last_surface_that_leads_nowhere_is_as_good_as_none():
    value = corner_roof(0.021)
    crumpled = {"vertices": packed(np.zeros((121, 3))), "targets": 0.02}
    there = solved({**value, "last": crumpled})
    assert there.converged and np.abs(there.vertices - solved(value).vertices).max() < 1e-9 * 6.0
