"""Example 1: arches of constant curvature with and without a kink in the middle."""

from compas_cgc.paper.examples import example1
from compas_cgc.solvers.flow import curve_flow

for kind in ("C1", "C2"):
    for name, options in {"no kink": {"crease": False}, "S1, s = 0.8": {"s": 0.8}, "S2, e = 3": {"e": 3}}.items():
        points, arguments = example1(kind, **options)
        arch = curve_flow(points, **arguments)
        print(f"{kind}, {name}: height {arch.points[:, 1].max():.3f}, largest error {arch.max_error:.1e}")
