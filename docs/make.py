"""Create computed pictures and tables of the manual: ``python docs/make.py``, or with names of parts, such as ``samples``."""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import drawings
import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from scipy.spatial import Delaunay

from compas_cgc import Above
from compas_cgc import CGCMesh
from compas_cgc import EdgeInPlan
from compas_cgc import Rise
from compas_cgc import fabrication
from compas_cgc import get
from compas_cgc import read
from compas_cgc import write
from compas_cgc._atomic_write import write_text
from compas_cgc.cli import main
from compas_cgc.model.problem import CGCProblem
from compas_cgc.plot import View
from compas_cgc.plot import draw_shape
from compas_cgc.plot import draw_zebra
from compas_cgc.plot import key_of
from compas_cgc.plot import moulds_figure
from compas_cgc.plot import save
from compas_cgc.plot import studio
from compas_cgc.rationalisation import panels_figure
from compas_cgc.solvers.run import solve

DOCS = Path(__file__).parent

PICTURES = {
    "example1_c1": "Example 1, C1: arrows show the last gradient; the longest has the same length in all pictures",
    "example2_nofilter_shape": "Example 2 without a filter, shortly before it diverges (the paper's Fig. 10)",
    "example2_history": "Example 2, iteration history (the paper's Fig. 9)",
    "example4_comparison": "Example 4 by four strategies (the paper's Fig. 18)",
    "example5_error": "Example 5, error of K at the start and after 500 steps (the paper's Fig. 22)",
    "example6_shape": "Example 6 (the paper's Figs. 23 and 24)",
    "example7_comparison": "Example 7 for both targets (the paper's Fig. 28)",
}


def put_table(page: Path, rows: list[str]) -> None:
    """Replace the table between the two marks of a page."""
    before, _, rest = page.read_text(encoding="utf-8").partition("<!-- table -->\n")
    write_text(page, before + "<!-- table -->\n" + "\n".join(rows) + "\n<!-- end -->" + rest.partition("<!-- end -->")[2])


def freeform() -> None:
    """Draw the panels of the tutorial on freeform designs, with its own code."""
    code = re.findall(r"```python\n(.*?)```", (DOCS / "tutorials" / "freeform.md").read_text(encoding="utf-8"), re.DOTALL)[:2]
    names: dict[str, Any] = {}
    exec("\n".join(code), names)
    save(panels_figure(names["found"]), DOCS / "images" / "freeform.png")


def reproduction() -> None:
    """Write the page of the paper's examples."""
    with tempfile.TemporaryDirectory() as folder:
        main(["reproduce", "--out", folder])
        page = (Path(folder) / "tables.md").read_text(encoding="utf-8") + "\n## Pictures\n"
        for name, caption in PICTURES.items():
            shutil.copyfile(Path(folder) / f"{name}.png", DOCS / "images" / f"{name}.png")
            page += f"\n![{caption}](images/{name}.png)\n\n{caption}\n"
    write_text(DOCS / "reproduction.md", page)


def moulds() -> None:
    """Draw panels and moulds of nine regions."""
    problem = solve(drawings.nine_regions(K=0.01, centre=-0.01), method="projection", settings={"measure": "exact"}).problem
    figure = moulds_figure(
        problem,
        fabrication.moulds(problem, fabrication.panels(problem, 1.25), material="gfrp", thickness=8),
        "Panels of nine regions and their moulds",
    )
    figure.set_dpi(110)
    save(figure, DOCS / "images" / "moulds.png")


def _domes() -> dict[str, tuple[Any, float]]:
    """Return the domes of the table of plane quads, solved, and the spacings of their lines."""
    x, y = (CGCMesh.from_meshgrid(dx=2.0, nx=30).to_problem().vertices[:, :2] - 1.0).T
    oval = CGCMesh.from_meshgrid(dx=2.0, nx=30).to_problem()
    plan = np.column_stack([9.0 * x * np.sqrt(1.0 - y**2 / 2.0), 6.0 * y * np.sqrt(1.0 - x**2 / 2.0), 0.0 * x])
    corners = CGCMesh.from_meshgrid(dx=15.0, nx=36)
    corners.set_supports("corners")
    corners.set_target(0.01)
    return {
        "cushion sample, 6 x 4 m": (solve(read(get("cushion.3dm"))), 0.6),
        "oval, 18 x 12 m, K = 0.008": (solve(oval.with_vertices(plan).with_supports("boundary").with_targets(0.008)), 1.2),
        "15 m on four points, K = 0.01": (solve(corners), 1.2),
    }


