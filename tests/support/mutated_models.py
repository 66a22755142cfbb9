"""Mutated .3dm files: damaged blocks of a file whose frame stays whole, and odd objects, texts and settings in a valid file."""

from __future__ import annotations

import random
import struct
import tempfile
from pathlib import Path
from typing import Any
from typing import NamedTuple

HEAD, BLOCK, END = 32, 12, 20  # bytes: beginning of a file; code and length of a block; the last block, which holds the length of the file
SHORT = 0x80000000  # in the code of blocks whose length is their value
LENGTHS = (-(2**63), -1, 0, 1, 7, 2**31 - 1, 2**32, 2**62)
VALUES = (0.0, -1.0, 1e-320, 1e-30, 1e12, 1e150, 1e308, float("inf"), float("nan"))
TEXTS = (
    "",
    "K=",
    "K=nan",
    "K=1e400",
    "K=-0,02",
    "law",
    "H=0",
    "9" * 400,
    "\x00\x01",
    "{",
    "[" * 3000,
    "null",
    '{"vertices": 49, "goals": [{}]}',
    "é☃" * 50,
)
KEYS = ("K", "target", "law", "keep", "rise", "clearance", "height", "support", "cgc vertices", "cgc goals", "s", "e", "")
LAYERS = ("CGC::Mesh", "CGC::Supports", "CGC::Creases", "CGC::Targets", "CGC::Constraints", "CGC::Goals", "CGC Result", "", "::", "x" * 300)


class Block(NamedTuple):
    """A block of a .3dm file: where its code begins, where its content ends, and the blocks that hold it."""

    start: int
    end: int
    holders: tuple[int, ...]  # where their codes begin


def mutated_model(seed: bytes, source: random.Random) -> bytes:
    """Return a damaged copy of a .3dm file of version 5 or later."""
    if source.random() < 0.5:
        return _odd_model(seed, source)
    data = bytearray(seed)
    for _ in range(source.choice((1, 1, 2, 4))):
        source.choice((_damage_content, _damage_content, _damage_length, _remove, _repeat))(data, source)
    data[-8:] = struct.pack("<Q", len(data))
    return bytes(data)


def blocks(data: bytes, start: int = HEAD, end: int = 0, holders: tuple[int, ...] = ()) -> list[Block]:
    """Return the blocks of a file, or of a range of bytes that they fill."""
    found = []
    place, end = start, end or len(data)
    while place + BLOCK <= end:
        code, length = struct.unpack_from("<Iq", data, place)
        after = place + BLOCK + (0 if code & SHORT else length)
        if not place + BLOCK <= after <= end:
            return []
        found.append(Block(place, after, holders))
        found += blocks(data, place + BLOCK, after, (*holders, place)) if after > place + 2 * BLOCK else []
        place = after
    return found if place >= end - 4 else []  # a checksum may follow


def _damage_content(data: bytearray, source: random.Random) -> None:
    block = _chosen(data, source)
    for _ in range(source.choice((1, 3, 20))):
        place = source.randrange(block.start + BLOCK, max(block.end, block.start + BLOCK + 1))
        word = source.choice(
            (bytes([source.randrange(256)]), struct.pack("<d", source.choice(VALUES)), struct.pack("<q", source.choice(LENGTHS)))
        )
        place = min(place, len(data) - END - len(word))
        data[place : place + len(word)] = word


