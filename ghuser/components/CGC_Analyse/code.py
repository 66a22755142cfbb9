#! python 3
# venv: compas_cgc
"""Measure curvatures at the vertices and show them as colours.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.analyse import analyse


class Analyse(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, cgc_mesh, show: str, aside: float):
        out = analyse(ghenv.Component, cgc_mesh, show, aside)  # noqa: F821
        return out.mesh, out.K, out.H, out.k_max, out.k_min, out.error, out.colours, out.legend, out.report