def quads() -> None:
    """Draw plane quads on three domes, and print the rows of their table."""
    figure = Figure(figsize=(10, 3.6), dpi=110)
    for place, (name, (surface, spacing)) in enumerate(_domes().items()):
        own = fabrication.plane_quads(surface, spacing)
        mm = 1e3
        off, twist = mm * own.off, mm * own.twist
        print(
            f"| {name} | {spacing:g} m | {len(own.faces)} | {mm * own.planarity.max():.1g} mm | {np.median(off):.2g}, {off.max():.2g} mm "
            f"| {np.median(twist):.2g}, {twist.max():.2g} mm |"
        )
        ax: Any = figure.add_subplot(1, 3, place + 1, projection="3d", proj_type="ortho")
        ax.add_collection3d(Poly3DCollection([own.vertices[face] for face in own.faces], facecolor="#a9c4e4", edgecolor="#333333", lw=0.6))
        ax.scatter(*own.vertices[own.irregular].T, color="#c03020", s=14, depthshade=False)
        low, high = own.vertices.min(axis=0), own.vertices.max(axis=0)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        ax.set_box_aspect(high - low, zoom=1.05)
        ax.view_init(50, -65)
        ax.set_axis_off()
        ax.set_title(name, fontsize=9)
    save(figure, DOCS / "images" / "quads.png")


def convention() -> None:
    """Draw the meaning of the layers of a Rhino file."""
    mesh = CGCMesh.from_3dm(DOCS.parent / "examples" / "nine_regions.3dm")
    problem = mesh.to_problem()
    figure = Figure(figsize=(8, 4.6), dpi=160)
    ax = figure.add_axes((0.02, 0.03, 0.56, 0.94))
    draw_shape(problem.vertices, problem.faces, problem.roles, problem.creases, view="plan", ax=ax)
    for region in range(9):
        x, y, _ = np.mean([mesh.face_centroid(face) for face in mesh.regions()[region]], axis=0)
        dot = dict(boxstyle="round", facecolor="#f4d35e", edgecolor="none")
        ax.text(x, y, "K=0.04" if region == 4 else "K=0.01", ha="center", va="center", fontsize=8, bbox=dot)
    lines = {
        "CGC::Mesh": "one mesh, or several that are joined",
        "CGC::Supports": "points, point clouds, curves: supports (red)",
        "CGC::Creases": "curves: creases (thick)",
        "CGC::Targets": "text dots: K of the region (yellow)",
        "CGC::Constraints": "curves to stay on, points at heights",
    }
    for row, (layer, meaning) in enumerate(lines.items()):
        figure.text(0.61, 0.84 - 0.16 * row, layer, fontsize=11, weight="bold", family="monospace")
        figure.text(0.61, 0.79 - 0.16 * row, meaning, fontsize=8.5)
    save(figure, DOCS / "images" / "layers.png")


def _square(n: int, width: float, height: Callable = lambda x, y: 0.0 * x) -> CGCProblem:
    problem = CGCMesh.from_meshgrid(dx=width, nx=n).to_problem()
    vertices = problem.vertices.copy()
    vertices[:, 2] = height(*(vertices[:, :2] / width).T)
    return problem.with_vertices(vertices)


def _irregular(n: int) -> CGCProblem:
    """Return a disc with n random inner vertices, supported at four points of its boundary."""
    rng = np.random.default_rng(5)
    turn = 2 * np.pi * np.arange(60) / 60
    rim = np.column_stack([np.cos(turn), np.sin(turn)])
    inner = rng.uniform(-1, 1, (4 * n, 2))
    kept: list[np.ndarray] = []
    for point in inner[np.hypot(*inner.T) < 0.93]:
        if all(np.hypot(*(point - other)) > 1.5 / np.sqrt(n) for other in kept):
            kept.append(point)
    plan = np.vstack([rim, kept])
    faces = Delaunay(plan).simplices
    a, b = plan[faces[:, 1]] - plan[faces[:, 0]], plan[faces[:, 2]] - plan[faces[:, 0]]
    faces = np.where((a[:, 0] * b[:, 1] < a[:, 1] * b[:, 0])[:, None], faces[:, ::-1], faces)
    return CGCProblem(np.column_stack([plan, np.zeros(len(plan))]), faces).with_supports(range(0, 60, 15))


