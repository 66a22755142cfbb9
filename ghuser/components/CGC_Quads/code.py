#! python 3
# venv: compas_cgc
"""Cover surfaces with K > 0 or constant H by plane quads along lines of curvature, with beams along their sides.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.quads import quads


class Quads(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, cgc_mesh, spacing: float, depth: float, path: str, write: bool):
        out = quads(ghenv.Component, cgc_mesh, spacing, depth, path, write)  # noqa: F821
        return out.faces, out.beams, out.nodes, out.axes, out.irregular, out.planarity, out.twist, out.report
