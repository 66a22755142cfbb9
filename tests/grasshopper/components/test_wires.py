"""Wrong wires: one sentence that names the input, what it gets and what to connect."""

from __future__ import annotations

import re
import types

import pytest

from compas_cgc import CGCMesh
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc.grasshopper.runtime.wires import LISTS
from compas_cgc.grasshopper.runtime.wires import WIRES

from ...support.gh_stand_ins import BUNDLES
from ...support.gh_stand_ins import Point3d
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.gh_stand_ins import square


def dome():
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    return mesh


MESH, TEXT, NUMBER = square(2), "K=0.03", 7.5
pytestmark = pytest.mark.usefixtures("rhino")

SURFACES = ("Solve", "Analyse", "Regions", "Target", "Constraints", "Write3dm")
WRONG = [
    *((name, "cgc_mesh", wrong) for name in SURFACES for wrong in (MESH, TEXT, NUMBER)),
    ("Solve", "settings", TEXT),
    ("Solve", "settings", NUMBER),
    ("Solve", "goals", TEXT),
    ("Solve", "goals", [NUMBER]),
    ("Solve", "server", NUMBER),
    ("Solve", "run", TEXT),
    ("History", "result", dome()),
    ("History", "result", TEXT),
    ("Mesh", "mesh", dome()),
    ("Mesh", "mesh", TEXT),
    ("Mesh", "supports", [TEXT]),
    ("Mesh", "creases", [NUMBER]),
    ("Mesh", "fix", NUMBER),
    ("Target", "K", [TEXT]),
    ("Target", "region", [0.5]),
    ("Target", "point", [MESH]),
    ("Constraints", "plane", NUMBER),
    ("Constraints", "others", [TEXT]),
    ("Constraints", "height", TEXT),
    ("Analyse", "show", NUMBER),
    ("Solve", "show", NUMBER),
    ("Bake", "cgc_mesh", MESH),
    ("Bake", "layer", NUMBER),
    ("Bake", "bake", TEXT),
    ("Goals", "within", TEXT),
    ("Goals", "clear", [MESH]),
    ("Goals", "unknown", [TEXT]),
    ("Mould", "size", TEXT),
    ("Mould", "count", MESH),
    ("Mould", "material", NUMBER),
    ("Net", "through", [TEXT]),
    ("Unroll", "whole", TEXT),
    ("Settings", "measure", NUMBER),
    ("Settings", "steps", float("nan")),
    ("Target", "region", [float("inf")]),
    ("Target", "point", [Point3d(float("nan"), 0.0, 0.0)]),
    ("Constraints", "plane", types.SimpleNamespace(Origin=Point3d(0.0, 0.0, 0.0))),
]


def test_there_are_thirty_of_them():
    assert len(WRONG) >= 30


@pytest.mark.parametrize(("name", "wire", "wrong"), WRONG, ids=lambda value: value if isinstance(value, str) else type(value).__name__)
def test_a_wrong_wire_is_one_sentence(name, wire, wrong):
    placed = place(name)
    inputs = {"cgc_mesh": dome()} if "cgc_mesh" in {one.name for one in placed.bundle.inputs} else {}
    out = placed.settle(**{**inputs, wire: wrong})
    (sentence,) = placed.said("Error")
    assert re.match(rf"the input {wire} received .+; connect .+", sentence)
    assert all(value is None for value in out.values())


def test_every_input_says_what_it_takes():
    assert {own.name for bundle in BUNDLES.values() for own in bundle.inputs} <= set(WIRES)


def test_inputs_of_one_value_take_it_out_of_a_list_and_tell_of_several():
    assert LISTS == {own.name for bundle in BUNDLES.values() for own in bundle.inputs if own.access == "list"}
    placed = place("Regions")
    alone, listed = (placed.settle(cgc_mesh=given) for given in (dome(), [None, dome()]))
    assert not placed.said("Error") and [value is None for value in listed.values()] == [value is None for value in alone.values()]
    for name in ("Analyse", "Constraints", "Mould", "Regions", "Solve"):
        placed = place(name)
        placed.settle(cgc_mesh=[dome(), dome()])
        assert placed.said("Error") == ["the input cgc_mesh received 2 values; connect one value, or set the input to item access"]
        placed.settle(cgc_mesh=[None])
        assert not placed.said("Error") and len(placed.said("Warning")) == 1


# What Grasshopper's own conversion may let through, by the hint of the input.
FITTING = {"str": str, "float": (int, float), "int": int, "bool": int}


@pytest.mark.parametrize("name", sorted(set(BUNDLES) - {"CGC_Server"}))
def test_no_wrong_wire_raises(name):
    for own in BUNDLES[name].inputs:
        for wrong in (TEXT, NUMBER, MESH, dome(), object(), [object()]):
            if isinstance(wrong, FITTING.get(own.hint, ())):
                continue
            given = {"cgc_mesh": dome()} if "cgc_mesh" in {one.name for one in BUNDLES[name].inputs} else {}
            placed = place(name[4:])
            # Faults of the program come through; sentences do not.
            placed.run(**{**given, own.name: wrong})


def test_what_is_wrapped_or_has_gaps_goes_through():
    placed = place("Target")
    wrapped = types.new_class("GH_Number")()
    wrapped.Value = 0.02
    out = placed.run(cgc_mesh=dome(), K=[wrapped])
    assert out["cgc_mesh"] is not None and not placed.said("Error")
    placed = place("Solve")
    out = placed.run(cgc_mesh=dome(), settings=FlowSettings(), goals=[None, Height([12], 1.0)], run=False)
    assert not placed.said("Error")
