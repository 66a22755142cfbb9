"""Example 2: a square with a fixed boundary becomes a dome of K = 1."""

from compas_cgc import solve
from compas_cgc.paper.examples import example2

mesh, settings = example2()
result = solve(mesh, settings=settings)
print(result.message)
print(f"highest point {max(result.mesh.vertices_attribute('z')):.4f}")
