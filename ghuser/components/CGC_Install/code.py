#! python 3
# venv: compas_cgc
# r: compas_cgc=={{version}}
"""Install the Python package that all components of this tab use, into its own environment.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.install import install


class Install(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self):
        out = install(ghenv.Component)  # noqa: F821
        return out.info
