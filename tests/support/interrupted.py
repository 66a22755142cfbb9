"""Commands that are interrupted: ``python -m tests.support.interrupted 500`` ends commands of several outputs by signals and full disks.

Every trial begins with the outputs of an earlier run on another input, and ends with those of either run, all from the same one. Each
command runs in a fork of this process, which has imported the package, so that most signals arrive while the command works. Full disks
are small file systems in memory where the process may mount them (`mount -t tmpfs`), and limits of the size of a file elsewhere.
"""

from __future__ import annotations

import hashlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from compas_cgc import CGCMesh
from compas_cgc import write
from compas_cgc._atomic_write import recover
from compas_cgc.cli.exits import DONE
from compas_cgc.cli.exits import INTERRUPTED
from compas_cgc.cli.exits import ROUGH
from compas_cgc.cli.main import main as command_line
from compas_cgc.model.problem import CGCProblem

from .freeform import mesh_over

TARGETS = (0.006, 0.01)  # of the earlier run and of the one that is interrupted
KINDS = ("INT", "TERM", "HUP", "KILL", "disk")
COMMANDS = {
    "solve": "solve plan.json -o {}/a.3dm --report {}/a.json --picture {}/a.svg",
    "rationalise": "rationalise design.obj -o {}/a.obj --panel 2 --edges 4 --moulds 2 --report {}/a.json --sweep 1 2",
    "mould": "mould solved.obj -o {}/a.3dm -o {}/a.csv --count 4 --schedule {}/b.csv --schedule {}/b.pdf --report {}/b.json",
    "unroll": "unroll solved.obj -o {}/a.dxf -o {}/a.svg -o {}/a.3dm --size 4",
    "net": "net solved.obj -o {}/a.3dm -o {}/a.dxf -o {}/a.json",
    "quads": "quads solved.obj -o {}/a.3dm -o {}/a.dxf -o {}/a.json -o {}/a.csv",
    "drawings": "drawings solved.obj -o {}/a.pdf -o {}/a.dxf -o {}/a.svg",
    "membrane": "membrane solved.obj -o {}/a.3dm -o {}/a.inp -o {}/a.json --pressure 1",
}


class Trial(NamedTuple):
    """What became of an interrupted command."""

    command: str
    kind: str
    code: int  # negative for a signal
    outputs: str  # old, new, interrupted or surface (of a command that says what it left out), or mixed
    traceback: bool
    lost: bool  # the surface of a solve that had ended is nowhere
    text: str


