"""Outputs are whole: all files of a command or none, whatever ends it; and the solve is not lost."""

from __future__ import annotations

import errno
import importlib.util
import json
import os
import signal
import subprocess
import sys

import pytest

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import _atomic_write
from compas_cgc._atomic_write import PartlyPublished
from compas_cgc._atomic_write import further_outputs
from compas_cgc._atomic_write import published_together
from compas_cgc._atomic_write import recover
from compas_cgc._atomic_write import replacing
from compas_cgc._atomic_write import write_text
from compas_cgc._figures import new_figure
from compas_cgc._figures import save
from compas_cgc._figures import save_pages
from compas_cgc.cli import main
from compas_cgc.cli.exits import DONE
from compas_cgc.cli.exits import INCOMPLETE
from compas_cgc.cli.exits import INTERRUPTED
from compas_cgc.cli.exits import REFUSED
from compas_cgc.errors import FileError

from ..support.server_process import PATIENCE

pytestmark = pytest.mark.usefixtures("small_pictures")
NAMES = ("surface.obj", "report.json", "picture.svg")

# Publishes three files, and kills itself at a call of a function of the operating system.
KILLED = """
import os, signal, sys
from compas_cgc import _atomic_write
from compas_cgc._atomic_write import published_together, write_text
name, count, folder = sys.argv[1], int(sys.argv[2]), sys.argv[3]
real, calls = getattr(os, name), []
def counted(*args, **more):
    calls.append(args)
    if len(calls) == count:
        os.kill(os.getpid(), signal.SIGKILL)
    return real(*args, **more)
setattr(os, name, counted)
with published_together():
    for own in ("surface.obj", "report.json", "picture.svg"):
        write_text(os.path.join(folder, own), "new")
"""
POINTS = [("fsync", k) for k in range(1, 6)] + [("replace", k) for k in range(1, 5)] + [("chmod", k) for k in range(1, 4)]


@pytest.fixture
def plan(tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=4, nx=4)
    mesh.set_supports("boundary")
    mesh.set_target(0.05)
    compas_cgc.write(tmp_path / "plan.json", mesh)
    return tmp_path / "plan.json"


def left(folder):
    """Return the hidden files in a folder."""
    return [name for name in os.listdir(folder) if name.startswith(".")]


def old_files(folder):
    for name in NAMES:
        (folder / name).write_text("old")


def states(folder):
    return {(folder / name).read_text() for name in NAMES}


@pytest.mark.skipif(sys.platform == "win32", reason="it kills by signal")
@pytest.mark.parametrize("name, count", POINTS)
def test_a_kill_at_any_point_leaves_nothing_or_everything(tmp_path, name, count):
    old_files(tmp_path)
    ended = subprocess.run([sys.executable, "-c", KILLED, name, str(count), str(tmp_path)])
    assert ended.returncode == -signal.SIGKILL
    recover(tmp_path)
    assert states(tmp_path) in ({"old"}, {"new"})
    assert left(tmp_path) == []


def test_files_of_one_block_appear_together_and_in_order(tmp_path, monkeypatch):
    put, real = [], os.replace
    monkeypatch.setattr(_atomic_write.os, "replace", lambda a, b: (put.append(os.path.basename(b)), real(a, b)))
    old_files(tmp_path)
    with published_together():
        for name in NAMES:
            write_text(tmp_path / name, "new")
            assert states(tmp_path) == {"old"}
    assert states(tmp_path) == {"new"} and [name for name in put if name in NAMES] == list(NAMES)
    assert left(tmp_path) == []


def test_an_error_in_a_block_publishes_nothing(tmp_path):
    old_files(tmp_path)
    with pytest.raises(ZeroDivisionError), published_together():
        write_text(tmp_path / NAMES[0], "new")
        raise ZeroDivisionError
    assert states(tmp_path) == {"old"} and left(tmp_path) == []


