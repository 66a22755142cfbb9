"""Data trees with nulls: matched as Grasshopper documents it, baked and written branch by branch."""

from __future__ import annotations

import itertools
import sys

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.grasshopper.runtime.trees import branches_of
from compas_cgc.grasshopper.runtime.trees import matched
from compas_cgc.grasshopper.runtime.wire_mesh import WireMesh
from compas_cgc.io import read_mesh

from ...support.gh_stand_ins import DataTree
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.tiers import push_only

pytestmark = pytest.mark.usefixtures("rhino")


def halves(number=0):
    """Return a mesh of two regions, which its place identifies."""
    mesh = CGCMesh.from_meshgrid(dx=2.0, nx=2)
    mesh.translate([10.0 * number, 0.0, 0.0])
    mesh.set_supports("corners")
    mesh.set_creases([[1, 4, 7]])
    mesh.set_target(0.01)
    return WireMesh(mesh.to_problem())


def number_of(mesh):
    return round((mesh.to_problem().vertices[:, 0].min()) / 10.0)


def random_tree(rng, values):
    """Return a tree of up to four branches, of up to four items, with nulls."""
    paths = sorted({tuple(rng.integers(0, 3, rng.integers(1, 3)).tolist()) for _ in range(rng.integers(1, 5))})
    return {path: [None if rng.random() < 0.25 else next(values) for _ in range(rng.integers(1, 5))] for path in paths}


def longest_list(**trees):
    """Yield what Grasshopper documents, written as it is documented: path, number in the branch, and the item of each input.

    "The longest list algorithm will match the last item of shorter lists to all the remaining items of longer lists"; trees are lists
    of lists, matched the same way, and the paths of the longest tree are those of the result.
    """
    longest = max(trees.values(), key=len)
    columns = {name: list(tree.values()) for name, tree in trees.items()}
    for place_in_tree, path in enumerate(longest):
        lists = {}
        for name, column in columns.items():
            lists[name] = column[place_in_tree] if place_in_tree < len(column) else column[-1]
        for place_in_list in range(max(len(own) for own in lists.values())):
            item = {}
            for name, own in lists.items():
                item[name] = own[place_in_list] if place_in_list < len(own) else own[-1]
            yield path, place_in_list, item


def document():
    return sys.modules["Rhino"].RhinoDoc.ActiveDoc


@pytest.mark.parametrize("seed", push_only(range(200), *range(40)))
def test_trees_are_matched_by_the_longest_list(seed):
    rng = np.random.default_rng(seed)
    trees = {name: random_tree(rng, itertools.count(100 * k)) for k, name in enumerate("abc")}
    found = matched(*(branches_of(DataTree(tree)) for tree in trees.values()))
    flat = [(match.path.Indices, number, dict(zip("abc", row))) for match in found for number, row in enumerate(match.rows)]
    assert flat == list(longest_list(**trees))


@pytest.mark.parametrize("seed", push_only(range(200), *range(40)))
def test_ids_put_out_are_the_objects_baked(seed):
    rng, placed = np.random.default_rng(seed), place("Bake")
    kept = place("Bake").run(cgc_mesh=halves(99), bake=True)["baked"].AllData()
    for _ in range(2):  # in the second one, branches have vanished and appeared
        meshes = random_tree(rng, map(halves, itertools.count()))
        layers = random_tree(rng, (f"Roof {number}" for number in itertools.count()))
        if not any(mesh is not None for tree in meshes.values() for mesh in tree):
            meshes[0,] = [halves(0)]
            meshes = dict(sorted(meshes.items()))
        out = placed.run(cgc_mesh=DataTree(meshes), layer=DataTree(layers), bake=True)["baked"]
        objects = {str(id): one for id, one in document().Objects.items()}
        ids = [id for id in out.AllData() if id is not None]
        assert len(set(ids)) == len(ids) and set(ids) | set(kept) == set(objects)
        expected = list(longest_list(mesh=meshes, layer=layers))
        assert [path.Indices for path in out.Paths] == [(*path, number) for path, number, _ in expected]
        for (_path, _number, item), branch in zip(expected, map(out.Branch, out.Paths)):
            if item["mesh"] is None:
                assert branch == [None], "nulls keep their place"
                continue
            surface = objects[branch[0]]
            layer = document().Layers.full_path(document().Layers[surface.Attributes.LayerIndex])
            assert layer == f"{item['layer'] or 'CGC Result'}::Mesh" and len(branch) == 8
            assert round(min(point.X for point in surface.Geometry.Vertices) / 10.0) == number_of(item["mesh"])
    assert document().undo == ["Bake CGC"] * 3 and document().open == 0


