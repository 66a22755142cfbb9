#! python 3
# venv: compas_cgc
"""Read a mesh with supports, creases, targets and goals from a .3dm file, in double precision.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.files import read_3dm


class Read3dm(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, path: str, split: bool):
        out = read_3dm(ghenv.Component, path, split)  # noqa: F821
        return out.mesh, out.cgc_mesh, out.notes
