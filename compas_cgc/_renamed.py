"""Old names of modules: scripts and saved canvases that use them go on working, with a warning."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Optional

__all__ = ["RENAMED", "RenamedFinder", "install"]

RENAMED = {
    "compas_cgc.atomic": "compas_cgc._atomic_write",
    "compas_cgc.benchmarks": "compas_cgc.paper.benchmarks",
    "compas_cgc.client.start": "compas_cgc.client.server_process",
    "compas_cgc.examples": "compas_cgc.paper.examples",
    "compas_cgc.files": "compas_cgc.io",
    "compas_cgc.flow": "compas_cgc.solvers.flow",
    "compas_cgc.ghpython": "compas_cgc.grasshopper",
    "compas_cgc.newton": "compas_cgc.solvers.newton",
    "compas_cgc.posing": "compas_cgc._deprecated",
    "compas_cgc.problem": "compas_cgc.model.problem",
    "compas_cgc.projection": "compas_cgc.solvers.projection",
    "compas_cgc.reproduction": "compas_cgc.paper.reproduction",
    "compas_cgc.result": "compas_cgc.model.result",
    "compas_cgc.rhino": "compas_cgc.io.rhino",
    "compas_cgc.rhino.inside": "compas_cgc.io.rhino.rhinocommon",
    "compas_cgc.server.jobs.future": "compas_cgc.execution.future",
    "compas_cgc.server.jobs.pool": "compas_cgc.execution.pool",
    "compas_cgc.server.jobs.worker": "compas_cgc.execution.worker",
    "compas_cgc.solver": "compas_cgc.solvers.run",
}
_LONGEST_FIRST = sorted(RENAMED, key=len, reverse=True)
STAYS = ("compas_cgc.flow",)  # the paper's method keeps its short name


class RenamedFinder(MetaPathFinder, Loader):
    """Finds modules by their old names."""

    def find_spec(self, name: str, path: Optional[Sequence[str]] = None, target: Optional[ModuleType] = None) -> Optional[ModuleSpec]:
        """Return how to load a module, None where its name is no old one."""
        return None if _new_name(name) is None else ModuleSpec(name, self, is_package=True)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module of the new name."""
        new = _new_name(spec.name)
        assert new is not None
        module = import_module(new)
        if not spec.name.startswith(STAYS):
            warnings.warn(f"{spec.name} is now {new}; the old name will go", DeprecationWarning, stacklevel=2)
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Give the module, which has run under its new name, its own description back."""
        if module.__spec__ is not None and module.__spec__.loader is self:
            module.__spec__ = module.__spec__.loader_state


def _new_name(name: str) -> Optional[str]:
    for old in _LONGEST_FIRST if name.startswith("compas_cgc.") else ():
        if name == old or name.startswith(f"{old}."):
            return RENAMED[old] + name[len(old) :]
    return None


def install() -> None:
    """Let Python find the old names, before it looks for files: a renamed package would find its modules twice."""
    if not any(isinstance(finder, RenamedFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, RenamedFinder())
