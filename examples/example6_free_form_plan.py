"""Example 6: a dome of K = 0.03 over a free-form plan."""

from compas_cgc import solve
from compas_cgc.paper.examples import example6

mesh, settings = example6()
result = solve(mesh, settings=settings)
print(f"{result.message}; relative to the target {result.max_error / 0.03:.1e}")
