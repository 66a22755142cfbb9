"""Drawings of the manual, used by the gallery and the sample files."""

from __future__ import annotations

import numpy as np

from compas_cgc import CGCMesh


def nine_regions(cells: int = 36, K: float = 0.01, centre: float = 0.04) -> CGCMesh:
    """A roof on four corners: nine regions between creases, four times the curvature in the centre."""
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=cells)
    mesh.set_supports("corners")
    row = cells + 1
    for k in (cells // 3, 2 * cells // 3):
        mesh.set_creases([[k * row + j for j in range(row)], [i * row + k for i in range(row)]], add=True)
    mesh.set_target(K)
    mesh.set_target(centre, region=4)
    return mesh


def vault(cells: int = 32) -> CGCMesh:
    """A vault between two arches that unrolls flat: K = 0."""
    mesh = CGCMesh.from_meshgrid(dx=8.0, nx=cells, dy=6.0, ny=3 * cells // 4)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", (3.0 - 0.2 * y) * (1.0 - (x / 4.0 - 1.0) ** 2))
    mesh.set_supports([vertex for vertex in mesh.vertices() if mesh.vertex_attribute(vertex, "y") in (0.0, 6.0)])
    mesh.set_target(0.0)
    return mesh


def canopy(cells: int = 28) -> CGCMesh:
    """A canopy on two high and two low masts for straight laths: K = -0.02."""
    mesh = CGCMesh.from_meshgrid(dx=10.0, nx=cells)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attribute(vertex, "z", 2.0 + 0.3 * (x + y) - 0.06 * x * y)
    mesh.set_supports("corners")
    mesh.set_target(-0.02)
    return mesh


def facade(cells: int = 36, K: float = 0.005) -> CGCMesh:
    """Three bays of a facade that bulge outwards between creases; one mould serves all panels."""
    high = 2 * cells // 3
    mesh = CGCMesh.from_meshgrid(dx=12.0, nx=cells, dy=8.0, ny=high)
    mesh.set_supports("boundary")
    mesh.set_creases([[(high + 1) * i + j for j in range(high + 1)] for i in (cells // 3, 2 * cells // 3)])
    mesh.set_target(K)
    for vertex in mesh.vertices():
        x, y, _ = mesh.vertex_coordinates(vertex)
        mesh.vertex_attributes(vertex, "xyz", [x, 0.0, y])
    return mesh


def cushion(cells: int = 36) -> CGCMesh:
    """A cushion over a rectangle with a rise of 0.8 m and unknown K."""
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=cells, dy=4.0, ny=2 * cells // 3)
    mesh.set_supports("boundary")
    return mesh


def oculus() -> CGCMesh:
    """A dome with a round opening whose ring stays level."""
    t, around = np.linspace(1, 0, 15)[:, None], np.linspace(0, 2 * np.pi, 84, endpoint=False)
    x, y = ((1.2 + 4 * t) * f(around) for f in (np.cos, np.sin))
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    quads = [[r * 84 + k, r * 84 + (k + 1) % 84, (r + 1) * 84 + (k + 1) % 84, (r + 1) * 84 + k] for r in range(14) for k in range(84)]
    mesh = CGCMesh.from_vertices_and_faces(points.tolist(), quads)
    mesh.set_supports(range(84))
    mesh.set_target(0.03)
    return mesh


def strips() -> CGCMesh:
    """A long roof of five bays between creases, with K alternately above and below zero."""
    mesh = CGCMesh.from_meshgrid(dx=20.0, nx=50, dy=8.0, ny=20)
    mesh.set_supports([21 * i + j for i in (0, 10, 20, 30, 40, 50) for j in (0, 20)])
    mesh.set_creases([[21 * i + j for j in range(21)] for i in (10, 20, 30, 40)])
    for region in range(5):
        mesh.set_target((0.012, -0.012)[region % 2], region=region)
    return mesh


def soap_film() -> CGCMesh:
    """A soap film over a round hall whose rim rises and falls: H = 0."""
    mesh = CGCMesh.from_meshgrid(dx=2.0, nx=24)
    for vertex in mesh.vertices():
        x, y = (value - 1.0 for value in mesh.vertex_attributes(vertex, "xy"))
        x, y = 9.0 * x * np.sqrt(1.0 - y**2 / 2.0), 9.0 * y * np.sqrt(1.0 - x**2 / 2.0)
        mesh.vertex_attributes(vertex, "xyz", [x, y, 0.03 * (x**2 - y**2)])
    mesh.set_supports("boundary")
    mesh.set_law("minimal")
    return mesh


def air_cushions() -> CGCMesh:
    """Six pneumatic cushions between ribs, with one pressure and one tension: H = 0.45."""
    mesh = CGCMesh.from_meshgrid(dx=9.0, nx=36, dy=6.0, ny=24)
    ribs = [[25 * i + j for j in range(25)] for i in (12, 24)] + [[25 * i + 12 for i in range(37)]]
    mesh.set_creases(ribs)
    mesh.set_supports([*mesh.vertices_on_boundary(), *sum(ribs, [])])
    mesh.set_law("H = 0.45")
    return mesh


def inner_layer() -> CGCMesh:
    """The inner layer of a shell, 0.4 m below a surface of K = 0.005."""
    K, below = 0.005, 0.4
    mesh = CGCMesh.from_meshgrid(dx=15.0, nx=24)
    mesh.set_supports("corners")
    mesh.set_law(f"{-2 * K * below} H + {1 - K * below**2} K = {K}")
    return mesh


def samples() -> dict[str, CGCMesh]:
    """Return the drawings of the tutorials that come with the package, by name."""
    found = {"vault": vault(16), "canopy": canopy(16), "facade": facade(24, K=0.01), "cushion": cushion(18)}
    found["cushion"].set_target(0.02)
    for name, mesh in found.items():
        mesh.name, mesh.attributes["units"] = name, "Meters"
    return found
