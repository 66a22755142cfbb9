#! python 3
# venv: compas_cgc
"""Find the surface whose Gaussian curvature is the target in every region, without blocking the canvas.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System

from compas_cgc.grasshopper.components.solve import solve


class Solve(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(
        self, cgc_mesh, settings, goals: System.Collections.Generic.List[object], run: bool, reset: bool, server, show: str, wait: bool
    ):
        out = solve(ghenv.Component, cgc_mesh, settings, goals, run, reset, server, show, wait)  # noqa: F821
        return out.mesh, out.cgc_mesh, out.status, out.progress, out.report, out.result, out.colours, out.legend
