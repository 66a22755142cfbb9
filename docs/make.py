"""Make the page and the pictures of these documents that are computed."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np

from compas_cgc.atomic import write_text
from compas_cgc.cli import main
from compas_cgc.examples import example4
from compas_cgc.plot import hero
from compas_cgc.plot import save
from compas_cgc.problem import CGCProblem
from compas_cgc.solver import solve

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
    result = solve(mesh, settings=settings).mesh
    problem = CGCProblem.from_mesh(result)
    index = {key: i for i, key in enumerate(result.vertices())}
    creases = np.array([[index[u], index[v]] for u, v in result.crease_edges()])
    save(hero(problem.vertices, problem.faces, problem.roles, creases), DOCS / "images" / "nine_regions.png")


if __name__ == "__main__":
    reproduction()
    roof()
