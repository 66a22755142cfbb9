"""Make the page and the pictures of these documents that are computed."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from compas_cgc import CGCMesh
from compas_cgc._atomic_write import write_text
from compas_cgc.cli import main
from compas_cgc.paper.examples import example4
from compas_cgc.plot import draw_shape
from compas_cgc.plot import hero
from compas_cgc.plot import save
from compas_cgc.solvers.run import solve

DOCS = Path(__file__).parent

PICTURES = {
    "example1_c1": "Example 1, C1: arrows are the last gradient, scaled to one length",
    "example2_nofilter_shape": "Example 2 without a filter, shortly before it diverges (the paper's Fig. 10)",
    "example2_history": "Example 2, iteration history (the paper's Fig. 9)",
    "example4_comparison": "Example 4 by four strategies (the paper's Fig. 18)",
    "example5_error": "Example 5, error of K at the start and after 500 steps (the paper's Fig. 22)",
    "example6_shape": "Example 6 (the paper's Figs. 23 and 24)",
    "example7_comparison": "Example 7 for both targets (the paper's Fig. 28)",
}


def reproduction() -> None:
    """Write the page of all tables with some of the pictures."""
    with tempfile.TemporaryDirectory() as folder:
        main(["reproduce", "--out", folder])
        page = (Path(folder) / "tables.md").read_text(encoding="utf-8") + "\n## Pictures\n"
        for name, caption in PICTURES.items():
            shutil.copyfile(Path(folder) / f"{name}.png", DOCS / "images" / f"{name}.png")
            page += f"\n![{caption}](images/{name}.png)\n\n{caption}\n"
    write_text(DOCS / "reproduction.md", page)


def roof() -> None:
    """Draw the picture of the README."""
    mesh, settings = example4(centre=4.0, around=1.0)
    problem = solve(mesh, settings=settings).problem
    save(hero(problem.vertices, problem.faces, problem.roles, problem.creases), DOCS / "images" / "nine_regions.png")


def convention() -> None:
    """Draw which layer of a Rhino file means what."""
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
        "CGC::Mesh": "one mesh, or several to be joined",
        "CGC::Supports": "points, point clouds, curves: what stays (red)",
        "CGC::Creases": "curves: where it may fold (thick)",
        "CGC::Targets": "text dots: K of the region (yellow)",
        "CGC::Constraints": "curves to stay on, points to reach",
    }
    for row, (layer, meaning) in enumerate(lines.items()):
        figure.text(0.61, 0.84 - 0.16 * row, layer, fontsize=11, weight="bold", family="monospace")
        figure.text(0.61, 0.79 - 0.16 * row, meaning, fontsize=8.5)
    save(figure, DOCS / "images" / "layers.png")


if __name__ == "__main__":
    convention()
    reproduction()
    roof()
