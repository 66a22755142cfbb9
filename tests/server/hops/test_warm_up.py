"""A worker that is warm: its first component waits for nothing to be loaded."""

from __future__ import annotations

import subprocess
import sys

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


def test_the_first_component_of_a_warm_worker_loads_nothing():
    done = subprocess.run([sys.executable, "-c", WARM], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