def test_the_first_file_decides_and_a_later_one_is_named(tmp_path, monkeypatch):
    real = os.replace

    def refuse(name):
        def replace(source, target):
            if os.path.basename(target) == name:
                raise OSError(30, "Read-only file system", str(source), None, str(target))
            real(source, target)

        return replace

    def publish():
        with published_together():
            for name in NAMES:
                write_text(tmp_path / name, "new")

    old_files(tmp_path)
    monkeypatch.setattr(_atomic_write.os, "replace", refuse(NAMES[0]))
    with pytest.raises(FileError, match="surface.obj cannot be written .Read-only"):
        publish()
    assert states(tmp_path) == {"old"} and left(tmp_path) == []
    monkeypatch.setattr(_atomic_write.os, "replace", refuse(NAMES[1]))
    with pytest.raises(PartlyPublished, match="report.json cannot be written"):
        publish()
    assert [(tmp_path / name).read_text() for name in NAMES] == ["new", "old", "new"] and left(tmp_path) == []


def test_further_outputs_that_fail_are_left_out_together_and_named(tmp_path):
    old_files(tmp_path)
    with pytest.raises(PartlyPublished, match="no pictures today"):
        with published_together():
            write_text(tmp_path / NAMES[0], "new")
            with further_outputs():
                write_text(tmp_path / NAMES[1], "new")
                raise FileError("no pictures today")
    assert [(tmp_path / name).read_text() for name in NAMES] == ["new", "old", "old"] and left(tmp_path) == []


def test_a_command_whose_first_output_alone_is_in_its_place_ends_with_a_code_of_its_own(plan, monkeypatch, capsys):
    def check(arguments):
        raise PartlyPublished("report.json cannot be written")

    monkeypatch.setattr("compas_cgc.cli.check.run", check)
    assert main(["check", str(plan)]) == INCOMPLETE and "report.json cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_a_full_disk_at_the_journal_leaves_the_old_files_and_names_the_first(tmp_path, monkeypatch, failing):
    real, calls = getattr(os, failing), []

    def full(*args):
        calls.append(args)
        # The fourth file that is flushed is the journal, and it is the first that is renamed.
        if len(calls) == (4 if failing == "fsync" else 1):
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(*args)

    old_files(tmp_path)
    monkeypatch.setattr(_atomic_write.os, failing, full)
    with pytest.raises(FileError, match="surface.obj cannot be written .No space left on device.; free space on the disk"):
        with published_together():
            for name in NAMES:
                write_text(tmp_path / name, "new")
    assert states(tmp_path) == {"old"} and left(tmp_path) == []


@pytest.mark.parametrize("failing", ["fsync", "chmod", "replace"])
def test_a_full_disk_under_any_file_is_one_sentence_with_the_remedy(tmp_path, monkeypatch, failing):
    def full(*args):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(_atomic_write.os, failing, full)
    with pytest.raises(FileError, match="record.json cannot be written .No space left on device.; free space on the disk"):
        write_text(tmp_path / "record.json", "new")
    assert left(tmp_path) == []


def test_a_disk_too_full_for_a_folder_is_one_sentence_with_the_remedy(plan, monkeypatch, capsys):
    def check(arguments):
        raise OSError(errno.ENOSPC, "No space left on device", "out/best")

    monkeypatch.setattr("compas_cgc.cli.check.run", check)
    assert main(["check", str(plan)]) == REFUSED
    assert "out/best cannot be written (No space left on device); free space on the disk" in capsys.readouterr().err


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is full")
@pytest.mark.parametrize("suffix", ["pdf", "svg", "png"])
def test_pictures_on_a_full_disk_are_one_sentence(tmp_path, suffix):
    path = tmp_path / f"page.{suffix}"
    path.symlink_to("/dev/full")
    figure = new_figure(1.0, 1.0)
    with pytest.raises(FileError, match="cannot be written .No space left on device.; free space on the disk"):
        save_pages([figure], path) if suffix == "pdf" else save(figure, path)


