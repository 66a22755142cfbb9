"""Wires carry arrays: components do not copy COMPAS meshes, and scripts on the canvas still get one."""

from __future__ import annotations

import copy
import pickle
import time

import compas
import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.grasshopper.runtime.fingerprint import problem_fingerprint
from compas_cgc.grasshopper.runtime.wire_mesh import WireMesh

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401

pytestmark = pytest.mark.usefixtures("rhino")


def wire(n):
    """A square of two regions with (n + 1)² vertices."""
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=n)
    mesh.set_supports("boundary")
    mesh.set_creases([[(n + 1) * i + n // 2 for i in range(n + 1)]])
    mesh.set_target(0.01)
    return WireMesh(mesh.to_problem())


@pytest.fixture(scope="module")
def large():
    """A problem of 40,000 vertices."""
    return wire(200).problem


def milliseconds(work, repeats=5):
    """Return the shortest of several times of computation, which does not count the time of other processes."""
    durations = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        durations.append(time.process_time() - start)
    return 1000.0 * min(durations)


@pytest.mark.parametrize("inputs", [{"K": [0.02]}, {"K": [0.02], "region": [1]}, {"K": [0.02, 0.03]}], ids=["all", "one", "each"])
@pytest.mark.nightly
def test_target_blocks_the_interface_for_at_most_5_ms(inputs):
    given, placed = wire(100), place("Target")
    assert milliseconds(lambda: placed.run(cgc_mesh=given, **inputs)) <= 5.0
    assert "mesh" not in given.__dict__, "no COMPAS mesh is made"


@pytest.mark.parametrize(
    ("name", "inputs"),
    [("Target", {"K": [0.02], "region": [0]}), ("Solve", {"run": False}), ("Constraints", {"height": 1.0, "points": [(5.0, 5.0, 0.0)]})],
)
def test_other_components_block_it_for_at_most_100_ms(large, name, inputs):
    placed = place(name)
    assert milliseconds(lambda: placed.run(cgc_mesh=WireMesh(large), **inputs), 3) <= 100.0


def test_a_script_on_the_canvas_uses_the_wire_as_a_mesh():
    given = wire(4)
    assert given.number_of_vertices() == 25 and len(given.regions()) == 2 and given.region_target(1) == 0.01
    assert compas.json_loads(compas.json_dumps(given)).vertices_role() == given.mesh.vertices_role()
    given.set_target(0.03, region=1)
    assert given.to_problem().region_targets() == [0.01, 0.03]
    out = place("Target").run(cgc_mesh=given, K=[0.05], region=[0])["cgc_mesh"]
    assert out.to_problem().region_targets() == [0.05, 0.03] and given.to_problem().region_targets() == [0.01, 0.03]


@pytest.mark.parametrize("make", [lambda own: own.mesh, lambda own: own.problem], ids=["mesh", "problem"])
def test_scripts_may_put_out_meshes_and_problems(make):
    placed = place("Target")
    out = placed.run(cgc_mesh=make(wire(4)), K=[0.05])["cgc_mesh"]
    assert out.to_problem().region_targets() == [0.05, 0.05] and not placed.said("Error")


def test_wires_are_copied_and_pickled():
    given = wire(4)
    for twin in (copy.deepcopy(given), pickle.loads(pickle.dumps(given))):
        assert twin is not given and problem_fingerprint(twin) == problem_fingerprint(given)


def test_fingerprints_of_different_problems_differ():
    own = wire(4).problem
    others = [
        own.with_targets(0.02, region=1),
        own.with_supports([0]),
        own.with_creases([]),
        own.with_goals([{"kind": "rise", "rise": 1.0}]),
        own.with_vertices(own.vertices + [0.0, 0.0, 1e-12]),
    ]
    texts = [problem_fingerprint(each) for each in (own, *others)]
    assert len(set(texts)) == 6 and problem_fingerprint(own.with_targets(np.array(own.targets))) == texts[0]


@pytest.mark.parametrize("seed", range(200))
def test_nulls_keep_their_place(seed):
    rng = np.random.default_rng(seed)
    given, placed = wire(4), place("Target")
    size = int(rng.integers(1, 5))
    regions = [None if rng.random() < 0.3 else int(rng.integers(2)) for _ in range(size)]
    values = [None if rng.random() < 0.3 else float(rng.integers(1, 9)) / 100 for _ in range(size)]
    out = placed.run(cgc_mesh=given, K=values, region=regions)["cgc_mesh"]
    if not any(values):
        assert placed.said("Error") == ["connect at least one curvature K, in 1 / (model unit)², or one law such as H = 0.1"]
        return
    expected, conflict = [0.01, 0.01], False
    for place_of in range(2):
        own = [value for region, value in zip(regions, values) if region == place_of and value is not None]
        expected[place_of] = own[-1] if own else 0.01
        conflict = conflict or len(set(own)) > 1
    assert out.to_problem().region_targets() == expected and bool(placed.said("Warning")) == conflict
