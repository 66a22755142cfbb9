"""A stranger's Rhino: a fresh Python 3.9 without packages, in a folder with the Rhino package and the wheel alone."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from compas_cgc.cli.main import main
from compas_cgc.grasshopper.build.definition import EXAMPLES

from ...support import gh_evaluator
from ...support import rhino_classes
from ...support import rhino_session

ROOT = Path(__file__).parents[3]
COLD = 120.0  # time from opening the first definition to its first surface, with the installation of all packages [s]
NAMES = [definition.name for definition in EXAMPLES]

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(1500)]


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """A Python 3.9 without packages but pip, as Rhino 8 ships it."""
    windows = os.name == "nt"
    command = ["py", "-3.9", "-c", "import sys; print(sys.executable)"] if windows else [ROOT / ".ci" / "find-python", "3.9"]
    found = subprocess.run(command, capture_output=True, text=True)
    if found.returncode:
        pytest.skip("Python 3.9 is not installed")
    folder = tmp_path_factory.mktemp("rhinocode") / "py39-rh8"
    subprocess.run([found.stdout.strip(), "-m", "venv", folder], check=True)
    return folder / "Scripts" / "python.exe" if windows else folder / "bin" / "python"


@pytest.fixture(scope="module")
def delivery(tmp_path_factory):
    """A folder with the Rhino package and the wheel."""
    folder = tmp_path_factory.mktemp("delivery")
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, ROOT]
    subprocess.run(command, check=True)
    (wheel,) = folder.glob("*.whl")
    assert main(["grasshopper", "build", "-o", str(folder / "all"), "--package", str(wheel)]) == 0
    (package,) = (folder / "all").glob("*.yak")
    shutil.move(package, folder)
    shutil.rmtree(folder / "all")
    return folder


@pytest.fixture
def session(python, delivery, tmp_path):
    """A function that runs definitions in a new Rhino."""
    simulator = tmp_path / "simulator"
    simulator.mkdir()
    (simulator / "__init__.py").touch()
    for module in (gh_evaluator, rhino_classes, rhino_session):
        shutil.copy(module.__file__, simulator)
    rhino = tmp_path / "rhino"
    rhino.mkdir()
    shutil.copy(next(delivery.glob("*.yak")), rhino)
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "NUMBA", "VIRTUAL_ENV"))}

    def run(names, loaded=(), server=None):
        command = [python, "-m", "simulator.rhino_session", rhino, *map(json.dumps, (names, loaded, server))]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return [json.loads(line) for line in done.stdout.splitlines()]

    return run


def test_every_definition_runs_from_the_package_and_the_wheel_alone(session, open_server):
    """Those with Hops need a server besides."""
    runs = session(NAMES, server=open_server.url)
    for run in runs:
        print(f"{run['name']}: first surface after {run['first surface']:.1f} s ({run['computed']:.1f} s of computing)")
    assert [run["name"] for run in runs] == NAMES
    assert all(run["surfaces"] and not run["Error"] for run in runs), [run for run in runs if run["Error"] or not run["surfaces"]]
    assert all(height > 0.05 for run in runs for _, height in run["surfaces"])
    # The time for which other processes compute is not counted.
    assert min(runs[0]["first surface"], runs[0]["computed"]) <= COLD


@pytest.mark.parametrize("version", ["1.21.6", "1.26.4"], ids=["refused", "accepted"])
def test_an_older_numpy_of_another_plug_in_is_named_in_one_sentence(session, version):
    (run,) = session(NAMES[:1], [f"numpy=={version}"])
    assert run["Error"] and all(f"another plug-in has loaded numpy {version}, but compas_cgc uses " in text for text in run["Error"])
    assert all(text.endswith("; restart Rhino and open this definition first") for text in run["Error"])
    assert bool(run["surfaces"]) == (version == "1.26.4")
