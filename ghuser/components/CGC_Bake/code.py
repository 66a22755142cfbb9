#! python 3
# venv: compas_cgc
"""Bake a surface, its regions, creases and supports on layers, with names and user text.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.bake import bake as bake_mesh


class Bake(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, cgc_mesh: Grasshopper.DataTree[object], layer: Grasshopper.DataTree[str], bake: bool):
        out = bake_mesh(ghenv.Component, cgc_mesh, layer, bake)  # noqa: F821
        return out.baked
