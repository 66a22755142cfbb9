#! python 3
# venv: compas_cgc
"""Convergence of a solve, step by step, for a graph.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.history import history


class History(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, result):
        out = history(ghenv.Component, result)  # noqa: F821
        return out.step, out.energy, out.error_norm, out.max_error, out.step_length