def _pseudosphere(n: int) -> CGCProblem:
    """Return a wavy patch of Beltrami's pseudosphere, supported all around."""
    problem = _square(n, 1.0)
    x, y = problem.vertices[:, :2].T
    turn, fine = 2.5 * (x - 0.5), np.linspace(0.3, 1.3, 2001)
    rise = np.concatenate([[0.0], np.cumsum(np.sqrt(1.0 - np.exp(-fine[1:] - fine[:-1])) * np.diff(fine))])
    radius, height = np.exp(-0.3 - y), np.interp(0.3 + y, fine, rise)
    wave = 1.0 + 0.05 * np.sin(3 * np.pi * x) * np.sin(3 * np.pi * y)
    vertices = np.column_stack([wave * radius * np.sin(turn), -wave * radius * np.cos(turn), height])
    return CGCProblem(vertices, problem.faces).with_supports("boundary").with_targets(-1.0)


def hard_cases() -> dict[str, tuple[CGCProblem, dict, str]]:
    """Return problems, the settings of the compared solves, and titles."""
    nearest = {"keep": "shape", "nearness": 1e3, "measure": "defect"}
    canopy = _square(20, 10.0, lambda x, y: 3 * (x + y - 2 * x * y)).with_supports("corners").with_targets(-0.02)
    corners = _square(20, 1.0).with_supports("corners").with_targets(-3.0)
    arches = _square(20, 1.0, lambda x, y: 1.2 * x * (1 - x) - 0.6 * y * (1 - y))
    x = arches.vertices[:, 1]
    vault = arches.with_supports(np.flatnonzero((x < 1e-9) | (x > 1 - 1e-9))).with_targets(0.0)
    nine = CGCMesh.from_3dm(DOCS.parent / "examples" / "nine_regions.3dm").to_problem().with_targets(-0.01)
    return {
        "canopy": (canopy, nearest, "A canopy of 10 m on masts of 0 and 3 m, K = -0.02"),
        "corners": (corners, nearest, "A square on its corners, K = -3, flat input"),
        "vault": (vault, nearest, "A vault between two arches, K = 0, sagging input"),
        "nine": (nine, nearest, "Nine regions on four corners, K = -0.01"),
        "held": (_pseudosphere(24), nearest, "A pseudosphere, K = -1, supported all around, wavy input"),
        "irregular": (_irregular(420).with_targets(-0.4), {"measure": "defect"}, "An irregular mesh on four supports, K = -0.4"),
    }


def fairness() -> None:
    """Write the table of fair surfaces, and draw both surfaces of each pair with stripes."""
    rows = ["| | error of fitted K, median / 90 % | waviness | sharpest fold | verdict |", "| --- |" + " --- |" * 4]
    for name, (problem, other, title) in hard_cases().items():
        results = [solve(problem, method="projection", settings=other), solve(problem)]
        figure = Figure(figsize=(8, 3.4), dpi=140)
        for k, result in enumerate(results):
            ax = figure.add_axes((0.01 + 0.5 * k, 0.02, 0.48, 0.96))
            draw_zebra(result.vertices, result.faces, result.problem.roles, result.problem.creases, view=View(-60.0, 40.0), ax=ax)
            v = result.verdict
            fit = f"{100 * v.fit_median:.2g} / {100 * v.fit_most:.2g} %"
            rows.append(f"| {title if not k else ''} | {fit} | {100 * v.waviness:.2g} % | {v.sharpest_fold:.0f}° | {v.word} |")
        save(figure, DOCS / "images" / f"fair_{name}.png")
    put_table(DOCS / "fairness.md", rows)


RISES = (1.0, 2.0, 3.0, 4.0)  # for a span of 15


