"""Example 3: the same square, supported at its four corners only; dummy faces surround the free edges."""

from compas_cgc import solve
from compas_cgc.paper.examples import example3

mesh, settings = example3()
result = solve(mesh, settings=settings)
print(result.message)
print(f"{len(mesh.vertices_where_role('dummy'))} dummy vertices in, {len(result.mesh.vertices_where_role('dummy'))} out")
