"""A field of cushions: constant mean curvature beside constant Gaussian curvature, to a prescribed rise."""

from compas_cgc import CGCMesh
from compas_cgc import Rise
from compas_cgc import sensitivity
from compas_cgc import solve

n = 18
mesh = CGCMesh.from_meshgrid(dx=18.0, nx=n)
mesh.set_supports("corners")
lines = [[(n + 1) * i + j for i in range(n + 1)] for j in (6, 12)]
mesh.set_creases(lines + [[(n + 1) * j + i for i in range(n + 1)] for j in (6, 12)])
mesh.set_target(0.004)  # one mould for the four corner panels [1/m²]
for region in (1, 3, 5, 7):
    mesh.set_target(0.0, region=region)  # plane sheets
mesh.set_law("H = 0.08", region=4)  # a pneumatic cushion [1/m]
result = solve(mesh, goals=[Rise(4.0)], unknown=[4])
print(result.message)
print(f"pressure of the cushion: {2.0 * result.problem.laws[4].constant:.4f} 1/m times its tension")
print(sensitivity(result).sentences()[4])
