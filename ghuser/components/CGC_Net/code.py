#! python 3
# venv: compas_cgc
"""Trace construction curves: lines of curvature where K > 0, an asymptotic net of equal sides where K < 0, rulings where K = 0.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.net import net


class Net(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, cgc_mesh, spacing: float, through, kind: str):
        out = net(ghenv.Component, cgc_mesh, spacing, through, kind)  # noqa: F821
        return out.first, out.second, out.nodes, out.sides, out.report
