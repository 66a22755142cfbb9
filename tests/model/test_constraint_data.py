"""Constraints as plain data: there and back, and what is wrong with them said."""

from __future__ import annotations

import json

import numpy as np
import pytest

from compas_cgc.model.constraint_data import KINDS
from compas_cgc.model.constraint_data import constraint_data
from compas_cgc.model.constraint_data import constraint_of
from compas_cgc.model.constraints import Constraint
from compas_cgc.model.constraints import Fixed
from compas_cgc.model.constraints import Height
from compas_cgc.model.constraints import Mirror
from compas_cgc.model.constraints import OnCurve
from compas_cgc.model.constraints import OnLine
from compas_cgc.model.constraints import OnPlane
from compas_cgc.model.constraints import Proximity
from compas_cgc.model.goals.inequalities import Above
from compas_cgc.model.goals.inequalities import Below
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.inequalities import NearPlane
from compas_cgc.model.goals.inequalities import Within
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.places import Level
from compas_cgc.model.goals.places import OnSurface
from compas_cgc.model.goals.wholes import Area
from compas_cgc.model.goals.wholes import Length
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Unknown
from compas_cgc.model.goals.wholes import Volume

EACH = [
    OnPlane([1, 2], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
    Height(np.array([3, 4]), 1.25),
    OnLine([5], [0.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
    OnCurve([6, 7], np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.5]]), closed=False),
    Fixed([8]),
    Proximity([9, 10], weight=100.0),
    Mirror([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    Height("crown", 4.0),
    Rise(4.0),
    Volume(300.0),
    Volume(300.0, level=0.5),
    Area(250.0),
    Length([1, 2, 3], 4.5),
    EdgeInPlan(),
    EdgeInPlan([1, 2], [[0.0, 0.0], [1.0, 0.0]], closed=True),
    Level([1, 2]),
    OnSurface([1], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]]),
    Above(2.5),
    Below(2.5, [1, 2]),
    Clearance([0.0, 0.0, 4.0, 3.0], 2.5),
    Clearance(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), 2.5),
    Clearance(3, 2.5),
    Within([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]),
    NearPlane([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.4),
    Unknown([0, 2]),
    Unknown("all"),
]


def leaves(kind):
    return [leaf for sub in kind.__subclasses__() for leaf in leaves(sub)] or [kind]


def test_every_kind_has_a_name():
    assert {type(constraint) for constraint in EACH} == set(KINDS.values()) == set(leaves(Constraint))


@pytest.mark.parametrize("constraint", EACH, ids=lambda constraint: type(constraint).__name__)
def test_there_and_back(constraint):
    data = constraint_data(constraint)
    again = constraint_of(json.loads(json.dumps(data)))
    assert type(again) is type(constraint) and constraint_data(again) == data


@pytest.mark.parametrize(
    "data, part",
    [
        (3, "an object with a 'kind'"),
        ({"kind": "magnet"}, "plane, height, line"),
        ({"kind": ["plane"]}, "an object with a 'kind'"),
        ({"kind": "held"}, "needs vertices; its fields are vertices"),
        ({"kind": "held", "vertices": [0.5]}, "list of vertices"),
        ({"kind": "held", "vertices": [1], "height": 3}, "has no field 'height'"),
        ({"kind": "height", "vertices": [1], "height": float("nan")}, "finite number"),
        ({"kind": "height", "vertices": [1], "height": True}, "finite number"),
        ({"kind": "plane", "vertices": [1], "point": [0, 0], "normal": [0, 0, 1]}, "three numbers"),
        ({"kind": "plane", "vertices": [1], "point": [0, 0, 0], "normal": [0, 0, 0]}, "not all zero"),
        ({"kind": "curve", "vertices": [1], "points": [[0, 0, 0]]}, "two or more different points"),
        ({"kind": "curve", "vertices": [1], "points": 3}, "points of a constraint"),
        ({"kind": "curve", "vertices": [1], "points": [[0, 0, 0], [1, 0, 0]], "closed": 1}, "true or false"),
        ({"kind": "near", "vertices": [1], "weight": 0.0}, "weight"),
        ({"kind": "clearance", "where": [1, 1, 2], "height": 2}, "must be a region number, a box"),
    ],
)
def test_what_is_wrong_is_said(data, part):
    with pytest.raises(ValueError, match=part):
        constraint_of(data)
