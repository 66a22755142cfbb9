#! python 3
# venv: compas_cgc
"""Versions of the package, of Python and of the dependencies.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.info import info


class Info(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self):
        out = info(ghenv.Component)  # noqa: F821
        return out.info