def digests(folder: Path) -> dict[str, str]:
    """Return the digests of all files in a folder."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir() if not path.name.startswith(".")}


def command(name: str, target: float, inputs: Path, folder: Path) -> list[str]:
    """Return the arguments of a command on the inputs of a target, with its outputs in a folder."""
    words = COMMANDS[name].replace("{}", str(folder)).split()
    words[1] = str(inputs / f"{target:g}-{words[1]}")
    targets = [] if name in ("solve", "rationalise") else ["--target", f"{target:g}"]
    return [*words, *targets]


def run(words: list[str], said: Path, limit: int = 0) -> int:
    """Begin a command in a fork of this process, and return its id; `limit` is the size of the largest file."""
    process = os.fork()
    if process:
        return process
    code = 70
    try:
        handle = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for stream in (1, 2):
            os.dup2(handle, stream)
        # Also where a test runner has replaced the streams.
        sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)
        if limit:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = command_line(words)
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else 1
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def ended(process: int) -> int:
    """Wait for a process and return its exit code."""
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def make_inputs(inputs: Path) -> None:
    """Write the inputs of all commands for both targets."""
    for target in TARGETS:
        mesh = CGCMesh.from_meshgrid(dx=10, nx=10)
        mesh.set_supports("boundary")
        mesh.set_target(target)
        write(inputs / f"{target:g}-plan.json", mesh)
        vertices, quads = mesh_over(lambda x, y, k=target: 1.0 - k * (x - 4.0) ** 2 - 0.04 * (y - 2.0) ** 2, 8.0, 4.0, 0.25)
        write(inputs / f"{target:g}-design.obj", CGCProblem(vertices, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]))
        words = ["solve", str(inputs / f"{target:g}-plan.json"), "-o", str(inputs / f"{target:g}-solved.obj"), "--measure", "exact", "-q"]
        assert ended(run(words, inputs / "said")) in (DONE, ROUGH), (inputs / "said").read_text()


@contextmanager
def small_disk(folder: Path, size: int):
    """Mount a file system of a size [byte] on a folder; yield whether that is allowed."""
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(folder)], capture_output=True).returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], check=True)


class Interruptions:
    """Trials of all commands in a folder."""

    def __init__(self, folder: Path, seed: int, names: list[str] | None = None):
        self.folder, self.chance = folder, random.Random(seed)
        self.inputs, self.said = folder / "inputs", folder / "said"
        self.names = names or list(COMMANDS)
        self.inputs.mkdir()
        make_inputs(self.inputs)
        self.whole: dict[str, tuple[dict, dict]] = {}
        self.seconds: dict[str, float] = {}
        for name in self.names:
            self.whole[name] = (self._complete(name, 0), self._complete(name, 1))

    def _complete(self, name: str, which: int) -> dict[str, str]:
        """Run a command twice to the end and return the digests of its outputs, which are the same; keep the files."""
        found = []
        for _ in range(1 + which):
            place = self._fresh("out")
            started = time.monotonic()
            code = ended(run(command(name, TARGETS[which], self.inputs, place), self.said))
            self.seconds[name] = time.monotonic() - started
            assert code in (DONE, ROUGH), (name, code, self.said.read_text())
            found.append(digests(place))
        kept = self._fresh(f"{name}-{which}")
        shutil.copytree(place, kept, dirs_exist_ok=True)
        # Documents with identifiers or dates differ between runs; then only their being replaced can be seen.
        return {own: digest if found[0][own] == digest else "" for own, digest in found[-1].items()}

    def _fresh(self, name: str) -> Path:
        place = self.folder / name
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        return place

    def trial(self, number: int) -> Trial:
        """Interrupt a command at a random time and judge its outputs."""
        name, kind = self.names[number % len(self.names)], KINDS[(number // len(self.names)) % len(KINDS)]
        place = self._fresh("out")
        sizes = sum(path.stat().st_size for which in (0, 1) for path in (self.folder / f"{name}-{which}").iterdir())
        old = {path.name: path.read_bytes() for path in (self.folder / f"{name}-0").iterdir()}
        room = sum(map(len, old.values())) + 8192 * (len(old) + 2) + int(self.chance.uniform(0.0, 0.6) * sizes)
        if kind != "disk":
            return self._judged(name, kind, place, old, self._signalled(number, name, kind, place, old))
        with small_disk(place, room) as mounted:
            for own, content in old.items():
                (place / own).write_bytes(content)
            limit = 0 if mounted else self.chance.randrange(1, max(map(len, old.values())))
            code = ended(run(command(name, TARGETS[1], self.inputs, place), self.said, limit))
            return self._judged(name, kind, place, old, code)

    def _signalled(self, number: int, name: str, kind: str, place: Path, old: dict[str, bytes]) -> int:
        for own, content in old.items():
            (place / own).write_bytes(content)
        process = run(command(name, TARGETS[1], self.inputs, place), self.said)
        end = time.monotonic() + self.chance.uniform(0.0, 1.05) * self.seconds[name]
        while time.monotonic() < end:
            time.sleep(0.001)
            # Every other signal arrives while outputs are written.
            if number % 2 and any(path.name.startswith(".") for path in place.iterdir()):
                time.sleep(self.chance.uniform(0.0, self.chance.choice((0.01, 0.3)) * self.seconds[name]))
                break
        os.kill(process, getattr(signal, f"SIG{kind}"))
        return ended(process)

    def _judged(self, name: str, kind: str, place: Path, old: dict[str, bytes], code: int) -> Trial:
        recover(place)
        text = self.said.read_text(errors="replace") if self.said.exists() else ""
        hidden = [path.name for path in place.iterdir() if path.name.startswith(".")]
        found = {own: content for own, content in digests(place).items() if ".unfinished" not in own}
        before = {own: hashlib.sha256(content).hexdigest() for own, content in old.items()}
        new = self.whole[name][1]
        is_new = {own for own in found if found[own] != before.get(own) and new.get(own, "-") in ("", found[own])}
        same = {own for own in found if own in before and before[own] == found[own]}
        alike = {own for own in new if new[own] == before.get(own)}  # both runs write the same
        outputs = "mixed"
        if code == INTERRUPTED and not hidden and not same - alike and set(found) == set(new):
            outputs = "interrupted"  # all of one run, which says that it is not complete
        elif hidden or set(found) - is_new - same:
            outputs = f"mixed {hidden or sorted(set(found) - is_new - same)}"
        elif same == set(before):
            outputs = "old"
        elif is_new | alike >= set(new):
            outputs = "new"
        elif code == 4 and "cannot be written" in text:
            outputs = "surface"
        lost = name in ("solve", "rationalise") and kind == "disk" and outputs == "old" and "saved the surface to" not in text
        return Trial(name, kind, code, outputs, "Traceback" in text, lost, text[-300:])


def interruptions(count: int, seed: int, names: list[str] | None = None) -> list[Trial]:
    """Return a number of trials."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) if sys.version_info >= (3, 10) else tempfile.TemporaryDirectory() as name:
        trials = Interruptions(Path(name), seed, names)
        print({own: round(seconds, 2) for own, seconds in trials.seconds.items()}, flush=True)
        found = []
        for number in range(count):
            found.append(trials.trial(number))
            if wrong([found[-1]]):
                print(found[-1], flush=True)
        return found


def wrong(trials: list[Trial]) -> list[Trial]:
    """Return the trials that end in mixed outputs, a traceback or a lost surface."""
    return [trial for trial in trials if trial.outputs.startswith("mixed") or trial.traceback or trial.lost]


def main() -> int:
    """Interrupt commands and print a summary."""
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    found = interruptions(count, seed, sys.argv[3:] or None)
    for kind in KINDS:
        print(kind, Counter(trial.outputs for trial in found if trial.kind == kind), flush=True)
    print(f"{len(found)} trials, {len(wrong(found))} wrong")
    return 1 if wrong(found) else 0


if __name__ == "__main__":
    sys.exit(main())
