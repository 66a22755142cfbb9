"""A worker that is warm: its first component or file waits for nothing to be loaded."""

from __future__ import annotations

import subprocess
import sys

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc.server.api.serialization import pack_result

WARM = """
import sys
from compas_cgc.server.hops import warm_up
from compas_cgc.server.hops.functions import run_function

def kept(*asked):
    answers.append(run_function(*asked))
    loaded.append(set(sys.modules))

answers, loaded, warm_up.run_function = [], [], kept
warm_up.warm_up()
warm_up.warm_up()
assert [answer.status for answer in answers] == [200, 200], answers
late = sorted(name for name in loaded[1] - loaded[0] if name.startswith(("compas_cgc", "rhino3dm", "numba", "scipy")))
assert "rhino3dm" in loaded[0] and not late, late
"""

WRITER = """
import sys
from pathlib import Path
from compas_cgc.server.api.warm_up import warm_up_writer

warm_up_writer()
from compas_cgc.server.api.formats import encoded
before, content = set(sys.modules), Path(sys.argv[1]).read_bytes()
assert encoded("3dm", content).startswith(b"3D Geometry File Format")
assert not set(sys.modules) - before, sorted(set(sys.modules) - before)
"""


def test_the_first_component_of_a_warm_worker_loads_nothing():
    done = subprocess.run([sys.executable, "-c", WARM], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def test_the_first_file_of_a_warm_writer_loads_nothing(tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=9, nx=8)
    mesh.set_supports("corners")
    (path := tmp_path / "result").write_bytes(pack_result(compas_cgc.solve(mesh, targets=0.01), {"notes": []}))
    done = subprocess.run([sys.executable, "-c", WRITER, str(path)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
