"""The first solve after an installation: little is compiled, once, and nobody takes that for the solve's time."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

SOLVE = """
import json, sys
from numba.core import event

class Listener(event.Listener):
    names = []
    def on_start(self, happening):
        self.names.append(happening.data["dispatcher"].py_func.__module__)
    def on_end(self, happening):
        pass

event.register("numba:compile", Listener())
import compas_cgc
from compas_cgc._compiled import compile_seconds, watch_compilation
seen = []
with watch_compilation(seen.append):
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=15, nx=15)
    mesh.set_supports(sys.argv[1])
    mesh.set_target(0.005)
    result = compas_cgc.solve(mesh)
print(json.dumps({"status": result.status, "seconds": result.seconds, "compiling": compile_seconds(), "compiled": Listener.names,
                  "parts": [state.part for state in seen]}))
"""
# Neither the package nor the user's folder can be written to; a superuser's rights would let a test through.
READ_ONLY = """
from numba.core import caching

def refuse(self):
    raise OSError("read-only")

for name in ("InTreeCacheLocator", "UserWideCacheLocator"):
    # Newer versions of Numba have dropped the underscore.
    (getattr(caching, name, None) or getattr(caching, "_" + name)).ensure_cache_path = refuse
"""


def run(code, *words, **environment):
    """Run Python code in a process of its own and return what it prints as JSON."""
    own = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    done = subprocess.run([sys.executable, "-c", code, *words], env={**own, **environment}, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.nightly
@pytest.mark.parametrize("supports", ["boundary", "corners"])
def test_a_small_solve_compiles_little_and_only_once(tmp_path, supports):
    first = run(SOLVE, supports, NUMBA_CACHE_DIR=str(tmp_path))
    assert first["status"] == "converged"
    # Every function is a tenth of a second or more; sorting, slices and texts inside kernels would bring scores of them.
    assert len(first["compiled"]) <= 32, first["compiled"]
    assert not any("unicode" in name or "sort" in name for name in first["compiled"])
    assert "compas_cgc.linalg.ordering" not in first["compiled"]
    assert first["compiling"] > first["seconds"] > 0
    assert first["parts"] == sorted(first["parts"]) and first["parts"][0] == 0
    again = run(SOLVE, supports, NUMBA_CACHE_DIR=str(tmp_path))
    assert again["compiled"] == [] and again["compiling"] == 0 and again["parts"] == []


@pytest.mark.nightly
def test_where_nothing_can_be_written_kernels_are_stored_with_the_temporary_files(tmp_path):
    found = run(READ_ONLY + SOLVE, "boundary", TMPDIR=str(tmp_path))
    assert found["status"] == "converged"
    assert list(tmp_path.rglob("*.nbi"))
    assert run(READ_ONLY + SOLVE, "boundary", TMPDIR=str(tmp_path))["compiled"] == []


@pytest.mark.nightly
def test_the_warm_up_reaches_every_kernel(tmp_path):
    code = """
import json
from compas_cgc._compiled import _kernels
from compas_cgc._warm_up import is_warm, warm_up
before, parts = is_warm(), []
warm_up(parts.append, builds=True)
left = [made.py_func.__qualname__ for made in _kernels if not made.signatures]
print(json.dumps({"before": before, "after": is_warm(), "parts": parts, "left": left}))
"""
    found = run(code, NUMBA_CACHE_DIR=str(tmp_path))
    assert not found["before"] and found["after"] and found["left"] == []
    assert found["parts"][0] == 0.0 and found["parts"][-1] == 1.0
    assert run(SOLVE, "corners", NUMBA_CACHE_DIR=str(tmp_path))["compiled"] == []
