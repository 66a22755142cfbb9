"""CGC meshes as COMPAS scene objects, with stand-ins for the applications they are drawn in."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest
from compas.plugins import PluginManager
from compas.scene import MeshObject
from compas.scene import Scene
from compas.scene import context

import compas_cgc.scene
from compas_cgc import CGCMesh
from compas_cgc.model.measures import measured_curvature
from compas_cgc.model.measures import read_inwards
from compas_cgc.scene.figures import coloured
from compas_cgc.scene.figures import figures

from ..support.freeform import mesh_over
from ..support.gh_stand_ins import Mesh
from ..support.gh_stand_ins import Point3d
from ..support.gh_stand_ins import PolylineCurve
from ..support.gh_stand_ins import rhino  # noqa: F401

pytestmark = pytest.mark.usefixtures("rhino")


def folded_roof():
    """Return a roof with a ridge, two supports at its ends, and a dummy ring."""
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    for key in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(key)
        mesh.vertex_attribute(key, "z", 1 / 3 * (4 - (x - 2) ** 2))
    mesh.set_creases([[5 * 2 + j for j in range(5)]])
    mesh.set_supports([0, 24])
    mesh.set_target(0.1)
    mesh.add_dummy_ring()
    return mesh


@pytest.fixture
def registered(monkeypatch):
    """Register the scene objects and take them back afterwards."""
    kept = {name: dict(types_) for name, types_ in context.ITEM_SCENEOBJECT.items()}
    yield
    context.ITEM_SCENEOBJECT.clear()
    context.ITEM_SCENEOBJECT.update(kept)
    for name in ("rhino", "grasshopper", "notebook", "viewer"):
        sys.modules.pop(f"compas_cgc.scene.{name}", None)


def test_compas_finds_the_plugins_of_the_package():
    finder = PluginManager()
    finder.load_plugins()
    homes = {own.method.__module__ for found in finder.registry.values() for own in found}
    # Those of Rhino, Grasshopper, notebooks and compas_viewer require these.
    assert {"compas_cgc.io.plugins"} <= homes
    assert set(compas_cgc.__all_plugins__) <= set(sys.modules) and "__all_plugins__" in dir(compas_cgc)


def stand_in(monkeypatch, name, **names):
    made = types.ModuleType(name)
    made.__dict__.update(names)
    monkeypatch.setitem(sys.modules, name, made)


def added(mesh, where, **options):
    return Scene(context=where).add(mesh, context=where, **options)


def test_figures_are_those_of_the_surface():
    mesh = folded_roof()
    values = figures(mesh)
    inner = np.isfinite(values["K"])
    assert inner.tolist() == read_inwards(mesh.without_dummies().to_problem()).tolist() and inner.any()
    assert values["K"] == pytest.approx(measured_curvature(mesh.without_dummies().to_problem()), nan_ok=True)
    assert values["K"][inner] == pytest.approx(0.0, abs=0.01), "a vault unrolls, to second order on six vertices"
    assert values["k_max"][inner] * values["k_min"][inner] == pytest.approx(values["K"][inner])
    assert values["k_max"][inner] + values["k_min"][inner] == pytest.approx(2 * values["H"][inner])
    assert values["error"][inner] == pytest.approx(values["K"][inner] - 0.1)
    found = coloured(mesh, "error")
    assert found.limit == pytest.approx(np.abs(values["error"][inner]).max())
    assert found.colours[inner][0][2] > found.colours[inner][0][0], "too little is blue"
    assert len({tuple(colour) for colour in found.colours[~inner].tolist()}) == 1, "grey where there is nothing to tell"
    with pytest.raises(ValueError, match="show must be one of K, H"):
        coloured(mesh, "curvature")


def test_in_grasshopper(registered, monkeypatch):
    stand_in(monkeypatch, "compas_ghpython.scene", MeshObject=MeshObject)
    compas_cgc.scene.register_grasshopper()
    mesh = folded_roof()
    drawn = added(mesh, "Grasshopper", show_figure="error").draw()
    assert [type(part) for part in drawn] == [Mesh, Point3d, Point3d, PolylineCurve]
    assert [list(p) for p in drawn[0].Vertices] == mesh.arrays()[0].tolist(), "every digit, and no dummies"
    assert drawn[0].VertexColors[6] == tuple(coloured(mesh, "error").colours[6].tolist())
    assert len(drawn[3].points) == 5


def test_in_rhino(registered, monkeypatch):
    class RhinoMeshObject(MeshObject):
        def compile_attributes(self, name):
            return {"name": name}

        def draw_vertices(self):
            return [("point", key) for key in self.show_vertices]

        def draw_edges(self):
            return [("line", edge) for edge in self.show_edges]

    document = []
    objects = types.SimpleNamespace(AddMesh=lambda mesh, attributes: document.append((mesh, attributes)) or "mesh")
    stand_in(monkeypatch, "scriptcontext", doc=types.SimpleNamespace(Objects=objects))
    stand_in(monkeypatch, "compas_rhino.scene", RhinoMeshObject=RhinoMeshObject)
    compas_cgc.scene.register_rhino()
    drawn = added(folded_roof(), "Rhino", name="roof").draw()
    assert drawn[0] == "mesh" and drawn[1:3] == [("point", 0), ("point", 24)] and len(drawn) == 3 + 4
    assert document[0][1] == {"name": "roof"} and len(document[0][0].VertexColors) == 25


def test_in_the_viewer(registered, monkeypatch):
    class ViewerMeshObject(MeshObject):
        def __init__(self, use_vertexcolors=None, show_points=None, pointsize=None, **options):
            super().__init__(**options)
            self.use_vertexcolors, self.show_points = use_vertexcolors, show_points

    stand_in(monkeypatch, "compas_viewer")
    stand_in(monkeypatch, "compas_viewer.scene", MeshObject=ViewerMeshObject)
    compas_cgc.scene.register_viewer()
    drawn = added(folded_roof(), "Viewer", use_vertexcolors=None, show_points=None)
    assert drawn.use_vertexcolors and drawn.show_points
    points, colours, elements = drawn._read_points_data()
    assert len(points) == len(colours) == 2 and elements == [[0], [1]]
    points, colours, elements = drawn._read_lines_data()
    assert len(elements) == 4 + 16 and len(points) == len(colours) == 40 and elements[-1] == [38, 39]


def test_in_a_notebook(registered):
    pytest.importorskip("compas_notebook", reason="compas_notebook is not installed")
    three = pytest.importorskip("pythreejs")
    compas_cgc.scene.register_notebook()
    roof = folded_roof()
    drawn = added(roof, "Notebook", show_figure="error").draw()
    surface, *rest = drawn
    assert isinstance(surface, three.Mesh) and [type(own) for own in rest] == [three.LineSegments, three.LineSegments, three.Points]

    def array(thing, name):
        return thing.geometry.attributes[name].array

    assert len(array(surface, "position")) == 3 * 32, "no dummies"
    inner = np.linalg.norm(array(surface, "position")[:, :2] - 2.0, axis=1) < 0.1
    assert len(array(rest[0], "position")) == 2 * 4 and len(array(rest[1], "position")) == 2 * 16 and len(array(rest[2], "position")) == 2
    by_error, by_K = array(surface, "color"), array(added(roof, "Notebook", show_figure="k_max").draw()[0], "color")
    assert inner.any() and not np.array_equal(by_error, by_K), "the figure asked for is shown"
    with pytest.raises(ValueError, match="show must be one of"):
        added(roof, "Notebook", show_figure="slope").draw()


def test_in_the_viewer_itself(registered, monkeypatch):
    """Not with stand-ins: compas_viewer as it is, without a window."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    viewer = pytest.importorskip("compas_viewer", reason="compas_viewer is not installed")
    scene = pytest.importorskip("compas_viewer.scene", exc_type=ImportError, reason="compas_viewer cannot be loaded here")
    for name in ("_read_points_data", "_read_lines_data"):
        assert callable(getattr(scene.MeshObject, name)), "what ours takes the place of is there"
    drawn = viewer.Viewer().scene.add(folded_roof())
    assert type(drawn).__module__ == "compas_cgc.scene.viewer" and isinstance(drawn, scene.MeshObject)
    assert [len(part) for part in drawn._read_points_data()] == [2, 2, 2]
    assert len(drawn._read_lines_data()[2]) == 4 + 16
    points, colours, elements = drawn._read_frontfaces_data()
    assert len(points) == len(colours) == 3 * 32 and len(elements) == 32, "no dummies"
    assert len({tuple(colour) for colour in colours}) > 1, "coloured by K"