def test_links_are_followed_and_devices_are_written_to(tmp_path):
    (tmp_path / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "real.txt")
    write_text(tmp_path / "link.txt", "new")
    assert (tmp_path / "link.txt").is_symlink() and (tmp_path / "real.txt").read_text() == "new"
    write_text(os.devnull, "new")
    assert not os.path.isfile(os.devnull)


def test_a_journal_that_somebody_else_wrote_moves_nothing(tmp_path):
    (tmp_path / "victim.txt").write_text("old")
    (tmp_path / "evil.txt").write_text("evil")
    name = f".cgc-{_atomic_write._HOST}-999999999-abc.journal"
    (tmp_path / name).write_text(json.dumps([[str(tmp_path / "evil.txt"), str(tmp_path / "victim.txt")]]))
    recover(tmp_path)
    assert (tmp_path / "victim.txt").read_text() == "old"


def test_files_of_a_process_that_lives_are_left_alone(tmp_path):
    with replacing(tmp_path / "a.txt") as temporary:
        recover(tmp_path)
        assert temporary.exists()


@pytest.mark.parametrize("option, target", [("--report", "folder"), ("--report", "plan.json/report.json"), ("--picture", "folder.svg")])
def test_an_output_that_cannot_be_written_does_not_lose_the_surface(plan, tmp_path, capsys, option, target):
    for name in ("folder", "folder.svg"):
        (tmp_path / name).mkdir()
    code = main(["solve", str(plan), "-o", str(tmp_path / "solved.obj"), option, str(tmp_path / target), "-q"])
    assert code == INCOMPLETE and (tmp_path / "solved.obj").exists() and left(tmp_path) == []
    assert "folder" in capsys.readouterr().err


def test_a_surface_that_cannot_be_written_is_saved_elsewhere(plan, tmp_path, capsys, monkeypatch):
    (tmp_path / "full.obj").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert main(["solve", str(plan), "-o", str(tmp_path / "full.obj"), "--report", str(tmp_path / "r.json"), "-q"]) == REFUSED
    message = capsys.readouterr().err
    assert "is a folder" in message and "saved the surface to" in message and not (tmp_path / "r.json").exists()
    assert [path.name for path in tmp_path.glob("compas_cgc-*/*")] == ["full.obj"]


def test_a_solve_writes_all_its_files(plan, tmp_path):
    words = ["-o", str(tmp_path / "a.obj"), "--report", str(tmp_path / "a.report.json"), "--picture", str(tmp_path / "a.svg"), "-q"]
    assert main(["solve", str(plan), *words]) == DONE
    assert all((tmp_path / name).stat().st_size for name in ("a.obj", "a.report.json", "a.svg")) and left(tmp_path) == []


@pytest.mark.skipif(sys.platform == "win32", reason="it ends by signal")
def test_a_signal_leaves_no_temporary_file(tmp_path):
    code = (
        "import sys, time; from compas_cgc.cli import main as m; from compas_cgc._atomic_write import replacing; import importlib\n"
        "from compas_cgc.cli.signals import end_cleanly_on_signals; end_cleanly_on_signals()\n"
        "with replacing(sys.argv[1]) as t: print('begun', flush=True); time.sleep(60)"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "a.txt")], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n" and left(tmp_path)
    process.terminate()
    assert process.wait(PATIENCE) == 143 and left(tmp_path) == []
    process.stdout.close()


@pytest.mark.skipif(sys.platform == "win32", reason="it ends by signal")
def test_a_signal_whose_exception_a_library_swallows_publishes_nothing(tmp_path):
    code = (
        "import importlib, os, signal, sys; from compas_cgc._atomic_write import *; from compas_cgc.errors import FileError\n"
        "from compas_cgc.cli.signals import end_cleanly_on_signals; end_cleanly_on_signals()\n"
        "with published_together():\n"
        "    write_text(sys.argv[1], 'new')\n"
        "    with further_outputs():\n"
        "        try: signal.raise_signal(signal.SIGTERM)\n"
        "        except SystemExit: raise FileError('drawing requires a library')\n"
    )
    (tmp_path / "a.txt").write_text("old")
    assert subprocess.run([sys.executable, "-c", code, str(tmp_path / "a.txt")]).returncode == 143
    assert (tmp_path / "a.txt").read_text() == "old" and left(tmp_path) == []


