"""CGCMesh under the operations of COMPAS meshes: transform, join, weld, subdivided, exploded, subclasses, files."""

from __future__ import annotations

import compas
import numpy as np
import pytest
from compas.datastructures import Mesh
from compas.geometry import Reflection
from compas.geometry import Rotation
from compas.geometry import Scale
from compas.geometry import Translation

import compas_cgc
import tests.datastructures
from compas_cgc import Above
from compas_cgc import Area
from compas_cgc import CGCMesh
from compas_cgc import Clearance
from compas_cgc import EdgeInPlan
from compas_cgc import Fixed
from compas_cgc import Height
from compas_cgc import Length
from compas_cgc import Level
from compas_cgc import Mirror
from compas_cgc import NearPlane
from compas_cgc import OnCurve
from compas_cgc import OnLine
from compas_cgc import OnPlane
from compas_cgc import OnSurface
from compas_cgc import Proximity
from compas_cgc import Rise
from compas_cgc import Unknown
from compas_cgc import Volume
from compas_cgc import Within
from compas_cgc.datastructures.subdivision import SCHEMES


class Roof(CGCMesh):
    """A subclass as an office writes it, with data of its own."""

    def __init__(self, *args, owner="", **kwargs):
        super().__init__(*args, **kwargs)
        self.owner = owner

    @property
    def __data__(self):
        return {**super().__data__, "owner": self.owner}

    @classmethod
    def __from_data__(cls, data):
        mesh = super().__from_data__(data)
        mesh.owner = data.get("owner", "")
        return mesh


