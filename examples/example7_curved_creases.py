"""Example 7: eight sectors between straight and curved creases, K = 0.05 and K = 0."""

from compas_cgc import solve
from compas_cgc.paper.examples import example7

for target in (0.05, 0.0):
    mesh, settings = example7(target)
    result = solve(mesh, settings=settings)
    print(f"K = {target}: {result.message}")
