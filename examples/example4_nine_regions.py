"""Example 4: nine regions between creases, with the strategies S1 and S2."""

from compas_cgc import solve
from compas_cgc.paper.examples import example4

for name, options in {"S1, s = 0.8": {"s": 0.8}, "S1, s = 0.5": {"s": 0.5}, "S2, e = 5": {"s": 1.0, "e": 5}}.items():
    mesh, settings = example4(centre=4.0, around=1.0, **options)
    result = solve(mesh, settings=settings)
    crease = max(result.mesh.vertex_coordinates(v)[2] for v in result.mesh.vertices_where_role("crease"))
    print(f"{name}: {result.message}; highest crease point {crease:.4f}")
