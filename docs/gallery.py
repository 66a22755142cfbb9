"""Surfaces of the manual: each function returns a solved surface; run this file to draw them and to write gallery.md."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Level
from compas_cgc import Rise
from compas_cgc import SolveResult
from compas_cgc import solve
from compas_cgc._atomic_write import write_text
from compas_cgc.plot import View
from compas_cgc.plot import save
from compas_cgc.plot import studio

DOCS = Path(__file__).parent


def nine_regions() -> SolveResult:
    """A roof on four corners: nine regions between creases, five times the curvature in the centre."""
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=36)
    mesh.set_supports("corners")
    for k in (12, 24):
        mesh.set_creases([[k * 37 + j for j in range(37)], [i * 37 + k for i in range(37)]], add=True)
    mesh.set_target(0.006)
    mesh.set_target(0.03, region=4)
    return solve(mesh)


def vault() -> SolveResult:
    """A vault between two arches that unrolls: K = 0."""
    mesh = CGCMesh.from_meshgrid(dx=8.0, nx=32, dy=6.0, ny=24)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", (3.0 - 0.2 * y) * (1.0 - (x / 4.0 - 1.0) ** 2))
    mesh.set_supports([vertex for vertex in mesh.vertices() if mesh.vertex_attribute(vertex, "y") in (0.0, 6.0)])
    mesh.set_target(0.0)
    return solve(mesh)


def canopy() -> SolveResult:
    """A canopy on two high and two low masts: K = -0.02, a surface of straight laths."""
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=28)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", 2.0 + 0.3 * (x + y) - 0.06 * x * y)
    mesh.set_supports("corners")
    mesh.set_target(-0.02)
    return solve(mesh)


def facade() -> SolveResult:
    """Three bays of a facade that bulge outwards between creases, all from one mould."""
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=36, dy=8.0, ny=24)
    mesh.set_supports("boundary")
    mesh.set_creases([[25 * i + j for j in range(25)] for i in (12, 24)])
    mesh.set_target(0.005)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attributes(vertex, "xyz", [x, 0.0, y])
    return solve(mesh)


def cushion() -> SolveResult:
    """A cushion over a rectangle, 0.8 m high; K is the answer."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=36, dy=4.0, ny=24)
    mesh.set_supports("boundary")
    return solve(mesh, goals=[Rise(0.8)], unknown="all")


def oculus() -> SolveResult:
    """A dome with a round opening whose ring stays level."""
    t, around = np.linspace(1, 0, 15)[:, None], np.linspace(0, 2 * np.pi, 84, endpoint=False)
    x, y = ((1.2 + 4 * t) * f(around) for f in (np.cos, np.sin))
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    quads = [[r * 84 + k, r * 84 + (k + 1) % 84, (r + 1) * 84 + (k + 1) % 84, (r + 1) * 84 + k] for r in range(14) for k in range(84)]
    mesh = CGCMesh.from_vertices_and_faces(points.tolist(), quads)
    mesh.set_supports(range(84))
    mesh.set_target(0.03)
    return solve(mesh, goals=[Level()])


def strips() -> SolveResult:
    """A long roof of five bays that fold against each other, K by turns above and below zero."""
    mesh = CGCMesh.from_meshgrid(dx=20.0, nx=50, dy=8.0, ny=20)
    mesh.set_supports([21 * i + j for i in (0, 10, 20, 30, 40, 50) for j in (0, 20)])
    mesh.set_creases([[21 * i + j for j in range(21)] for i in (10, 20, 30, 40)])
    for region in range(5):
        mesh.set_target((0.012, -0.012)[region % 2], region=region)
    return solve(mesh)


class Picture(NamedTuple):
    """A surface, how one looks at it, and whether it is coloured by K."""

    solved: Callable[[], SolveResult]
    view: View
    by_curvature: bool = False


PICTURES = {
    "nine_regions": Picture(nine_regions, View(-62.0, 24.0, 2.4)),
    "vault": Picture(vault, View(-58.0, 20.0, 2.6)),
    "canopy": Picture(canopy, View(-72.0, 20.0, 2.6)),
    "facade": Picture(facade, View(-118.0, 14.0, 2.6)),
    "cushion": Picture(cushion, View(-60.0, 24.0, 2.6)),
    "oculus": Picture(oculus, View(-60.0, 30.0, 2.6)),
    "strips": Picture(strips, View(-52.0, 26.0, 2.4), True),
}


def drawn(problem: CGCProblem, picture: Picture, width: int = 1200) -> object:
    """Return the picture of a surface, in tones by region or by the K asked for."""
    K = np.where(problem.asked, problem.targets, np.nan) if picture.by_curvature else None
    return studio(problem.vertices, problem.faces, problem.roles, problem.creases, curvature=K, view=picture.view, width=width)


PAGE = """# Gallery

Every surface here is made by the code under it, and drawn by `compas_cgc.plot.studio`. All of them are **fair** by their verdict, and meet
the curvature asked for to rounding. This page is made by `python docs/gallery.py`.

```python
import numpy as np
from compas_cgc import CGCMesh, Level, Rise, solve
```

"""


def page() -> str:
    """Return the text of the gallery."""
    text = PAGE
    for name, picture in PICTURES.items():
        lines = inspect.getsource(picture.solved).splitlines()
        title = (picture.solved.__doc__ or "").rstrip(".")
        lines[0] = f"def {name}():"
        body = "\n".join([lines[0], *lines[2:]])
        text += f"## {name.replace('_', ' ').capitalize()}\n\n{title}.\n\n![{title}](images/gallery/{name}.png)\n\n"
        text += '??? example "The code"\n\n    ```python\n' + "".join(f"    {line}\n" if line else "\n" for line in body.splitlines())
        text += "    ```\n\n"
    return text.rstrip() + "\n"


if __name__ == "__main__":
    for name in sys.argv[1:] or PICTURES:
        found = PICTURES[name].solved()
        print(name, found.message, found.verdict, flush=True)
        save(drawn(found.problem, PICTURES[name]), DOCS / "images" / "gallery" / f"{name}.png")
    write_text(DOCS / "gallery.md", page())