def runs_of(**trees):
    """Yield the runs of a component whose first input takes items and whose others take lists: one for each item of each branch."""
    (first, items), *others = trees.items()
    count = max(len(tree) for tree in trees.values())
    for number in range(count):
        branch = {name: list(tree.values())[min(number, len(tree) - 1)] for name, tree in trees.items()}
        for item in branch.pop(first):
            yield item, branch


@pytest.mark.parametrize("seed", push_only(range(200), *range(40)))
def test_targets_of_trees_with_nulls_reach_their_regions(seed):
    rng, placed = np.random.default_rng(seed), place("Target")
    meshes = random_tree(rng, map(halves, itertools.count()))
    regions = random_tree(rng, iter(lambda: int(rng.integers(2)), None))
    values = {path: [None if rng.random() < 0.25 else float(rng.integers(1, 9)) for _ in own] for path, own in regions.items()}
    for placed.component.RunCount, (mesh, lists) in enumerate(runs_of(cgc_mesh=meshes, region=regions, K=values), 1):
        out = placed.run(cgc_mesh=mesh, **lists)["cgc_mesh"]
        pairs = [(region, K) for region, K in zip(lists["region"], lists["K"]) if region is not None and K is not None]
        if mesh is None:
            assert out is None
        elif not any(lists["K"]):
            assert out is None and placed.said("Error")[0].startswith("connect at least one curvature")
        else:
            assert out.to_problem().region_targets() == [dict(pairs).get(region, 0.01) for region in range(2)]
            conflicts = [region for region in range(2) if len({K for own, K in pairs if own == region}) > 1]
            assert len(placed.said("Warning")) >= len(conflicts) and bool(placed.said("Warning")) == bool(conflicts)


def test_what_has_not_changed_is_not_baked_again():
    placed, mesh = place("Bake"), halves()
    first = placed.run(cgc_mesh=mesh, bake=True)["baked"].AllData()
    assert placed.run(cgc_mesh=mesh, bake=True)["baked"].AllData() == first and len(document().undo) == 1
    document().Objects.pop(next(iter(document().Objects)))
    second = placed.run(cgc_mesh=mesh, bake=True)["baked"].AllData()
    assert set(second) == {str(id) for id in document().Objects} and len(document().undo) == 2, "the user had deleted an object"
    placed.run(cgc_mesh=mesh, bake=False)
    third = placed.run(cgc_mesh=mesh, bake=True)["baked"].AllData()
    assert not set(second) & set(third) and len(document().undo) == 3, "the button was pressed again"


def test_an_invalid_layer_deletes_nothing():
    placed, mesh = place("Bake"), halves()
    placed.run(cgc_mesh=mesh, bake=True)
    before = set(document().Objects)
    assert placed.run(cgc_mesh=mesh, layer="::", bake=True)["baked"] is None
    assert "Rhino cannot create the layer" in placed.said("Error")[0] and set(document().Objects) == before


def test_every_mesh_is_written_to_its_path(tmp_path):
    placed = place("Write3dm")
    meshes = {(0,): [halves(0), None], (1,): [halves(2), halves(3)]}
    paths = {(0,): [str(tmp_path / f"{name}.obj") for name in "ab"], (1,): [str(tmp_path / f"{name}.obj") for name in "cd"]}
    out = placed.run(path=DataTree(paths), cgc_mesh=DataTree(meshes), write=True)["written"]
    assert out.branches == {0: [paths[0,][0], None], 1: paths[1,]}
    assert [number_of(read_mesh(tmp_path / f"{name}.obj")[0]) for name in "acd"] == [0, 2, 3] and not (tmp_path / "b.obj").exists()
    path = str(tmp_path / "all.obj")
    assert placed.run(path=path, cgc_mesh=DataTree(meshes), write=True)["written"] is None
    assert "3 meshes have the path" in placed.said("Error")[0] and not (tmp_path / "all.obj").exists()


def test_if_one_file_cannot_be_written_none_is(tmp_path):
    placed = place("Write3dm")
    paths = [str(tmp_path / "a.3dm"), str(tmp_path / "folder.3dm")]
    (tmp_path / "folder.3dm").mkdir()
    out = placed.run(path=DataTree({(0,): paths}), cgc_mesh=DataTree({(0,): [halves(0), halves(1)]}), write=True)
    assert out["written"] is None and "folder.3dm" in placed.said("Error")[0]
    assert [path.name for path in tmp_path.iterdir()] == ["folder.3dm"]
