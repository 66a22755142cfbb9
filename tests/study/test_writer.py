"""The folder of a study: several commands share it, and what is damaged in it comes back bit for bit."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import threading
from functools import partial
from pathlib import Path

import pytest

from compas_cgc import CGCMesh
from compas_cgc.errors import FileError
from compas_cgc.study.results import Results
from compas_cgc.study.run import run_study
from compas_cgc.study.spec import Study
from compas_cgc.study.writer import one_writer

HOLD = """
import sys, time
from pathlib import Path
from compas_cgc.study.writer import one_writer
with one_writer(Path(sys.argv[1]), bool) as held:
    print(held, flush=True)
    time.sleep(60)
"""


def small_study(count=4, first=0.01, size=4):
    """Return a problem and a study of it whose variants take milliseconds."""
    mesh = CGCMesh.from_meshgrid(dx=size, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.01)
    study = Study.from_dict({"parameters": {"K": [first + 0.005 * k for k in range(count)]}})
    return mesh, study


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return the folder of a study that one command made."""
    folder = tmp_path_factory.mktemp("study") / "one"
    run_study(*small_study(), folder)
    return folder


@pytest.fixture(scope="module")
def whole(made):
    """Return the bytes of its files."""
    return contents(made)


def contents(folder):
    return [(folder / name).read_bytes() for name in ("study.json", "drawing.json", "table.csv", "surfaces.npy")]


def test_four_commands_on_one_folder_give_the_study_of_one(tmp_path, whole):
    counts, threads = [], []
    for _ in range(4):
        threads.append(threading.Thread(target=lambda: counts.append(len(run_study(*small_study(), tmp_path)))))
        threads[-1].start()
    for thread in threads:
        thread.join()
    assert counts == 4 * [4] and contents(tmp_path) == whole


def test_a_writer_that_is_killed_lets_go_of_the_folder(tmp_path):
    holder = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "True\n"
    with one_writer(tmp_path, lambda: True) as held:
        assert not held
    holder.kill()
    holder.wait()
    holder.stdout.close()
    with one_writer(tmp_path, lambda: True) as held:
        assert held


def cut(name, size, folder):
    content = (folder / name).read_bytes()
    (folder / name).write_bytes(content[:size])


def replace(name, content, folder):
    (folder / name).write_bytes(content)


def flip(name, folder):
    content = bytearray((folder / name).read_bytes())
    content[len(content) // 2 :] = bytes(len(content) - len(content) // 2)
    (folder / name).write_bytes(content)


def mix(name, folder, **other):
    """Put a file of another study into a folder."""
    with tempfile.TemporaryDirectory() as apart:
        run_study(*small_study(**other), apart)
        (folder / name).write_bytes((Path(apart) / name).read_bytes())


MIXED = [
    partial(mix, "table.csv", first=0.02),
    partial(mix, "drawing.json", size=5),
]


@pytest.mark.parametrize("damage", [*MIXED, partial(mix, "study.json", first=0.02)])
def test_results_with_files_of_two_studies_are_refused(tmp_path, damage):
    run_study(*small_study(), tmp_path)
    assert len(Results(tmp_path).plan.columns) > 3
    damage(folder=tmp_path)
    with pytest.raises(FileError, match="are of different studies; run the study again"):
        Results(tmp_path).problem(0)


@pytest.mark.parametrize(
    "damage",
    [
        *MIXED,
        partial(cut, "table.csv", 5),
        partial(cut, "table.csv", -20),
        partial(cut, "surfaces.npy", 40),
        partial(cut, "surfaces.npy", -8),
        partial(cut, "surfaces.npy", 0),
        partial(replace, "table.csv", b""),
        partial(replace, "table.csv", b"\0\xff\n" * 9),
        partial(replace, "study.json", b""),
        partial(replace, "study.json", b"[1]"),
        partial(flip, "table.csv"),
        lambda folder: (folder / "surfaces.npy").unlink(),
        lambda folder: (folder / "drawing.json").unlink(),
    ],
)
def test_what_is_damaged_is_computed_again(tmp_path, made, whole, damage):
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    damage(folder=tmp_path)
    assert len(run_study(*small_study(), tmp_path)) == 4
    assert contents(tmp_path) == whole and (tmp_path / "drawing.json").exists()