@pytest.mark.parametrize("cause", [SystemExit(143), KeyboardInterrupt()])
def test_a_signal_in_a_compiled_function_ends_the_command_like_any_other(plan, monkeypatch, cause):
    def check(arguments):
        try:
            raise SystemError("the inner function returned a result with an exception set") from cause
        except SystemError as error:
            raise SystemError("the outer function returned a result with an exception set") from error

    monkeypatch.setattr("compas_cgc.cli.check.run", check)
    try:
        code = main(["check", str(plan)])
    except SystemExit as error:
        code = error.code
    assert code in (143, INTERRUPTED)


@pytest.mark.skipif(sys.platform == "win32", reason="it ends by signal")
@pytest.mark.parametrize("name, code", [("SIGTERM", 143), ("SIGHUP", 129), ("SIGINT", INTERRUPTED)])
def test_a_signal_whose_exception_python_ignores_is_repeated(name, code):
    """Python ignores exceptions in callbacks of weak references, and prints them with a traceback."""
    program = (
        "import signal, sys, time, weakref\n"
        "from compas_cgc.cli import check, main, signals\n"
        "signals.REPEAT_SECONDS = 0.0\n"
        "class Gone: pass\n"
        "def run(arguments):\n"
        f"    gone = Gone(); kept = weakref.ref(gone, lambda own: signal.raise_signal(signal.{name})); del gone\n"
        f"    time.sleep({PATIENCE})\n"
        "check.run = run\n"
        "sys.exit(main(['check', 'plan.json']))\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert ended.returncode == code and "Traceback" not in ended.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="it ends by signal")
@pytest.mark.parametrize("name, code", [("SIGTERM", 143), ("SIGINT", INTERRUPTED)])
def test_a_signal_while_an_extension_module_is_loaded_waits_for_its_end(name, code):
    program = (
        "import signal, sys\n"
        "from importlib.machinery import ExtensionFileLoader\n"
        "from compas_cgc.cli import check, main\n"
        "execute = ExtensionFileLoader.exec_module\n"
        "def slow(loader, module):\n"
        f"    signal.raise_signal(signal.{name}); execute(loader, module); print('loaded', flush=True)\n"
        "ExtensionFileLoader.exec_module = slow\n"
        "def run(arguments):\n"
        "    sys.modules.pop('_json', None); import _json; print('late')\n"
        "check.run = run\n"
        "sys.exit(main(['check', 'plan.json']))\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert ended.returncode == code and set(ended.stdout.split()) == {"loaded"} and "Traceback" not in ended.stderr


def test_an_interrupt_while_a_command_is_loaded_ends_it_like_any_other(monkeypatch, capsys):
    def load(name):
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["compas_cgc.cli.main"], "build_parser", load)
    assert main(["check", "plan.json"]) == INTERRUPTED and capsys.readouterr().err == "compas-cgc: interrupted\n"


@pytest.mark.parametrize("content", [b"", b"\0" * 40, b"\x80\x05K\x01."])
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
def test_a_damaged_stored_kernel_is_compiled_anew(tmp_path, suffix, content):
    source = tmp_path / "kernels.py"
    source.write_text("from compas_cgc._compiled import kernel\n@kernel()\ndef add(a, b):\n    return a + b\n")

    def added():
        spec = importlib.util.spec_from_file_location("kernels", source)
        sys.modules["kernels"] = module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        try:
            return module.add(1.0, 2.0), sum(module.add.stats.cache_hits.values())
        finally:
            del sys.modules["kernels"]

    assert added() == (3.0, 0) and added() == (3.0, 1)
    (stored,) = (tmp_path / "__pycache__").glob(f"kernels.add*{suffix}")
    stored.write_bytes(content)
    assert added() == (3.0, 0), "compiled"
    assert added() == (3.0, 1), "and stored again"
