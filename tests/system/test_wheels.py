"""Wheels: whether everything that a plain install needs is there ready-made, for every system and Python that is promised.

Run it alone as ``python tests/system/test_wheels.py`` for a table.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
PYTHONS = ("3.9", "3.10", "3.11", "3.12", "3.13", "3.14")
# Platform tags that pip takes for each system, of which an older one serves too. Rhino 8 runs on macOS 12 and later.
SYSTEMS = {
    "Windows": ["win_amd64"],
    "macOS 12, Apple": [f"macosx_{major}_0_{chip}" for major in (12, 11) for chip in ("arm64", "universal2")],
    "macOS 12, Intel": [
        *(f"macosx_{major}_0_{chip}" for major in (12, 11) for chip in ("x86_64", "universal2")),
        *(f"macosx_10_{minor}_{chip}" for minor in range(9, 17) for chip in ("x86_64", "universal2", "intel")),
    ],
    "Linux": ["manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64"],
}
NAMES = {"Windows": ("win32", "Windows", "AMD64"), "Linux": ("linux", "Linux", "x86_64")}


def base(python: str, system: str) -> list[str]:
    """Return what a plain install asks pip for there."""
    from packaging.requirements import Requirement

    sys_platform, platform_system, machine = NAMES.get(system, ("darwin", "Darwin", "arm64" if "Apple" in system else "x86_64"))
    found = []
    for text in tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]:
        requirement = Requirement(text)
        # pip itself asks the markers of the machine that it runs on.
        place = {"python_version": python, "python_full_version": f"{python}.0", "sys_platform": sys_platform}
        place |= {"platform_system": platform_system, "platform_machine": machine}
        if requirement.marker is None or requirement.marker.evaluate(place):
            requirement.marker = None
            found.append(str(requirement))
    return found


def resolve(python: str, system: str, folder: Path) -> subprocess.CompletedProcess:
    """Let pip choose the wheels for a system and a Python, without installing them."""
    words = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "--only-binary=:all:", "--target", str(folder)]
    words += ["--python-version", python, "--implementation", "cp", "--quiet", "--disable-pip-version-check"]
    words += [word for tag in SYSTEMS[system] for word in ("--platform", tag)]
    return subprocess.run([*words, *base(python, system)], capture_output=True, text=True, timeout=300)


# No lower bound brings it: the only wheels for Python 3.14 that call themselves universal are numba 0.63.0b1 and llvmlite 0.46.0b1,
# and the library in the latter is for Apple's chips alone. Newer versions of pip come to other ends here, and a wheel may appear.
MISSING = {("macOS 12, Intel", "3.14"): "Numba makes no wheels for Intel Macs from Python 3.14 on"}
CASES = [
    pytest.param(
        system, python, marks=[pytest.mark.xfail(reason=MISSING[system, python], strict=False)] if (system, python) in MISSING else []
    )
    for system in SYSTEMS
    for python in PYTHONS
]


@pytest.mark.nightly
@pytest.mark.timeout(600)
@pytest.mark.parametrize(("system", "python"), CASES)
def test_every_dependency_of_the_base_has_a_wheel(system, python, tmp_path):
    done = resolve(python, system, tmp_path)
    if "Failed to establish a new connection" in done.stderr:
        pytest.skip("the package index is out of reach")
    assert done.returncode == 0, done.stderr


if __name__ == "__main__":
    for system in SYSTEMS:
        for python in PYTHONS:
            done = resolve(python, system, ROOT / "build" / "wheels")
            print(f"{system:16} {python:5} {'all' if done.returncode == 0 else done.stderr.strip().splitlines()[-1]}", flush=True)
