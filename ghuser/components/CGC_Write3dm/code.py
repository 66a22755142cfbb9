#! python 3
# venv: compas_cgc
"""Write a CGC mesh with supports, creases, targets and goals as a .3dm file, in double precision.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.files import write_3dm


class Write3dm(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, path: Grasshopper.DataTree[str], cgc_mesh: Grasshopper.DataTree[object], write: bool):
        out = write_3dm(ghenv.Component, path, cgc_mesh, write)  # noqa: F821
        return out.written
