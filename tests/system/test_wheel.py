"""What a user gets who has no clone: the sdist, the wheel made from it, and the components that are in both."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import pytest

from compas_cgc.grasshopper.build.build_all import built_files

ROOT = Path(__file__).parents[2]
BUILD = "import sys; from setuptools import build_meta; print(getattr(build_meta, sys.argv[1])(sys.argv[2]))"


def setuptools_version():
    try:
        return int(metadata.version("setuptools").split(".")[0])
    except metadata.PackageNotFoundError:
        return 0


pytestmark = [
    pytest.mark.nightly,
    pytest.mark.skipif(setuptools_version() < 77, reason="a wheel cannot be built without setuptools 77 or later"),
]


def files_below(folder):
    paths = [path.relative_to(folder) for path in folder.rglob("*") if path.is_file() and not path.name.startswith(".")]
    return {path.as_posix() for path in paths if "__pycache__" not in path.parts}


def built(what, source, folder):
    """Build by the standard's hook, in the environment that the tests run in, so without a network."""
    done = subprocess.run([sys.executable, "-c", BUILD, what, str(folder)], cwd=source, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / done.stdout.splitlines()[-1]


class Installed(NamedTuple):
    """A wheel made from an sdist, unpacked, which is all that installing does to it."""

    site: Path
    direct: Path  # the wheel made without an sdist

    def run(self, *words, cwd):
        environment = {**os.environ, "PYTHONPATH": str(self.site)}
        done = subprocess.run([sys.executable, *words], cwd=cwd, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    room = tmp_path_factory.mktemp("wheel")
    # Setuptools leaves its own files where it builds, so that is a copy.
    clone = room / "clone"
    for name in ("compas_cgc", "ghuser"):
        shutil.copytree(ROOT / name, clone / name, ignore=shutil.ignore_patterns("__pycache__", ".*"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, clone / name)
    sdist = built("build_sdist", clone, room)
    shutil.unpack_archive(sdist, room)
    wheel = built("build_wheel", room / sdist.name[: -len(".tar.gz")], room)
    shutil.unpack_archive(wheel, room / "site", "zip")
    (room / "direct").mkdir()
    return Installed(room / "site", built("build_wheel", clone, room / "direct"))


def test_nothing_that_the_package_needs_is_left_behind(installed):
    components = {f"ghuser/{path}" for path in files_below(ROOT / "ghuser") if path.count("/") or path == "icon.png"}
    assert files_below(installed.site / "compas_cgc") == files_below(ROOT / "compas_cgc") | components


def test_a_wheel_is_the_same_with_and_without_an_sdist(installed):
    wheel = zipfile.ZipFile(installed.direct)
    names = {name for name in wheel.namelist() if not name.endswith("/")}
    assert names == files_below(installed.site), "with nothing beside the package"
    assert {name.split("/")[0].split("-")[0] for name in names} == {"compas_cgc"}
    assert all(wheel.read(name) == (installed.site / name).read_bytes() for name in names if name.startswith("compas_cgc/"))


def test_type_checkers_are_told_that_the_package_has_types(installed):
    assert (installed.site / "compas_cgc" / "py.typed").is_file()


def test_grasshopper_gets_the_same_files_as_from_the_clone(installed, tmp_path):
    where = "from compas_cgc.grasshopper.build.component_manifest import sources_folder; print(sources_folder())"
    assert installed.run("-c", where, cwd=tmp_path) == [str(installed.site.resolve() / "compas_cgc" / "ghuser" / "components")]
    command = ("-m", "compas_cgc", "grasshopper")
    expected = built_files()
    installed.run(*command, "build", "-o", "made", cwd=tmp_path)
    assert {name: (tmp_path / "made" / name).read_bytes() for name in files_below(tmp_path / "made")} == expected
    (tmp_path / "UserObjects").mkdir()
    installed.run(*command, "install", "--to", "UserObjects", cwd=tmp_path)
    components = {name.split("/")[1]: data for name, data in expected.items() if name.startswith("components/")}
    assert {path.name: path.read_bytes() for path in (tmp_path / "UserObjects").iterdir()} == components
