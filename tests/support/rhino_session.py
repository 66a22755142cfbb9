"""A Rhino 8 without Python packages: opens the definitions of a package for its package manager, on the standard library alone.

It acts on the first lines of scripts as McNeel documents them. All scripts share one interpreter. ``# venv: NAME`` puts a folder of
packages first on its path, and ``# r: REQUIREMENT`` has pip install into this folder, once. A failed installation makes the folder
invalid until Rhino is restarted. Modules that are loaded stay loaded.
"""

from __future__ import annotations

import importlib
import json
import os
import struct
import subprocess
import sys
import time
import uuid
import zipfile
import zlib
from pathlib import Path

from . import gh_evaluator
from .rhino_classes import Point3d
from .rhino_classes import PolylineCurve
from .rhino_classes import modules
from .rhino_classes import square

LIMIT = 500.0  # time in which a definition comes to rest [s]
FIXED_SIZES = {2: 1, 4: 8, 5: 4, 7: 16, 8: 8, 30: 8, 31: 8, 32: 8, 33: 8, 34: 16, 35: 16, 36: 4, 50: 16, 51: 24, 52: 32}
FIXED_SIZES.update({60: 16, 61: 32, 70: 48, 71: 48, 72: 72, 80: 12})
VARIABLE_SIZES = {20: 1, 21: 8, 37: 1}  # bytes per counted element


class Part:
    """A chunk of an archive."""

    def __init__(self, name, index):
        self.name, self.index, self.items, self.chunks = name, index, {}, []

    def get(self, name, index=None, default=None):
        return self.items.get((name, index), default)

    def children(self, name):
        return [part for part in self.chunks if part.name == name]

    def child(self, name):
        return next(iter(self.children(name)), None)


class Reader:
    """Reader of binary archives."""

    def __init__(self, data):
        self.data, self.at = zlib.decompressobj(-15).decompress(data), 0

    def take(self, size):
        self.at += size
        return self.data[self.at - size : self.at]

    def number(self, form="<i"):
        return struct.unpack(form, self.take(struct.calcsize(form)))[0]

    def text(self):
        size, shift = 0, 0
        while True:
            byte = self.take(1)[0]
            size |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return self.take(size).decode("utf-8")

    def value(self, kind):
        if kind == 1:
            return bool(self.take(1)[0])
        if kind in (3, 6):
            return self.number("<i" if kind == 3 else "<d")
        if kind == 9:
            return uuid.UUID(bytes_le=self.take(16))
        if kind == 10:
            return self.text()
        return self.take(FIXED_SIZES[kind] if kind in FIXED_SIZES else self.number() * VARIABLE_SIZES[kind])

    def part(self):
        part = Part(self.text(), self.number())
        items, chunks = self.number(), self.number()
        for _ in range(items):
            name, index, kind = self.text(), self.number(), self.number()
            part.items[name, None if index < 0 else index] = self.value(kind)
        part.chunks = [self.part() for _ in range(chunks)]
        return part


class Environments:
    """Folders of packages, by the names in scripts."""

    def __init__(self, root):
        self.root, self.installed, self.invalid = root, set(), set()

    def use(self, name, requirements):
        folder = self.root / (name or "default")
        if name in self.invalid:
            raise ImportError(f"the environment {name} is invalid; restart Rhino")
        folder.mkdir(parents=True, exist_ok=True)
        for requirement in requirements:
            if (name, requirement) not in self.installed:
                self.install(name, folder, requirement)
        sys.path[:] = [str(folder), *(path for path in sys.path if path != str(folder))]
        importlib.invalidate_caches()

    def install(self, name, folder, requirement):
        command = [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(folder), requirement]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            self.invalid.add(name)
            raise ImportError(f"pip could not install {requirement}: {done.stderr.strip()[-500:]}")
        self.installed.add((name, requirement))


def directives(code, name):
    """Return the values of a directive in the comments at the top of a script."""
    lines = [line for line in code.split('"""')[0].splitlines() if line.startswith(f"# {name}:")]
    return [line.partition(":")[2].strip() for line in lines]