def plans() -> dict[str, CGCProblem]:
    """Return plans with a span of 15, without targets."""
    square = CGCMesh.from_meshgrid(dx=15.0, nx=24).to_problem()
    x, y, _ = (2.0 * square.vertices / 15.0 - 1.0).T
    # Map the square to the disk, ring by ring.
    ring, radius = np.maximum(abs(x), abs(y)), np.hypot(x, y)
    stretch = 7.5 * ring / np.where(radius > 0.0, radius, 1.0)
    disk = square.with_vertices(np.column_stack([stretch * x, stretch * y, 0.0 * x]))
    strip = CGCMesh.from_meshgrid(dx=45.0, nx=54, dy=15.0, ny=18).to_problem()
    return {
        "circle, edge fixed": disk.with_supports("boundary"),
        "square, edge fixed": square.with_supports("boundary"),
        "strip of 15 by 45, edge fixed": strip.with_supports("boundary"),
        "square, on its corners": square.with_supports([0, 24, 600, 624]),
    }


def court(high: list) -> CGCMesh:
    """Return an L with a crease along its mitre on nine columns; outward corners are at 3 m, other columns at 3.6 m."""
    plan = [[0, 0, 0], [14, 0, 0], [14, 6, 0], [6, 6, 0], [6, 14, 0], [0, 14, 0], [0, 0, 0]]
    heads = [*((*place, 3.0) for place in ((0, 0), (14, 0), (14, 6), (6, 14), (0, 14))), *((*place, 3.6) for place in high)]
    mesh = CGCMesh.from_outline(plan, 1.0, creases=[[[0, 0, 0], [6, 6, 0]]], points=heads)
    columns = mesh.vertices_near([head[:2] for head in heads])
    for column, (*_, z) in zip(columns, heads):
        mesh.vertex_attribute(column, "z", z)
    mesh.set_supports(columns)
    mesh.set_target(0.004)
    return mesh


def courts() -> None:
    """Draw two roofs over a court."""
    figure = Figure(figsize=(9, 3.2), dpi=130)
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.9, wspace=0.0)
    layouts = [[(14, 3), (3, 14), (10, 6), (6, 10)], [(7, 0), (0, 7), (10, 6), (6, 10)]]
    for place, high in enumerate(layouts):
        found = solve(court(high), goals=[EdgeInPlan(), Above(2.7)])
        ax = figure.add_subplot(1, 2, place + 1)
        draw_shape(found.vertices, found.faces, found.problem.roles, found.problem.creases, ax=ax)
        ax.set_title(f"3.6 at {', '.join(map(str, high))}; {found.verdict.word}", fontsize=8)
    save(figure, DOCS / "images" / "court.png")


def goals() -> None:
    """Write the table of K for rises, and draw the surfaces."""
    rows = ["| plan | " + " | ".join(f"rise {rise:g}" for rise in RISES) + " |", "| --- |" + " --- |" * len(RISES)]
    figure = Figure(figsize=(11, 2.6), dpi=130)
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.85, wspace=0.0)
    for place, (name, problem) in enumerate(plans().items()):
        found = [solve(problem, goals=[Rise(rise)], unknown="all") for rise in RISES]
        rows.append(f"| {name} | " + " | ".join(f"{15**2 * result.problem.region_targets()[0]:.3f}" for result in found) + " |")
        ax = figure.add_subplot(1, 4, place + 1)
        draw_shape(found[2].vertices, found[2].faces, found[2].problem.roles, found[2].problem.creases, ax=ax)
        ax.set_title(f"{name}\nK = {found[2].problem.region_targets()[0]:.4f}", fontsize=8)
    save(figure, DOCS / "images" / "goals.png")
    put_table(DOCS / "goals.md", rows)


def laws() -> None:
    """Draw the roof with several laws, with the code of its page."""
    code = re.findall(r"```python\n(.*?)```", (DOCS / "laws.md").read_text(encoding="utf-8"), re.DOTALL)[0]
    names: dict[str, Any] = {}
    exec(code, names)
    solved = names["result"].problem
    save(
        studio(*(solved.vertices, solved.faces, solved.roles, solved.creases), view=View(-62.0, 24.0, 2.4), width=1200, key=key_of(solved)),
        DOCS / "images" / "laws.png",
    )


def samples() -> None:
    """Write the sample drawings into the package."""
    for name, mesh in drawings.samples().items():
        write(DOCS.parent / "compas_cgc" / "_sample_files" / f"{name}.3dm", mesh)


PARTS = (fairness, convention, moulds, quads, goals, laws, courts, freeform, reproduction)

if __name__ == "__main__":
    for part in [*map(globals().get, sys.argv[1:])] or PARTS:
        part()
