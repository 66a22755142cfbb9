"""Mutated mesh files: structure-aware damage to valid files of every format, and what reading them costs.

``python -m tests.support.mutated_files 10000`` reads 10,000 files of each format and prints one line for each.
"""

from __future__ import annotations

import copy
import json
import random
import re
import struct
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any
from typing import NamedTuple

from compas_cgc import CGCMesh
from compas_cgc.errors import CGCError
from compas_cgc.io import read_problem
from compas_cgc.io import write
from compas_cgc.io.summary import describe

from .mutated_models import mutated_model

SUFFIXES = (".json", ".obj", ".off", ".ply", ".stl", ".3dm")
NUMBERS = "0 -1 1 7 -7 1e308 -1e308 nan inf 99999999999 -99999999999 2147483648 4294967296 1e-320 0x10 1_0 .5. 9" + 300 * "9"
FOREIGN = "foreign_module_of_a_file"
_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:e-?\d+)?")


class Reading(NamedTuple):
    """What reading some files gave."""

    files: int
    accepted: int
    refused: int
    tracebacks: list[str]  # errors that are no sentences
    slowest: float  # processor time, with that of child processes [s]
    megabytes: float  # by which this process grew at most
    imported: bool  # a file had the foreign module imported
    causes: Counter  # errors of the readers behind the sentences


def valid_files(folder: Path, suffix: str) -> list[bytes]:
    """Return the bytes of valid files of a format."""
    mesh = CGCMesh.from_meshgrid(dx=5, nx=6)
    mesh.set_supports("corners")
    mesh.set_target(0.01)
    mesh.set_creases([[7 * i + 3 for i in range(7)]])
    write(folder / f"seed{suffix}", mesh)
    found = [(folder / f"seed{suffix}").read_bytes()]
    if suffix == ".ply":
        found.append(_binary_ply(mesh))
    if suffix == ".stl":
        found.append(_binary_stl(mesh))
    return found


def mutated(seed: bytes, suffix: str, random: random.Random) -> bytes:
    """Return a damaged copy of a file."""
    if suffix == ".json" and random.random() < 0.7:
        return _mutated_json(seed, random)
    if suffix == ".3dm" and random.random() < 0.85:
        return mutated_model(seed, random)
    text = suffix in (".json", ".obj", ".off") or b"\0" not in seed
    data = bytearray(seed)
    for _ in range(random.choice((1, 1, 2, 4))):
        (random.choice((_number, _line, _cut, _byte)) if text else random.choice((_word, _byte, _cut, _number)))(data, random)
    return bytes(data)


def read_all(files: list[tuple[str, bytes]], folder: Path) -> Reading:
    """Read files of a suffix and content as ``compas-cgc check`` does."""
    tracebacks, causes, slowest, accepted, refused = [], Counter(), 0.0, 0, 0
    (folder / f"{FOREIGN}.py").write_text("class X: pass")
    sys.path.insert(0, str(folder))
    _forget_peak()
    before = _megabytes()
    for suffix, content in files:
        path = folder / f"file{suffix}"
        path.write_bytes(content)
        started = processor_seconds()
        try:
            describe(read_problem(path))
            accepted += 1
        except CGCError as error:
            refused += 1
            if error.__cause__ is not None:
                causes[type(error.__cause__).__name__] += 1
        except Exception as error:
            tracebacks.append(f"{type(error).__name__}: {error}"[:200])
        slowest = max(slowest, processor_seconds() - started)
    sys.path.remove(str(folder))
    return Reading(len(files), accepted, refused, tracebacks, slowest, _megabytes() - before, FOREIGN in sys.modules, causes)


def _number(data: bytearray, random: random.Random) -> None:
    places = list(_NUMBER.finditer(data))
    if places:
        place = random.choice(places)
        data[place.start() : place.end()] = random.choice(NUMBERS.split()).encode()


def _line(data: bytearray, random: random.Random) -> None:
    lines = bytes(data).split(b"\n")
    k = random.randrange(len(lines))
    change = random.randrange(5)
    if change == 0:
        lines[k:k] = [lines[k]] * random.choice((1, 50))
    elif change == 1:
        del lines[k]
    elif change == 2:
        lines[k] += b" \\"
    elif change == 3:
        lines[k] = b" ".join([lines[k]] * random.choice((2, 40)))
    else:
        other = random.randrange(len(lines))
        lines[k], lines[other] = lines[other], lines[k]
    data[:] = b"\n".join(lines)


