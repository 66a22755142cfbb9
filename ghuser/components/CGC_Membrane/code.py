#! python 3
# venv: compas_cgc
"""Compute the membrane forces of a surface of constant K under pressure and self-weight.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.membrane import membrane


class Membrane(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, cgc_mesh, pressure: float, weight: float, path: str, write: bool):
        out = membrane(ghenv.Component, cgc_mesh, pressure, weight, path, write)  # noqa: F821
        return out.mesh, out.N1, out.N2, out.tension, out.compression, out.reactions, out.line_loads, out.report
