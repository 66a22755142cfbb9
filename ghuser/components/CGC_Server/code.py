#! python 3
# venv: compas_cgc
"""Find or start the compute server, so that a solve runs outside Rhino.

COMPAS CGC {{version}}
"""

import Grasshopper
import Rhino  # noqa: F401
import System  # noqa: F401

from compas_cgc.grasshopper.components.server import server


class Server(Grasshopper.Kernel.GH_ScriptInstance):
    def RunScript(self, run: bool, url: str, key: str, python: str):
        out = server(ghenv.Component, run, url, key, python)  # noqa: F821
        return out.server, out.url, out.status
