#! python 3
# venv: compas_cgc
"""Read the output of compas-cgc study: the surface of a variant, its row of the table, and the best variants.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.study import study


class Study(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, path: str, number: int, column: str):
        out = study(ghenv.Component, path, number, column)  # noqa: F821
        return out.mesh, out.cgc_mesh, out.row, out.columns, out.values, out.front
