"""Goals that contradict each other are told by both their names; what a surface has is never refused."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings
from hypothesis import strategies as st

from compas_cgc.discrete import boundary_vertices
from compas_cgc.model.constraints import Fixed
from compas_cgc.model.constraints import Height
from compas_cgc.model.constraints import OnPlane
from compas_cgc.model.goals import measures
from compas_cgc.model.goals.contradictions import goal_problems
from compas_cgc.model.goals.inequalities import Above
from compas_cgc.model.goals.inequalities import Below
from compas_cgc.model.goals.inequalities import Clearance
from compas_cgc.model.goals.inequalities import NearPlane
from compas_cgc.model.goals.inequalities import Within
from compas_cgc.model.goals.places import EdgeInPlan
from compas_cgc.model.goals.places import Level
from compas_cgc.model.goals.wholes import Area
from compas_cgc.model.goals.wholes import Length
from compas_cgc.model.goals.wholes import Rise
from compas_cgc.model.goals.wholes import Volume
from compas_cgc.model.problem import CGCProblem
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import FREE
from compas_cgc.model.roles import INTERNAL

from ..support import shapes

N, WIDTH = 8, 8.0
RIM = [k for k in range(N + 1)]  # of the side x = 0, a support at each end


def roof(held: bool = False) -> CGCProblem:
    """A flat square of 8 m on its corners, or on its whole edge."""
    vertices, faces = shapes.grid(N, WIDTH)
    rim = boundary_vertices(vertices, faces)
    roles = np.where(rim, FIXED if held else FREE, INTERNAL)
    roles[[0, N, (N + 1) ** 2 - 1, N * (N + 1)]] = FIXED
    return CGCProblem(vertices, faces, roles, 0.005)


def box(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float]]:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


FAR, SMALL = box(20, 20, 30, 30), box(2, 2, 6, 6)
PAIRS = {
    "lowest and greatest": ([Above(1.0), Below(-1.0)], "the lowest height 1 and the highest height -1"),
    "rise and ceiling": ([Rise(3.0), Below(2.0)], "the highest height 2 and the rise 3"),
    "sag and floor": ([Rise(-3.0), Above(-2.0)], "the lowest height -2 and the rise -3"),
    "sag and ceiling": ([Rise(-1.0), Below(-2.0, [40])], "the highest height -2 and the rise -1"),
    "sag and a low vertex": ([Rise(-1.0), Height([40], -2.0)], "the height -2 of vertices and the rise -1"),
    "crown and floor": ([Height("crown", 2.0), Above(3.0)], "the lowest height 3 and the height 2 of the crown"),
    "crown and a high vertex": ([Height("crown", 2.0), Height([40], 3.0)], "the height 3 of vertices and the height 2 of the crown"),
    "clearance and ceiling": ([Clearance((2, 2, 5, 5), 3.0), Below(2.0)], "the clearance 3 and the highest height 2"),
    "clearance and a low vertex": ([Clearance((2, 2, 6, 6), 3.0), Height([40], 1.0)], "the clearance 3 and the height 1"),
    "two heights of a vertex": ([Height([40], 1.0), Height([40, 41], 2.0)], "the height 2 of vertices and the height 1 of vertices"),
    "floor and slab": ([Above(3.0), NearPlane((0, 0, 1), (0, 0, -2), 0.5)], "the lowest height 3 and the distance from a plane 0.5"),
    "slab and ceiling": ([NearPlane((0, 0, 5), (0, 0, 1), 0.5), Below(3.0)], "the distance from a plane 0.5 and the highest height 3"),
    "plane and ceiling": ([OnPlane([40], (0, 0, 4), (0, 0, 1)), Below(3.0)], "the level plane at 4 and the highest height 3"),
    "fixed place and floor": ([Fixed([40]), Above(1.0)], "the lowest height 1 and the fixed height 0 of vertex 40"),
    "support and height": (
        [Height([0], 1.0)],
        "the height 1 of vertices contradicts the height 0 of the support at vertex 0; free that vertex",
    ),
    "level edge at two heights": (
        [Level(RIM[1:-1]), Height([2], 1.0), Height([5], 2.0)],
        "the height 2 of .* and the height 1 of .* on the level",
    ),
    "level edge and ceiling": ([Level(RIM[1:-1]), Above(2.0, [3]), Below(1.0, [6])], "the lowest height 2 and the highest height 1"),
    "level edge with a support": (
        [Level(RIM[:-1]), Height([5], 2.0)],
        "the height 2 of vertices and the height 0 of the support at vertex 0",
    ),
    "level edge elsewhere": ([Level([2, 3], [(5, 2), (5, 3)]), EdgeInPlan(RIM)], "the level edge and the edge in plan .* 5 apart"),
    "volume and ceiling": ([Volume(300.0), Below(2.0), EdgeInPlan()], "the volume 300 and the highest height 2 .* at most 128"),
    "volume and rise": ([Volume(300.0), Rise(2.0), EdgeInPlan()], "the volume 300 and the rise 2"),
    "volume and floor": ([Volume(10.0, -2.0), Above(-1.0), EdgeInPlan()], "the volume 10 and the lowest height -1"),
    "path and heights": ([Length([37, 38, 39, 40], 4.0), Height([40], 3.0), Height([37], -2.0)], "length of a path 4 and the height -2"),
    "within and within": ([Within(SMALL, [40]), Within(FAR, [40])], "the outline to stay within and the outline to stay within"),
    "edge outside": (
        [Within(SMALL, RIM[1:-1]), EdgeInPlan(RIM)],
        "the outline to stay within and the edge in plan .* the whole edge lies outside",
    ),
    "level edge outside": ([Within(SMALL, RIM[1:-1]), Level(RIM[1:-1])], "the outline to stay within and the level edge .* 2.24 outside"),
    "support outside": ([Within(SMALL)], "the outline to stay within excludes the support"),
    "plane and line": (
        [Within(SMALL, [40]), NearPlane((20, 0, 0), (1, 0, 0), 1.0, [40])],
        "the outline to stay within and the distance from a",
    ),
    "plane and edge": (
        [NearPlane((5, 0, 0), (1, 0, 0), 1.0, RIM[1:-1]), EdgeInPlan(RIM)],
        "the distance from a plane 1 and the edge in plan",
    ),
}


@pytest.mark.parametrize("case", PAIRS)
def test_a_contradiction_is_one_sentence_that_names_the_pair(case):
    goals, words = PAIRS[case]
    for order in (goals, goals[::-1]):
        said = goal_problems(roof().with_goals(order))
        assert len(said) == 1, said
    (said,) = goal_problems(roof().with_goals(goals))
    assert re.search(words, said), said


def test_volume_over_a_held_edge():
    (said,) = goal_problems(roof(held=True).with_goals([Volume(300.0), Below(2.0)]))
    assert "the volume 300 and the highest height 2 contradict each other" in said
    assert not goal_problems(roof(held=True).with_goals([Volume(100.0), Below(2.0)]))
    assert not goal_problems(roof().with_goals([Volume(300.0), Below(2.0)])), "its free edges may go out"


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_what_a_surface_has_is_never_refused(data):
    """Every goal is read off one surface, with or without slack: together they have it for an answer."""
    problem = roof(held=data.draw(st.booleans()))
    rng = np.random.default_rng(data.draw(st.integers(0, 2**31)))
    V = problem.vertices.copy()
    free = problem.roles != FIXED
    V[free, 2] = rng.uniform(-1.0, 2.0) + rng.uniform(0.1, 1.5) * rng.normal(size=free.sum())
    inner = problem.roles == INTERNAL
    V[inner, :2] += rng.uniform(-0.2, 0.2, size=(int(inner.sum()), 2))
    V[~free, 2] = rng.choice([0.0, rng.uniform(-1, 1)])
    problem = replace(problem, vertices=np.where(free[:, None], problem.vertices, V))
    slack = data.draw(st.sampled_from([0.0, 0.3]))
    z, base = V[:, 2], float(V[~free, 2].mean())
    some = np.sort(rng.choice(np.flatnonzero(free), 5, replace=False)).tolist()
    over = np.flatnonzero((np.abs(problem.vertices[:, :2] - 4.0) < 3.1).all(axis=1))
    path = [int(k) for k in rng.permutation(len(z))[:4]]
    level = float(rng.uniform(-3.0, 0.0))
    content = measures.volume(V, problem.faces, level)
    goals = [
        Above(float(z[free].min()) - slack),
        Below(float(z[free].max()) + slack),
        Above(float(z[some].min()) - slack, some),
        Below(float(z[some].max()) + slack, some),
        Height(some[:1], float(z[some[0]])),
        Clearance((1.5, 1.5, 6.5, 6.5), float(z[over].min()) - slack - 1e-9),
        NearPlane((0, 0, 0), (0, 0, 1), float(np.abs(z[free]).max()) + slack),
        NearPlane((4, 4, 0), (1, 0, 0), 4.3),
        Within(box(-0.3, -0.3, 8.3, 8.3)),
        Within(box(0.0, 0.0, 8.0, 8.0), np.flatnonzero(boundary_vertices(V, problem.faces) & free).tolist() or some),
        Area(measures.area(V, problem.faces)),
        Length(path, measures.length(V, np.asarray(path)) + slack),
    ]
    if z.max() - base > 0.1:
        goals += [Rise(float(z.max()) - base), Height("crown", float(z.max()))]
    if base - z.min() > 0.1:
        goals.append(Rise(float(z.min()) - base))
    if content > 1.0:
        goals.append(Volume(content, level))
    if (problem.roles == FREE).any():
        goals.append(EdgeInPlan())
    chosen = data.draw(st.lists(st.sampled_from(range(len(goals))), min_size=2, max_size=7, unique=True))
    assert goal_problems(problem.with_goals([goals[k] for k in chosen])) == []
