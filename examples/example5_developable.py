"""Example 5: a waisted ring becomes a developable cone, K = 0."""

from compas_cgc import solve
from compas_cgc.paper.examples import example5

mesh, settings = example5()
result = solve(mesh, settings=settings)
print(result.message)