def test_compas_is_told_what_each_registration_needs():
    for function, name in (
        (compas_cgc.scene.register_rhino, "Rhino"),
        (compas_cgc.scene.register_grasshopper, "Grasshopper"),
        (compas_cgc.scene.register_viewer, "compas_viewer"),
        (compas_cgc.scene.register_notebook, "compas_notebook"),
    ):
        found = function.__plugin_spec__
        assert found["extension_point_url"].endswith("/factories/register_scene_objects") and found["requires"] == [name]


def test_a_mesh_without_dummies_is_drawn_itself(registered, monkeypatch):
    stand_in(monkeypatch, "compas_ghpython.scene", MeshObject=MeshObject)
    compas_cgc.scene.register_grasshopper()
    mesh = folded_roof().without_dummies()
    assert added(mesh, "Grasshopper").mesh is mesh


def test_a_rationalised_design_has_its_moulds_seams_distances_and_design(registered):
    from compas.datastructures import Mesh
    from compas.geometry import Polyline
    from compas.scene import GeometryObject
    from compas.scene import register

    from compas_cgc import rationalise
    from compas_cgc.errors import CGCError
    from compas_cgc.rationalisation import add_to_scene

    register(Mesh, MeshObject, context="Any")
    register(Polyline, GeometryObject, context="Any")
    design = mesh_over(lambda x, y: 1.0 - 0.03 * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2, 8.0, 4.0, 0.5)
    found = rationalise(design, panel=2.0, edges=3, moulds=2)
    scene = Scene(context="Any")
    first, second, *seams, distance, drawn = add_to_scene(scene, found, "distance")
    assert [own.show for own in (first, second, distance, drawn)] == [False, False, True, False] and all(own.show for own in seams)
    assert len(seams) == len(found.result.problem.crease_paths()) and first.color != second.color
    shares = [own.item.area() / found.result.mesh.area() for own in (first, second)]
    by_mould = found.panels_per_class / found.panels_per_class.sum()
    assert sum(shares) == pytest.approx(1.0) and shares == pytest.approx(by_mould.tolist(), abs=0.1)
    largest = int(found.distance.signed.argmax())
    red, _, blue = distance.vertexcolor[largest].rgb
    assert red > blue and np.allclose(distance.item.vertex_coordinates(largest), found.result.vertices[largest])
    assert np.allclose(drawn.item.vertex_coordinates(largest), found.panelling.vertices[largest])
    with pytest.raises(CGCError, match="show must be one of moulds"):
        add_to_scene(scene, found, "moulds ")