def _cut(data: bytearray, random: random.Random) -> None:
    start = random.randrange(len(data) + 1)
    del data[start : random.choice((start + random.randrange(40), len(data)))]


def _byte(data: bytearray, random: random.Random) -> None:
    for _ in range(random.choice((1, 3, 20))):
        if data:
            data[random.randrange(len(data))] = random.choice((0, 255, 128, 127, random.randrange(256)))


def _word(data: bytearray, random: random.Random) -> None:
    if len(data) > 8:
        place = random.randrange(len(data) - 8)
        values = [struct.pack("<i", k) for k in (-1, 0, 2**31 - 1, -(2**31))] + [struct.pack("<q", k) for k in (-1, 2**62)]
        word = random.choice([*values, struct.pack("<d", float("nan"))])
        data[place : place + len(word)] = word


def _mutated_json(seed: bytes, random: random.Random) -> bytes:
    """Return JSON with some nodes replaced, renamed, removed or nested."""
    value = json.loads(seed)
    nest: Any = 1
    for _ in range(random.choice((3, 70, 400))):
        nest = {"a": nest} if random.random() < 0.5 else [nest]
    hostile = [None, True, -1, 1e308, 10**400, "", "x", [], {}, [1, [2]], nest, {"dtype": f"{FOREIGN}/X", "data": {}}, "99999999999"]
    for _ in range(random.choice((1, 2, 5))):
        nodes = [value]
        while True:
            inner = [item for item in (nodes[-1].values() if isinstance(nodes[-1], dict) else nodes[-1]) if isinstance(item, (dict, list))]
            if not inner or random.random() < 0.3:
                break
            nodes.append(random.choice(inner))
        node = nodes[-1]
        keys = list(node) if isinstance(node, dict) else list(range(len(node)))
        if not keys:
            continue
        key = random.choice(keys)
        change = random.randrange(4)
        if change == 0:
            node[key] = copy.deepcopy(random.choice(hostile))
        elif change == 1:
            del node[key]
        elif isinstance(node, dict):
            node[str(random.choice(("dtype", "inheritance", "-5", "zz", "1e9", key)))] = copy.deepcopy(random.choice([*hostile, node[key]]))
        else:
            node.append(copy.deepcopy(random.choice(hostile)))
    return json.dumps(value).encode()


def _binary_ply(mesh: CGCMesh) -> bytes:
    V, F = mesh.arrays()
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(V)}\nproperty double x\nproperty double y\nproperty double z\n"
    head += f"element face {len(F)}\nproperty list uchar int vertex_indices\nend_header\n"
    return head.encode() + V.tobytes() + b"".join(struct.pack("<B3i", 3, *face) for face in F.tolist())


def _binary_stl(mesh: CGCMesh) -> bytes:
    V, F = mesh.arrays()
    rows = b"".join(struct.pack("<12fH", 0, 0, 1, *V[face].ravel(), 0) for face in F)
    return bytes(80) + struct.pack("<I", len(F)) + rows


def processor_seconds() -> float:
    """Return the processor time of this process and its ended children [s]."""
    import resource

    spent = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(own.ru_utime + own.ru_stime for own in spent)


def _megabytes() -> float:
    """Return the peak size of this process [MB]."""
    status = Path("/proc/self/status")
    if status.exists():
        return next(float(line.split()[1]) for line in status.read_text().splitlines() if line.startswith("VmHWM")) / 1024
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _forget_peak() -> None:
    """Let the peak begin anew, so that what earlier tests of this process took does not count; on Linux only."""
    clear = Path("/proc/self/clear_refs")
    if clear.exists():
        clear.write_text("5")


def main() -> None:
    """Read mutated files of every format."""
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    for suffix in sys.argv[3:] or SUFFIXES:
        source = random.Random(f"{seed}{suffix}")
        with tempfile.TemporaryDirectory() as folder:
            seeds = valid_files(Path(folder), suffix)
            total: Any = None
            for _ in range(0, count, 200):
                read = read_all([(suffix, mutated(source.choice(seeds), suffix, source)) for _ in range(200)], Path(folder))
                total = read if total is None else Reading(*(_joined(a, b) for a, b in zip(total, read)))
        print(suffix, total._replace(tracebacks=[len(total.tracebacks), *total.tracebacks[:3]]), flush=True)


def _joined(a: Any, b: Any) -> Any:
    return max(a, b) if isinstance(a, (float, bool)) else a + b


if __name__ == "__main__":
    main()
