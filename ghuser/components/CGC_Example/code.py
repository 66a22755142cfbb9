#! python 3
# venv: compas_cgc
"""An example of the paper, with its settings.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.example import example


class Example(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, number: int, variant: str):
        out = example(ghenv.Component, number, variant)  # noqa: F821
        return out.mesh, out.cgc_mesh, out.settings, out.title
