"""Make the drawings of the tutorials, which come with the package: a vault, a canopy, a facade and a cushion."""

from __future__ import annotations

import sys
from pathlib import Path

from compas_cgc import CGCMesh
from compas_cgc import write

FOLDER = Path(__file__).parents[1] / "compas_cgc" / "_sample_files"


def vault() -> CGCMesh:
    """Two arches, the one behind lower, to be spanned by a surface that unrolls."""
    mesh = CGCMesh.from_meshgrid(dx=8.0, nx=16, dy=6.0, ny=12)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", (3.0 - 0.2 * y) * (1.0 - (x / 4.0 - 1.0) ** 2))
    mesh.set_supports([vertex for vertex in mesh.vertices() if mesh.vertex_attribute(vertex, "y") in (0.0, 6.0)])
    mesh.set_target(0.0)
    return mesh


def canopy() -> CGCMesh:
    """Four masts, two of them high."""
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=16)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", 2.0 + 0.3 * (x + y) - 0.06 * x * y)
    mesh.set_supports("corners")
    mesh.set_target(-0.02)
    return mesh


def facade() -> CGCMesh:
    """Three bays between mullions, upright, held around their edge."""
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=24, dy=8.0, ny=16)
    mesh.set_supports("boundary")
    mesh.set_creases([[17 * i + j for j in range(17)] for i in (8, 16)])
    mesh.set_target(0.01)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attributes(vertex, "xyz", [x, 0.0, y])
    return mesh


def cushion() -> CGCMesh:
    """A frame of 6 by 4 metres."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=18, dy=4.0, ny=12)
    mesh.set_supports("boundary")
    mesh.set_target(0.02)
    return mesh


if __name__ == "__main__":
    for make in (vault, canopy, facade, cushion):
        mesh = make()
        mesh.name, mesh.attributes["units"] = make.__name__, "Meters"
        write(Path(sys.argv[1] if len(sys.argv) > 1 else FOLDER) / f"{make.__name__}.3dm", mesh)
