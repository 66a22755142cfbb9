"""Draw the pictures of the README and of these pages."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from compas_cgc import solve
from compas_cgc.examples import example4
from compas_cgc.plot import hero
from compas_cgc.plot import save
from compas_cgc.problem import CGCProblem

mesh, settings = example4(centre=4.0, around=1.0)
roof = solve(mesh, settings=settings).mesh
problem = CGCProblem.from_mesh(roof)
index = {key: i for i, key in enumerate(roof.vertices())}
creases = np.array([[index[u], index[v]] for u, v in roof.crease_edges()])
figure = hero(problem.vertices, problem.faces, problem.roles, creases)
save(figure, Path(__file__).parent / "images" / "nine_regions.png")
