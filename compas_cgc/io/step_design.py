"""Finished designs of STEP files: one untrimmed surface, or the triangles of all faces."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Union

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import FileError
from ..meshing.weld import weld
from .rhino.designs import DrawnDesign
from .rhino.designs import DrawnSpline
from .step_process import contents_of_step

__all__ = ["read_step_design"]

COINCIDENCE = 1e-3  # distance within which points of neighbouring faces coincide, relative to the tolerance
MAX_NEIGHBOURS = 100  # within this distance, in the mean; beyond, merging takes gigabytes
# Longest processor time of reading; valid designs up to .6 MB took 1.4 s at most, one of 6 MB 2.5 s, where counting takes COUNT_SECONDS.
SECONDS, SECONDS_PER_BYTE = 1.7, 0.7e-6
COUNT_SECONDS = 1.6e-3
MEMORY, MEMORY_PER_BYTE = 400 * 2**20, 50  # largest memory of reading [bytes]; 130 MB is the most that a valid design took
PATIENCE = 20.0  # longest time by the clock, relative to the processor time, as on a busy computer
_OUT_OF_TIME = getattr(signal, "SIGPROF", 0)  # ends a process that has used its processor time


def read_step_design(path: Union[str, os.PathLike]) -> DrawnDesign:
    """Read a design from a STEP file, in millimetres.

    An untrimmed surface is read exactly; other faces are sewn and divided into triangles. A damaged file can make OpenCASCADE crash or
    divide faces for minutes into gigabytes, so it runs in a process of its own with limits of its processor time and memory.

    Parameters
    ----------
    path
        The .step or .stp file.

    Raises
    ------
    FileError
        If the file cannot be read or holds no faces, or if the package that reads STEP files is not installed.
    """
    path = Path(path)
    if not path.is_file():
        raise FileError(f"there is no file {path}")
    # Within another program, such as Rhino, there may be no interpreter to start.
    is_python = Path(sys.executable or "").stem.lower().startswith("python")
    return _design(_read_apart(path) if is_python else contents_of_step(path))


def _read_apart(path: Path) -> dict[str, np.ndarray]:
    """Return the contents of a file, read by a process of its own."""
    size = path.stat().st_size
    limit, memory = (SECONDS + SECONDS_PER_BYTE * size) * _slowness(), int(MEMORY + MEMORY_PER_BYTE * size)
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "contents"
        try:
            done = subprocess.run(
                [sys.executable, "-c", "from compas_cgc.io.step_process import main; main()", *map(str, (path, result, limit, memory))],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                timeout=PATIENCE * limit,
            )
        except subprocess.TimeoutExpired:
            waited = f"{PATIENCE * limit:.0f} s"
            raise FileError(f"{path} was not read within {waited}, as this computer is too busy; try again later") from None
        if done.returncode == -_OUT_OF_TIME:
            raise FileError(f"{path} takes more than {limit:.2g} s to read; repair its faces, or export fewer of them")
        if done.returncode:
            raise FileError(f"{path} cannot be read, as OpenCASCADE fails on it; repair its faces and export it again")
        with np.load(result) as file:
            contents = dict(file)
    if "reason" in contents:
        raise FileError(str(contents["reason"]))
    return contents


def _slowness() -> float:
    """Return the time that this computer takes to count, relative to COUNT_SECONDS; 1 for faster ones."""

    def seconds() -> float:
        started = time.thread_time()
        sum(k * k for k in range(50_000))
        return time.thread_time() - started

    # The fastest of a few, as others are delayed by what else runs.
    return max(1.0, min(seconds() for _ in range(5)) / COUNT_SECONDS)


def _design(contents: dict[str, np.ndarray]) -> DrawnDesign:
    tolerance = float(contents["tolerance"])
    spline, vertices, triangles = None, np.empty((0, 3)), np.empty((0, 3), np.int64)
    if "control" in contents:
        first, second = contents["degrees"].tolist()
        spline = DrawnSpline(contents["control"], (contents["u"], contents["v"]), (first, second))
    else:
        vertices, triangles = _merged(contents["vertices"], contents["triangles"], COINCIDENCE * tolerance)
    return DrawnDesign(spline, vertices, np.column_stack([triangles, triangles[:, 2]]), [], [], "Millimeters", tolerance, [])


def _merged(vertices: FloatArray, triangles: IntArray, distance: float) -> tuple[FloatArray, IntArray]:
    """Return vertices and triangles of all faces, which share the vertices along their edges."""
    tree = cKDTree(vertices)
    if tree.count_neighbors(tree, distance) > MAX_NEIGHBOURS * len(vertices):
        raise FileError("the file holds faces that are too small for its size; remove what lies far from the design")
    joined = weld(vertices, triangles, distance)
    faces = joined.faces[(joined.faces != np.roll(joined.faces, 1, axis=1)).all(axis=1)]
    return joined.vertices, faces