def _damage_length(data: bytearray, source: random.Random) -> None:
    place = _chosen(data, source).start + 4
    (length,) = struct.unpack_from("<q", data, place)
    length = source.choice((*LENGTHS, length - 1, length + 1, length // 2, 2 * length))
    data[place : place + 8] = struct.pack("<q", max(-(2**63), min(length, 2**63 - 1)))


def _remove(data: bytearray, source: random.Random) -> None:
    block = _chosen(data, source)
    del data[block.start : block.end]
    _lengthen(data, block, block.start - block.end, source)


def _repeat(data: bytearray, source: random.Random) -> None:
    block, count = _chosen(data, source), source.choice((1, 1, 20))
    data[block.end : block.end] = count * data[block.start : block.end]
    _lengthen(data, block, count * (block.end - block.start), source)


def _chosen(data: bytearray, source: random.Random) -> Block:
    """Return a block other than the last one, which is the end mark."""
    found = blocks(bytes(data))[:-1]
    return source.choice(found) if found else Block(HEAD, len(data) - END, ())


def _lengthen(data: bytearray, block: Block, more: int, source: random.Random) -> None:
    """Correct the lengths of the blocks around a changed one, most times."""
    if source.random() < 0.8:
        for start in block.holders:
            data[start + 4 : start + BLOCK] = struct.pack("<q", struct.unpack_from("<q", data, start + 4)[0] + more)


def _odd_model(seed: bytes, source: random.Random) -> bytes:
    """Return a valid file whose objects, texts, layers or settings are not what a designer would draw."""
    import rhino3dm

    model = rhino3dm.File3dm.FromByteArray(seed)
    for _ in range(source.choice((1, 2, 4, 8))):
        source.choice((_text, _text, _layer, _setting, _delete, _move, _add, _add))(rhino3dm, model, source)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "odd.3dm"
        model.Write(str(path), source.choice((7, 8)))
        return path.read_bytes()


def _text(rhino3dm: Any, model: Any, source: random.Random) -> None:
    entry = source.choice(list(model.Objects) or [None])
    if entry is not None:
        text = source.choice((*TEXTS, str(source.choice(VALUES))))
        source.choice((entry.Geometry, entry.Attributes)).SetUserString(source.choice(KEYS), text)


def _layer(rhino3dm: Any, model: Any, source: random.Random) -> None:
    layer = source.choice(list(model.Layers) or [None])
    if layer is not None and source.random() < 0.5:
        layer.Name = source.choice(LAYERS).split("::")[-1]
        layer.SetUserString(source.choice(KEYS), source.choice(TEXTS))
    entry = source.choice(list(model.Objects) or [None])
    if entry is not None:
        entry.Attributes.LayerIndex = source.choice((-1, 0, 1, 2, 5, 10**9))


def _setting(rhino3dm: Any, model: Any, source: random.Random) -> None:
    model.Settings.ModelAbsoluteTolerance = source.choice(VALUES)
    units = ("Angstroms", "Meters", "Microns", "Miles", "Millimeters", "Parsecs", "None", "CustomUnits", "Unset")
    model.Settings.ModelUnitSystem = getattr(rhino3dm.UnitSystem, source.choice(units), rhino3dm.UnitSystem.Meters)


def _delete(rhino3dm: Any, model: Any, source: random.Random) -> None:
    entry = source.choice(list(model.Objects) or [None])
    if entry is not None:
        model.Objects.Delete(entry.Attributes.Id)


def _move(rhino3dm: Any, model: Any, source: random.Random) -> None:
    entry = source.choice(list(model.Objects) or [None])
    if entry is not None:
        change = rhino3dm.Transform(1.0)
        setattr(change, source.choice(("M00", "M11", "M22", "M03", "M23", "M33", "M30")), source.choice(VALUES))
        entry.Geometry.Transform(change)


def _add(rhino3dm: Any, model: Any, source: random.Random) -> None:
    """Add an object of odd geometry to a layer."""

    def point() -> Any:
        return rhino3dm.Point3d(*(source.choice((source.uniform(-5, 5), source.uniform(-5, 5), source.choice(VALUES))) for _ in range(3)))

    def mesh() -> Any:
        made = rhino3dm.Mesh()
        for _ in range(source.choice((0, 3, 9))):
            corner = point()
            made.Vertices.Add(corner.X, corner.Y, corner.Z)
        for _ in range(source.choice((0, 1, 8))):
            made.Faces.AddFace(*(source.choice((0, 1, 2, 3, 8, -1, 10**6)) for _ in range(source.choice((3, 4)))))
        return made

    def curve() -> Any:
        made = rhino3dm.NurbsCurve.Create(
            source.choice((True, False)), source.choice((1, 2, 3)), [point() for _ in range(source.choice((4, 9)))]
        )
        if made is not None and source.random() < 0.5:
            made.Knots[source.randrange(len(made.Knots))] = source.choice(VALUES)
        return made

    def surface() -> Any:
        made = rhino3dm.NurbsSurface.Create(3, source.choice((True, False)), 3, 3, 4, 4)
        for i in range(4):
            for j in range(4):
                corner = point()
                made.Points[i, j] = rhino3dm.Point4d(corner.X, corner.Y, corner.Z, source.choice((1.0, 1.0, *VALUES)))
        return made

    makers = (
        lambda: rhino3dm.Point(point()),
        lambda: rhino3dm.TextDot(source.choice(TEXTS), point()),
        lambda: rhino3dm.LineCurve(point(), point()),
        lambda: rhino3dm.PolylineCurve([point() for _ in range(source.choice((2, 5, 400)))]),
        lambda: rhino3dm.Circle(point(), source.choice(VALUES)).ToNurbsCurve(),
        lambda: rhino3dm.Sphere(point(), source.choice(VALUES)).ToBrep(),
        mesh,
        curve,
        surface,
    )
    made = source.choice(makers)()
    if made is not None:
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex = source.randrange(max(1, len(model.Layers)))
        for _ in range(source.choice((0, 1, 3))):
            made.SetUserString(source.choice(KEYS), source.choice(TEXTS))
        model.Objects.Add(made, attributes)
