"""Goals and unknown K from the canvas, by Hops: the same surface as by a call, and sentences that name the input."""

from __future__ import annotations

import json

import numpy as np
import pytest
import rhino3dm

from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.problem import CGCProblem
from compas_cgc.server.hops.endpoints import endpoint
from compas_cgc.server.hops.functions import run_function
from compas_cgc.server.limits import Limits
from compas_cgc.solvers.run import solve

from ...support.hops_client import write
from ...support.shapes import grid

CORNERS = [(0, 0, 0), (9, 0, 0), (0, 9, 0), (9, 9, 0)]
GATE = [(3, 0, 0), (6, 0, 0), (6, 2, 0), (3, 2, 0), (3, 0, 0)]


def curve(points):
    return rhino3dm.PolylineCurve([rhino3dm.Point3d(*map(float, p)) for p in points])


def asked(**inputs):
    """Return the reply to a request as Hops sends it, with texts as they are typed."""
    given = {"Mesh": mesh_from_arrays(*grid(8, 9.0)), "Supports": CORNERS, "K": [0.01], **inputs}
    values = []
    for own in endpoint("cgc/goals").inputs:
        items = given.get(own.name, [])
        items = items if isinstance(items, list) else [items]
        kind = own.kind
        data = [{"data": item} if kind == "Text" else write(item, kind, 8) for item in items]
        values.append({"ParamName": own.name, "InnerTree": {"{0}": data} if data else {}})
    return run_function("cgc/goals", values, {"modelunits": "Meters", "absolutetolerance": 1e-3}, Limits())


def shape(reply):
    (mesh,) = next(value for value in reply.values if value["ParamName"] == "Mesh")["InnerTree"]["{0}"]
    read = rhino3dm.CommonObject.Decode(json.loads(mesh["data"]))
    return np.array([(p.X, p.Y, p.Z) for p in read.Vertices.ToPoint3dArray()])


@pytest.mark.parametrize("goals", [["rise = 2.5"], ["Rise: 2.5"], ['{"kind": "rise", "rise": 2.5}']])
def test_a_rise_and_the_k_for_it(goals):
    reply = asked(Goals=goals, Unknown=[-1])
    assert reply.status == 200, reply.errors
    problem = CGCProblem(*grid(8, 9.0), targets=0.01).with_supports("corners")
    expected = solve(problem, goals=[Rise(2.5)], unknown="all")
    assert np.array_equal(shape(reply), expected.vertices), "the same bits as by a call"
    assert any("was found for region 0" in json.dumps(value) for value in reply.values)


def test_a_gate_under_a_curve_and_edges_in_plan():
    reply = asked(Goals=["clearance = 1.2", "plan"], Over=[curve(GATE), curve([(0, 0, 0), (0, 9, 0)])])
    assert reply.status == 200, reply.errors
    problem = CGCProblem(*grid(8, 9.0), targets=0.01).with_supports("corners")
    edge = np.flatnonzero(problem.vertices[:, 0] == 0).tolist()
    goals = [Clearance([p[:2] for p in GATE[:-1]], 1.2), EdgeInPlan(edge, [(0, 0), (0, 9)])]
    assert np.array_equal(shape(reply), solve(problem, goals=goals).vertices)
    x, y, z = shape(reply).T
    assert z[(x >= 3) & (x <= 6) & (y <= 2)].min() >= 1.2 - 1e-9
    assert np.abs(shape(asked(Goals=["plan"]))[edge, 0]).max() < 1e-12, "without a curve all free edges are meant"


@pytest.mark.parametrize(
    "inputs, words",
    [
        ({"Goals": ["ries = 3"]}, "input 'Goals' has 'ries = 3', which is not a goal"),
        ({"Goals": ["rise = tall"]}, "goal 0 of input 'Goals' has the user text rise = 'tall'; it must be a number"),
        ({"Goals": ['{"kind": "rise"']}, "which is not valid JSON"),
        ({"Goals": ['{"kind": "rise", "ris": 3}']}, "has no field 'ris'"),
        ({"Goals": ["clearance = 2"]}, "input 'Over' has no curve, but 1 goals need one"),
        ({"Goals": ["clearance = 2"], "Over": [curve(GATE[:3])]}, "is an open curve, but clearance requires a closed curve"),
        ({"Goals": ["rise = 4000"]}, "the rise 4000 is far larger than the mesh"),
        ({"Goals": ["rise = 2", "height = 3"]}, "the rise 2 and the height 3 of the crown contradict each other"),
        ({"Unknown": [4]}, "the goal Unknown names region 4, but the mesh has 1"),
        ({"Unknown": [-2]}, "input 'Unknown' must be between -1 and"),
    ],
)
def test_wrong_goals_are_sentences(inputs, words):
    reply = asked(**inputs)
    assert reply.status == 422 and len(reply.errors) == 1 and words in reply.errors[0]
