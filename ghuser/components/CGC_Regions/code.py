#! python 3
# venv: compas_cgc
"""Split a CGC mesh into region meshes, creases, open edges and supports.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.regions import regions


class Regions(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, cgc_mesh):
        out = regions(ghenv.Component, cgc_mesh)  # noqa: F821
        return out.regions, out.creases, out.edges, out.supports, out.targets, out.by_region, out.borders, out.points
