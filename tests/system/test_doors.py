"""Every door gives the same surface, bit for bit: Python, arrays, command line, files, HTTP, Hops, RPC, Grasshopper."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest
import rhino3dm

from compas_cgc import AutoSettings
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Height
from compas_cgc import read
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.cli import main
from compas_cgc.cli.exits import DONE
from compas_cgc.cli.exits import ROUGH
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.io.rhino.rhinocommon import mesh_to_arrays
from compas_cgc.model.constraint_data import constraint_data
from compas_cgc.model.result import Solution
from compas_cgc.model.roles import FIXED
from compas_cgc.solvers import METHODS
from compas_cgc.solvers import Method
from compas_cgc.solvers import register

from ..grasshopper.components.test_solve import until_done
from ..support.gh_stand_ins import place
from ..support.gh_stand_ins import rhino  # noqa: F401
from ..support.hops_client import Hops
from ..support.rhino_models import result_of

pytestmark = pytest.mark.usefixtures("rhino")

N = 8  # squares along each side of a plan of 8 m x 8 m


class Brief(NamedTuple):
    """What a designer asks for, in words that every door has."""

    supports: str
    creases: list
    K: float
    goals: list
    method: str
    settings: dict


def line(i: int) -> list:
    return [i * (N + 1) + j for j in range(N + 1)]


BRIEFS = {
    "a roof on four corners at a height": Brief("corners", [], 0.01, [Height([line(4)[4]], 1.25)], "auto", {}),
    "creases that wait, to a tolerance": Brief("boundary", [line(3), line(5)], 0.01, [], "flow", {"delay": 5, "tolerance": 1e-8}),
    "creases that follow": Brief("boundary", [line(3), line(5)], 0.02, [], "auto", {"s": 0.5}),
    "whatever is picked, to a tolerance": Brief("boundary", [], 0.01, [], "auto", {"tolerance": 1e-7}),
}


def plan() -> CGCMesh:
    return CGCMesh.from_meshgrid(dx=float(N), nx=N)


def posed(brief: Brief) -> CGCMesh:
    mesh = plan()
    mesh.set_supports(brief.supports)
    mesh.set_creases(brief.creases)
    mesh.set_target(brief.K)
    mesh.set_goals(brief.goals)
    return mesh


def by_arrays(brief, world):
    problem = CGCProblem(*plan().arrays()).with_supports(brief.supports).with_creases(brief.creases).with_targets(brief.K)
    return solve(problem.with_goals(brief.goals), method=brief.method, settings=brief.settings).vertices


def by_command_line(suffix):
    def door(brief, world):
        source, target = world["folder"] / f"in{suffix}", world["folder"] / f"out{suffix}"
        write(source, posed(brief))
        options = [word for name, value in brief.settings.items() for word in (f"--{name}", str(value))]
        assert main(["solve", str(source), "-o", str(target), "--method", brief.method, *options, "-q"]) in (DONE, ROUGH)
        return result_of(target)[0] if suffix == ".3dm" else read(target).arrays()[0]

    return door


def by_http(as_mesh):
    def door(brief, world):
        vertices, faces = plan().arrays()
        given = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": brief.supports, "creases": brief.creases}
        given.update(targets=brief.K, goals=[constraint_data(constraint) for constraint in brief.goals])
        if as_mesh:
            given = {"mesh": {"dtype": "compas_cgc.datastructures/CGCMesh", "data": json.loads(json.dumps(posed(brief).__data__))}}
        client = world["server"].client
        body = json.dumps({**given, "method": brief.method, "settings": brief.settings}).encode()
        id = json.loads(world["server"].ask("POST", "/api/v1/jobs", body)[2])["id"]
        while client.poll(id, wait=5.0)["state"] in ("queued", "running"):
            pass
        return np.array(client.result(id)["vertices"])

    return door


def by_hops(brief, world):
    inputs = {"S" if name == "s" else name.capitalize(): value for name, value in brief.settings.items()}
    vertices, faces = plan().arrays()
    mesh = mesh_from_arrays(vertices, faces)
    curves = []
    for path in brief.creases:
        polyline = rhino3dm.Polyline(0)
        for x, y, z in vertices[path].tolist():
            polyline.Add(x, y, z)
        curves.append(polyline.ToPolylineCurve())
    given = {"Mesh": mesh, "K": [brief.K], "Method": brief.method, **({"Creases": curves} if curves else {}), **inputs}
    if brief.supports != "boundary":
        given["Supports"] = vertices[posed(brief).to_problem().roles == FIXED].tolist()
    if brief.goals:
        given["Goals"] = [json.dumps(constraint_data(constraint)) for constraint in brief.goals]
    function = "goals" if brief.goals else "solve"
    status, outputs, errors, _ = Hops(f"{world['server'].url}/cgc/{function}").solve(**given)
    assert status == 200, errors
    return np.array([(p.X, p.Y, p.Z) for p in outputs["Mesh"][0].Vertices.ToPoint3dArray()])


def by_rpc(brief, world):
    return world["proxy"].solve(posed(brief), method=brief.method, settings=brief.settings)["mesh"].arrays()[0]


def by_component(with_server):
    def door(brief, world):
        mesh = posed(brief)
        chosen = {} if brief.method == "auto" else {"method": brief.method}
        settings = place("Settings").run(**chosen, **brief.settings)["settings"]
        more = {"server": world["server"].url} if with_server else {}
        out = until_done(place("Solve"), cgc_mesh=mesh, settings=settings, run=True, **more)[-1]
        assert out["status"] == "converged", out
        return mesh_to_arrays(out["mesh"])[0]

    return door


DOORS = {
    "arrays": by_arrays,
    "command line, COMPAS json": by_command_line(".json"),
    "command line, 3dm": by_command_line(".3dm"),
    "HTTP, arrays": by_http(False),
    "HTTP, a COMPAS mesh": by_http(True),
    "Hops": by_hops,
    "RPC": by_rpc,
    "Grasshopper": by_component(False),
    "Grasshopper with a server": by_component(True),
}


@pytest.fixture(scope="module")
def world(open_server, proxy, tmp_path_factory):
    """A server and an RPC process that all briefs go to."""
    return {"server": open_server, "proxy": proxy, "folder": tmp_path_factory.mktemp("files")}


@pytest.fixture(scope="module")
def expected():
    """What Python gives for each brief."""
    found = {}
    for name, brief in BRIEFS.items():
        result = solve(posed(brief), method=brief.method, settings=brief.settings)
        assert result.converged, result.message
        found[name] = result.vertices
    return found


@pytest.mark.parametrize("brief", BRIEFS)
@pytest.mark.parametrize("door", DOORS)
def test_every_door_gives_the_same_bits(door, brief, world, expected):
    assert np.array_equal(DOORS[door](BRIEFS[brief], world), expected[brief])


def test_the_briefs_are_met(expected):
    high = expected["a roof on four corners at a height"]
    assert high[line(4)[4], 2] == pytest.approx(1.25, abs=1e-12)
    wait, follow = (expected[name] for name in ("creases that wait, to a tolerance", "creases that follow"))
    assert np.abs(wait - follow).max() > 0.01


@pytest.fixture
def toy():
    def still(problem, settings, callback):
        from compas_cgc.model.frame import Frame
        from compas_cgc.model.recorder import Recorder

        recorder = Recorder(1, callback, Frame(np.zeros(3), 1.0), lambda vertices: vertices)
        return Solution(problem.vertices, "converged", "nothing was done", 0, recorder.seconds, 0.0, recorder.history)

    yield register(Method("still", "The mesh as it is, untouched.", AutoSettings, still))
    METHODS.pop("still")


def test_a_fourth_method_is_found_in_every_door(toy, tmp_path, capsys):
    from compas_cgc.grasshopper.build.component_manifest import read_bundles
    from compas_cgc.server import create_app

    with pytest.raises(SystemExit):
        main(["solve", "--help"])
    assert "still" in capsys.readouterr().out
    source, target = tmp_path / "in.json", tmp_path / "out.json"
    write(source, posed(BRIEFS["creases that follow"]))
    assert main(["solve", str(source), "-o", str(target), "--method", "still", "-q"]) == ROUGH
    assert np.array_equal(read(target).arrays()[0], plan().arrays()[0])

    app = create_app(":memory:", executor=ThreadPoolExecutor(1))
    try:
        client = app.test_client()
        openapi = client.get("/openapi.json", base_url="http://127.0.0.1").get_data(as_text=True)
        assert '"still"' in openapi
        hops = client.get("/cgc/solve", base_url="http://127.0.0.1").get_data(as_text=True)
        assert "still" in hops
        page = client.get("/api/v1/methods", base_url="http://127.0.0.1").get_json()
        assert "still" in json.dumps(page)
    finally:
        app.extensions["jobs"].close()

    chosen = place("Settings").run(method="still", steps=3)["settings"]
    assert chosen == AutoSettings(steps=3)
    built = {bundle.key: bundle for bundle in read_bundles()}["CGC_Settings"]
    assert any("still" in parameter.description for parameter in built.inputs)