def script_component(environments):
    class Placed(gh_evaluator.Placed):
        """A script component; its errors are red balloons."""

        def execute(self, code, space):
            assert code.startswith("#! python 3\n")
            named = directives(code, "venv")
            environments.use(named[0] if named else None, directives(code, "r"))
            exec(code, space)

        def run(self, values):
            try:
                return super().run(values)
            except Exception as error:
                self.component.AddRuntimeMessage("Error", f"{type(error).__name__}: {error}")
                return {part.get("InstanceGuid"): [] for part in self.outputs}

    return Placed


def surfaces(canvas, values):
    """Return the meshes of the components that find surfaces."""
    found = []
    for placed in canvas.scripts.values():
        if {"Solve", "Rationalise", "CGC Dome", "CGC Solve"} & {placed.container.get("Name"), placed.container.get("NickName")}:
            part = next(part for part in placed.outputs if part.get("Name").lower() == "mesh")
            found += values[part.get("InstanceGuid")]
    return found


def drawn(name):
    """Return what the note of a definition has its user connect: a square of 9 m, with corners and lines at each third."""
    corners = [Point3d(x, y, 0.0) for x in (0.0, 9.0) for y in (0.0, 9.0)]
    if name == "own_mesh":
        return {"Mesh": [square()], "supports": corners}
    if name == "hops_dome":
        return {"Mesh": [square()]}
    if name == "hops_regions":
        ends = [((x, 0.0), (x, 9.0)) for x in (3.0, 6.0)] + [((0.0, y), (9.0, y)) for y in (3.0, 6.0)]
        return {
            "Mesh": [square()],
            "supports": corners,
            "creases": [PolylineCurve([Point3d(*end, 0.0) for end in line]) for line in ends],
            "points in regions": [Point3d(x, y, 0.0) for x in (1.5, 4.5, 7.5) for y in (1.5, 4.5, 7.5)],
        }
    return {}


def opened(path, script, server):
    """Open a definition, do what its note says, and return what its user sees."""
    start, computed = time.monotonic(), sum(os.times()[:4])
    canvas = gh_evaluator.Canvas(Reader(path.read_bytes()).part(), script)
    canvas.set.update({"run": [True], **drawn(path.stem)})
    for placed in canvas.scripts.values():
        placed.server = server
    first = None
    values = canvas.solution()
    while True:
        if first is None and surfaces(canvas, values):
            first, computed = time.monotonic() - start, sum(os.times()[:4]) - computed
        if not canvas.document.scheduled or time.monotonic() - start > LIMIT:
            break
        time.sleep(0.05)
        canvas.document.tick()
        values = canvas.solution()
    meshes = surfaces(canvas, values)
    errors = {
        level: [text for own in canvas.scripts.values() for kind, text in own.component.balloons if kind == level] for level in LEVELS
    }
    return {
        "name": path.stem,
        "first surface": first,
        "computed": computed,
        "seconds": time.monotonic() - start,
        "surfaces": [[len(mesh.Vertices), max(point.Z for point in mesh.Vertices)] for mesh in meshes],
        **errors,
    }


LEVELS = ("Error", "Warning")


def main(folder, definitions, loaded=(), server=None):
    """Run definitions of the package in a folder, after another plug-in has loaded some packages, and print what happens.

    Parameters
    ----------
    folder
        Folder with a ``.yak`` file.
    definitions
        Names.
    loaded
        Requirements that the other plug-in has installed and loaded.
    server
        Address of a server for Hops, which encodes geometry with the library of Rhino itself.
    """
    folder = Path(folder)
    (package,) = folder.glob("*.yak")
    zipfile.ZipFile(package).extractall(folder / "packages")
    environments = Environments(folder / "site-envs")
    sys.modules.update(modules())
    for requirement in loaded:
        environments.use("other", [requirement])
        importlib.import_module(requirement.partition("=")[0])
    if server:
        environments.use("Rhino", ["rhino3dm"])
    script = script_component(environments)
    for name in definitions:
        print(json.dumps(opened(folder / "packages" / "examples" / f"{name}.gh", script, server)), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], *map(json.loads, sys.argv[2:]))