def halves(cls=CGCMesh, n=6):
    """Return a square on its boundary with a fold along the middle and two targets."""
    mesh = cls.from_meshgrid(dx=6.0, nx=n)
    mesh.set_supports("boundary")
    mesh.set_creases([[n // 2 * (n + 1) + i for i in range(n + 1)]])
    mesh.set_target(0.02, region=0)
    mesh.set_target(0.04, region=1)
    mesh.set_strategy(s=0.5, e=3, crease=0)
    mesh.attributes.update(units="Meters", tolerance=0.001)
    mesh.name = "halves"
    return mesh


def similarity(seed, upright=True):
    """Return a random similarity and its scale."""
    random = np.random.default_rng(seed)
    axis = [0, 0, 1] if upright else random.normal(size=3).tolist()
    scale = float(10.0 ** random.uniform(-3, 3))
    parts = [Translation.from_vector(scale * random.uniform(-20, 20, 3)), Rotation.from_axis_and_angle(axis, random.uniform(-3, 3))]
    if random.integers(2):
        normal = [*random.normal(size=2), 0.0 if upright else random.normal()]
        parts.append(Reflection.from_plane(([0, 0, 0], normal)))
    T = Scale.from_factors([scale] * 3)
    for part in parts:
        T = part * T
    return T, scale


# ----------------------------------------------------------------------
# Transform
# ----------------------------------------------------------------------


def folded_roof():
    """A folded square on its boundary, its fold on a slope, curved after the solve."""
    mesh = halves(n=8)
    fold = mesh.creases()[0]
    at = [list(mesh.vertices()).index(v) for v in fold[1:-1]]
    mesh.set_goals([OnPlane(at, (3, 0, 0), (1, 0, 0))])
    return mesh


def open_roof():
    """A square on three sides, whose free edge slides on a plane and stays near the drawing at one vertex."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=8)
    mesh.set_supports([v for v in mesh.vertices() if not mesh.vertex_attribute(v, "x") and v or mesh.vertex_attribute(v, "y") in (0, 6)])
    mesh.set_target(0.02)
    free = [v for v in mesh.vertices() if mesh.vertex_role(v) == "free"]
    mesh.set_goals([OnPlane(free, (6, 0, 0), (1, 0, 0)), Proximity([40], 4.0)])
    return mesh


def crowned():
    """A square on its boundary with a prescribed rise and an unknown K."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=8)
    mesh.set_supports("boundary")
    mesh.set_target(0.02)
    mesh.set_goals([Rise(0.5), Unknown()])
    return mesh


def under_a_ceiling():
    """A saddle-cornered open roof with a highest vertex, a clearance and level edges."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=8)
    mesh.set_supports("corners")
    mesh.set_target(0.02)
    mesh.set_goals([EdgeInPlan(), Above(-0.2)])
    return mesh


ROOFS = {"folded": (folded_roof, False), "open": (open_roof, False), "crowned": (crowned, True), "ceiling": (under_a_ceiling, True)}


def apart(roof, seed):
    """Return how far solve(T(mesh)) is from T(solve(mesh)), relative to the size."""
    make, upright = ROOFS[roof]
    T, scale = similarity(seed, upright)
    mesh = make()
    moved = compas_cgc.solve(mesh.transformed(T)).mesh
    expected = compas_cgc.solve(mesh).mesh.transformed(T)
    assert moved.vertices_role() == expected.vertices_role() and moved.regions() == expected.regions()
    targets = [np.array(own.vertices_target(), float) for own in (moved, expected)]
    assert targets[0] == pytest.approx(targets[1], rel=1e-6, nan_ok=True)
    size = float(np.ptp(expected.arrays()[0], axis=0).max())
    return float(np.abs(moved.arrays()[0] - expected.arrays()[0]).max()) / size


@pytest.mark.parametrize("roof", ROOFS)
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.nightly)])
def test_solving_commutes_with_similarities(roof, seed):
    assert apart(roof, seed) < 1e-6


@pytest.mark.nightly
@pytest.mark.parametrize("roof", ROOFS)
@pytest.mark.parametrize("seed", range(2, 25))
def test_solving_commutes_with_more_similarities(roof, seed):
    assert apart(roof, seed) < 1e-6


GOALS = [
    OnPlane([3, 4], [1, 2, 3], [1, 1, 0]),
    Height([3], 2.0),
    Height("crown", 2.0),
    OnLine([3], [0, 1, 0], [0, 1, 1]),
    OnCurve([3, 4], [[0, 0, 0], [1, 0, 1], [2, 2, 2]]),
    Fixed([9]),
    Mirror([3, 0, 0], [1, 0, 0]),
    Proximity([9], 3.0),
    Rise(1.5),
    Volume(20.0),
    Volume(20.0, 0.5),
    Area(40.0),
    Length([9, 10, 11], 3.0),
    EdgeInPlan("free", [[0, 0], [5, 0], [5, 5]], True),
    EdgeInPlan(),
    Level([3, 4], [[1, 0], [2, 0]]),
    OnSurface([9], [[0, 0, 0], [9, 0, 0], [0, 9, 1]], [[0, 1, 2]]),
    Above(1.0),
    compas_cgc.Below(3.0, [8]),
    Clearance([1, 1, 3, 2], 0.5),
    Clearance(1, 0.5),
    Within([[0, 0], [9, 0], [9, 9], [0, 9]]),
    NearPlane([0, 0, 1], [0, 0, 2], 3.0),
    Unknown([1]),
]


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: type(goal).__name__)
def test_goals_return_after_a_similarity_and_its_inverse(goal):
    T, _ = similarity(5, upright=True)
    mesh = halves()
    mesh.set_goals([goal])
    there = mesh.transformed(T)
    back = there.transformed(T.inverted())
    assert len(there.goals()) == 1
    before, after = (own.attributes["goals"][0] for own in (mesh, back))
    if isinstance(goal, Clearance) and not isinstance(goal.where, int):
        before = {**before, "where": goal.outline()[:, :2].tolist()}
    assert set(before) == set(after) and before["kind"] == after["kind"]
    for name, value in before.items():
        if isinstance(value, str):
            assert after[name] == value
        elif name == "points" and before["kind"] in ("within", "edge in plan", "level"):
            assert np.array(after[name]) == pytest.approx(np.array(value)[:, :2], abs=1e-9)
        else:
            assert np.array(after[name]) == pytest.approx(np.array(value), rel=1e-9, abs=1e-9)
    if not isinstance(goal, (Fixed, Proximity, EdgeInPlan, Unknown)) or getattr(goal, "points", None) is not None:
        assert there.attributes["goals"] != mesh.attributes["goals"]


@pytest.mark.parametrize("goal", [Rise(1.5), Above(1.0), Clearance((1, 1, 3, 2), 0.5), Height("crown", 1.0), EdgeInPlan()])
def test_a_goal_about_the_vertical_refuses_to_tilt_and_nothing_changes(goal):
    mesh = halves()
    mesh.set_goals([goal])
    before = compas.json_dumps(mesh)
    with pytest.raises(ValueError, match="refers to the vertical, which this transformation tilts"):
        mesh.rotate(0.3, [1, 0, 0])
    assert compas.json_dumps(mesh) == before


def test_upside_down_a_lowest_height_is_a_highest_and_a_tilted_height_a_plane():
    mesh = halves()
    mesh.set_goals([Above(1.0, [9]), Rise(2.0), Height([8], 1.5)])
    turned = mesh.transformed(Rotation.from_axis_and_angle([1, 0, 0], np.pi))
    assert [own["kind"] for own in turned.attributes["goals"]] == ["below", "rise", "height"]
    assert [own.height for own in (turned.goals()[0], turned.goals()[2])] == pytest.approx([-1.0, -1.5])
    assert turned.goals()[1].rise == pytest.approx(-2.0)
    mesh.set_goals([Height([8], 1.5)])
    (plane,) = mesh.transformed(Rotation.from_axis_and_angle([1, 0, 0], 0.5)).goals()
    assert isinstance(plane, OnPlane) and plane.normal == pytest.approx([0, -np.sin(0.5), np.cos(0.5)])


def test_unequal_scaling_is_refused_where_targets_would_be_wrong():
    mesh = halves()
    before = compas.json_dumps(mesh)
    with pytest.raises(ValueError, match="scale x, y and z by the same factor"):
        mesh.scale(2, 1, 1)
    assert compas.json_dumps(mesh) == before
    plain = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    plain.set_supports("boundary")
    plain.scale(2, 1, 1)
    assert np.ptp(plain.arrays()[0], axis=0).tolist() == [12.0, 6.0, 0.0] and len(plain.supports()) == 24


def test_units_tolerance_and_defaults_scale():
    mesh = halves()
    mesh.update_default_vertex_attributes(target=0.5)
    mesh.scale(10)
    assert mesh.attributes["tolerance"] == pytest.approx(0.01) and mesh.default_vertex_attributes["target"] == pytest.approx(0.005)
    assert [mesh.region_target(r) for r in range(2)] == pytest.approx([0.0002, 0.0004])


def test_a_transformed_result_continues_from_the_drawn_shape():
    mesh = compas_cgc.solve(halves()).mesh
    T, scale = similarity(3)
    moved = mesh.transformed(T)
    moved.set_target(0.03 / scale**2, region=1)
    mesh.set_target(0.03, region=1)
    drawn, expected = moved.to_problem().drawn, mesh.to_problem().drawn.transformed(T)
    assert drawn is not None and drawn.vertices == pytest.approx(expected.vertices, rel=1e-9, abs=1e-9 * scale)


# ----------------------------------------------------------------------
# Join, weld, parts
# ----------------------------------------------------------------------


def test_joining_keeps_both_meshes():
    mesh, other = halves(), halves()
    mesh.set_goals([Above(-1.0), Length([8, 9, 10], 2.5), Clearance(1, 0.5)])
    other.set_goals([Height([24], 0.5), Unknown(), Level([1, 2], [[1, 0], [2, 0]])])
    other.translate([10, 0, 0])
    n, regions = mesh.number_of_vertices(), len(mesh.regions())
    mesh.join(other)
    assert mesh.vertices_role()[n:] == other.vertices_role() == mesh.vertices_role()[:n]
    assert len(mesh.regions()) == 2 * regions and len(mesh.creases()) == 2
    assert [mesh.region_target(r) for r in range(4)] == [0.02, 0.04, 0.02, 0.04]
    assert [mesh.vertex_s(v) for path in mesh.creases() for v in path] == [0.5] * 14
    kinds = {own["kind"]: own for own in mesh.attributes["goals"]}
    assert kinds["height"]["vertices"] == [n + 24] and kinds["unknown"]["regions"] == [2, 3]
    assert kinds["length"]["vertices"] == [8, 9, 10] and kinds["clearance"]["where"] == 1
    assert kinds["level"]["vertices"] == [n + 1, n + 2] and max(kinds["above"]["vertices"]) < n
    assert mesh.attributes["units"] == "Meters" and not [p for p in mesh.check() if p.fatal]


def test_joining_with_other_defaults_keeps_the_targets_of_both():
    mesh, other = halves(), CGCMesh.from_meshgrid(dx=6, nx=4)
    other.update_default_vertex_attributes(target=0.7)
    other.set_supports("boundary")
    other.translate([0, 0, 3])
    mesh.join(other)
    assert [mesh.region_target(r) for r in range(3)] == [0.02, 0.04, 0.7]


def test_joining_refuses_different_units_and_contradictory_wholes():
    mesh, other = halves(), halves()
    other.attributes["units"] = "Millimeters"
    with pytest.raises(ValueError, match="drawn in Meters and Millimeters; scale one"):
        mesh.join(other)
    other.attributes["units"] = "Meters"
    mesh.set_goals([Rise(1.0)])
    other.set_goals([Rise(2.0)])
    before = compas.json_dumps(mesh)
    with pytest.raises(ValueError, match="the rise 1 and the rise 2 of the two meshes cannot both hold"):
        mesh.join(other)
    assert compas.json_dumps(mesh) == before


def test_welding_makes_one_manifold_mesh_and_a_crease_between_targets():
    mesh, other = halves(), halves()
    other.translate([6, 0, 0])
    mesh.set_goals([Fixed([45])])
    mesh.join(other, weld=True)
    assert mesh.number_of_vertices() == 91 and mesh.is_manifold() and len(mesh.boundary_loops()) == 1
    assert len(mesh.regions()) == 4 and [mesh.region_target(r) for r in range(4)] == [0.02, 0.04, 0.02, 0.04]
    assert len(mesh.supports()) == 24 + 24 - 7  # those along the seam, once
    assert len(mesh.crease_edges()) == 18 and mesh.goals()[0].vertices == [45]
    twin, same = halves(), halves()
    same.transform(Reflection.from_plane(([6, 0, 0], [1, 0, 0])))
    twin.join(same, weld=True)
    assert len(twin.regions()) == 3  # 0.04 on both sides of the seam


def test_a_plain_mesh_joins_too():
    mesh, plain = halves(), Mesh.from_meshgrid(dx=6, nx=3)
    plain.translate([0, 10, 0])
    mesh.join(plain)
    assert mesh.is_trimesh() and len(mesh.regions()) == 3 and not mesh.to_problem().supports.max() >= 49


def test_thickened_and_exploded_keep_supports_and_creases():
    mesh = halves()
    mesh.set_goals([Fixed([24]), Unknown([1])])
    both = halves()
    both.set_goals(mesh.goals())
    other = mesh.copy()
    other.translate([20, 0, 0])
    both.join(other)
    parts = both.exploded()
    assert len(parts) == 2 and all(type(part) is CGCMesh for part in parts)
    assert all(len(part.regions()) == 2 and part.vertices_role() == mesh.vertices_role() for part in parts)
    assert all(part.attributes["goals"] == mesh.attributes["goals"] for part in parts)
    thick = halves().thickened(0.2)
    assert len(thick.creases()) >= 2 and thick.vertices_role().count("fixed") == 48


def test_deleting_vertices_renumbers_goals():
    mesh = halves()
    mesh.set_goals([Height([24, 30], 0.5), Length([8, 9], 1.0), Level([9, 10], [[1, 0], [2, 0]])])
    mesh.delete_vertex(9)
    assert mesh.attributes["goals"] == [
        {"kind": "height", "vertices": [23, 29], "height": 0.5},
        {"kind": "level", "vertices": [9], "points": [[2, 0]]},
    ]
    mesh.add_vertex(key=99, x=0, y=0, z=0)
    mesh.remove_unused_vertices()
    assert mesh.goals()[0].vertices == [23, 29]


# ----------------------------------------------------------------------
# Subdivision
# ----------------------------------------------------------------------


@pytest.mark.parametrize("scheme", SCHEMES)
def test_subdivision_keeps_supports_creases_regions_and_targets(scheme):
    mesh = halves()
    fold = mesh.creases()[0]
    mesh.set_goals([OnPlane(fold, (3, 0, 0), (1, 0, 0)), Length(fold, 7.0), Unknown([1]), Rise(1.0)])
    fine = mesh.subdivided(scheme, k=2)
    assert type(fine) is CGCMesh and fine.is_trimesh() and fine.is_manifold() and fine.name == "halves"
    assert len(fine.regions()) == 2 and [fine.region_target(r) for r in range(2)] == [0.02, 0.04]
    (path,) = fine.creases()
    places = np.array([fine.vertex_coordinates(v) for v in path])
    assert np.ptp(places[:, 0]) == pytest.approx(0.0, abs=1e-9) and np.ptp(places[:, 1]) == pytest.approx(6.0)
    assert [fine.vertex_s(v) for v in path] == [0.5] * len(path) and {fine.vertex_e(v) for v in path} == {3}
    rim = {v for loop in fine.boundary_loops() for v in loop}
    assert set(fine.supports()) == rim
    assert fine.attributes["units"] == "Meters"
    index = {key: i for i, key in enumerate(fine.vertices())}
    on_plane, along = fine.goals()[:2]
    assert sorted(on_plane.vertices) == sorted(index[v] for v in path)
    assert along.vertices in ([index[v] for v in path], [index[v] for v in reversed(path)])
    assert not [p for p in fine.check() if p.fatal]


def test_subdivision_keeps_a_crease_of_a_curved_mesh_and_chords_free():
    mesh = CGCMesh.from_meshgrid(dx=2, nx=2)
    mesh.set_supports("boundary")
    mesh.set_target(0.1)
    fine = mesh.subdivided("corner")
    assert len(fine.supports()) == 16 == len(fine.boundary_loops()[0])
    assert fine.vertices_role().count("internal") == 9


def test_schemes_without_creases_are_refused_by_name():
    with pytest.raises(ValueError, match="scheme must be one of catmullclark.*not 'doosabin'"):
        halves().subdivided("doosabin")


def test_dummies_stay_dummies():
    mesh = halves()
    mesh.set_supports("corners")
    mesh.set_target(0.02)
    mesh.add_dummy_ring()
    fine = mesh.subdivided("corner")
    plain = mesh.without_dummies().subdivided("corner")
    assert fine.without_dummies().number_of_faces() == plain.number_of_faces()


# ----------------------------------------------------------------------
# Subclasses and files
# ----------------------------------------------------------------------


def test_a_subclass_stays_one_with_its_data(tmp_path, monkeypatch):
    # COMPAS imports a class from the first two parts of its module name.
    monkeypatch.setattr(tests.datastructures, "Roof", Roof, raising=False)
    roof = halves(Roof)
    roof.owner = "office"
    roof.to_json(tmp_path / "roof.json")
    made = [roof.copy(), compas.json_loads(compas.json_dumps(roof)), Roof.from_json(tmp_path / "roof.json")]
    assert all(type(own) is Roof and own.owner == "office" and len(own.regions()) == 2 for own in made)
    assert type(roof.subdivided("corner")) is type(roof.transformed(Translation.from_vector([1, 0, 0]))) is Roof
    assert type(compas_cgc.solve(roof).mesh) is Roof
    assert type(CGCMesh.from_json(tmp_path / "roof.json")) is CGCMesh
    assert type(roof.copy(cls=Mesh)) is Mesh
