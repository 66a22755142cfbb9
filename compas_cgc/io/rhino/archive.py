"""Archives: opening, listing and saving of .3dm files, including damaged ones."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import Union

import numpy as np

from ..._atomic_write import replacing
from ..._samples import no_file
from ...discrete.arrays import FloatArray
from ...errors import FileError
from ...model.lengths import place_text
from ._types import Archive
from ._types import Geometry

__all__ = ["Item", "box_around", "list_items", "read_archive", "rhino3dm_module", "size_of", "write_archive"]

_MAGIC = b"3D Geometry File Format "

# Trial in a child process: a damaged length, or number of dimensions of a curve, can exhaust the memory, take minutes or crash the process.
_TRIAL = """
import signal
import sys
sys.path = [entry for entry in sys.path if entry]
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[2]), int(sys.argv[2])))
    signal.setitimer(signal.ITIMER_PROF, float(sys.argv[3]))
except (ImportError, OSError, ValueError):
    pass
import rhino3dm
archive = rhino3dm.File3dm.Read(sys.argv[1])
for entry in () if archive is None else archive.Objects:
    if entry.Geometry is not None:
        entry.Geometry.GetBoundingBox()
sys.exit(0 if archive is not None else 3)
"""


# Address space of the trial [byte]: Python with rhino3dm takes 40 MB, and an intact file a multiple of its size.
TRIAL_MEMORY, TRIAL_MEMORY_PER_BYTE = 400 << 20, 100
# Processor time of the trial [s]; an intact file takes .1 s and .02 s/MB.
TRIAL_SECONDS, TRIAL_SECONDS_PER_BYTE = 1.5, 0.5e-6
TRIAL_PATIENCE = 10.0  # longest time by the clock, relative to the processor time, as on a busy computer
MAX_NESTING = 20  # levels of nested blocks


class Item(NamedTuple):
    """An object of a .3dm file."""

    geometry: Geometry
    kind: str  # mesh, curve, point, point cloud, text dot, or the class in rhino3dm
    id: str
    layer: str  # full path, such as CGC::Mesh
    name: str
    text: dict[str, str]  # user text of the object and its geometry, keys in lower case
    layer_text: dict[str, str]  # user text of its layer, keys in lower case
    hidden: bool  # whether the object or its layer is hidden

    @property
    def label(self) -> str:
        """Kind, name, place and layer of the object, for errors and notes."""
        named = f" {self.name!r}" if self.name else ""
        size = size_of(self.geometry) or 1.0  # of a point a unit
        return f"{self.kind}{named} at {place_text(box_around([self.geometry]).mean(axis=0), size)} on layer {self.layer!r}"


def box_around(geometries: Iterable[Geometry]) -> FloatArray:
    """Return the lowest and the highest corner of the box around geometries (2, 3) [L]."""
    boxes = [geometry.GetBoundingBox() for geometry in geometries]
    low = np.min([(box.Min.X, box.Min.Y, box.Min.Z) for box in boxes], axis=0)
    high = np.max([(box.Max.X, box.Max.Y, box.Max.Z) for box in boxes], axis=0)
    return np.array([low, high])


def size_of(*geometries: Geometry) -> float:
    """Return the diagonal of the box around geometries [L]."""
    low, high = box_around(geometries)
    return float(np.linalg.norm(high - low))


def rhino3dm_module() -> Any:
    """Return the rhino3dm module; raise an error if it is missing or too old for double precision."""
    try:
        import rhino3dm
    except ImportError:
        raise FileError("reading and writing .3dm files requires rhino3dm; install it: pip install 'compas_cgc[rhino]'") from None
    if not hasattr(rhino3dm.MeshVertexList, "AddPoint3d"):
        raise FileError("this version of rhino3dm keeps only seven digits; install a newer one: pip install 'rhino3dm>=8.32.1'")
    return rhino3dm


def read_archive(path: Union[str, os.PathLike]) -> Archive:
    """Return the archive in a .3dm file.

    If a Python executable is available, a child process reads the file first, so that a
    damaged file cannot crash this process.

    Raises
    ------
    FileError
        If the file does not exist or is not a complete .3dm file, or rhino3dm is missing.
    """
    name = Path(path)
    _check_frame(name)
    # First, as the child process could not tell that it is missing.
    rhino3dm = rhino3dm_module()
    _check_in_child(name)
    archive = rhino3dm.File3dm.Read(str(name))
    if archive is None:
        raise _damaged(name)
    return archive


def write_archive(archive: Archive, path: Union[str, os.PathLike], version: int = 7) -> None:
    """Save an archive as a .3dm file, atomically.

    Parameters
    ----------
    archive
        The archive.
    path
        Output file; an existing file is replaced when the new one is complete.
    version
        7 (opens in Rhino 7 and later) or 8.

    Raises
    ------
    FileError
        If the file cannot be written.
    ValueError
        If the version is neither 7 nor 8.
    """
    if version not in (7, 8):
        raise ValueError(f"version must be 7 or 8, not {version!r}")
    with replacing(path) as temporary:
        if not archive.Write(str(temporary), version):
            raise FileError(f"{path} cannot be written: rhino3dm failed; check that the disk is not full")


def list_items(archive: Archive) -> list[Item]:
    """Return the objects of an archive in their order; objects of blocks are placed by their instances."""
    layers = {}
    for layer in archive.Layers:
        layers[layer.Index] = (layer.FullPath or layer.Name, _texts(layer), bool(layer.Visible))
    objects = {str(entry.Attributes.Id): entry for entry in archive.Objects}
    blocks = {str(block.Id): [str(id) for id in block.GetObjectIds()] for block in archive.InstanceDefinitions}

    def to_item(entry: Any, geometry: Geometry, id: str) -> Item:
        attributes = entry.Attributes
        path, layer_text, visible = layers.get(attributes.LayerIndex, ("", {}, True))
        return Item(
            geometry=geometry,
            kind=_kind(geometry),
            id=id,
            layer=path,
            name=attributes.Name or "",
            text={**_texts(geometry), **_texts(attributes)},
            layer_text=layer_text,
            hidden=not (visible and attributes.Visible),
        )

    items = []
    for entry in archive.Objects:
        if entry.Geometry is not None and not entry.Attributes.IsInstanceDefinitionObject:
            placed = _placed(entry, objects, blocks)
            # Objects in a block get the id of the instance and a counter, as a block can have several instances.
            names = [str(entry.Attributes.Id)] + [f"{entry.Attributes.Id} ({k})" for k in range(2, len(placed) + 1)]
            items += [to_item(own, geometry, id) for (own, geometry), id in zip(placed, names)]
    return items


def _placed(entry: Any, objects: dict[str, Any], blocks: dict[str, list[str]], depth: int = 0) -> list[tuple[Any, Geometry]]:
    """Return an object, or the objects of a block instance with transformed geometry."""
    geometry = entry.Geometry
    if type(geometry).__name__ != "InstanceReference":
        return [(entry, geometry)]
    inside = [objects[id] for id in blocks.get(str(geometry.ParentIdefId), []) if id in objects]
    if not inside or depth >= MAX_NESTING:
        return [(entry, geometry)]
    found = []
    for own, shape in (pair for part in inside if part.Geometry is not None for pair in _placed(part, objects, blocks, depth + 1)):
        moved = shape.Duplicate()
        if moved is not None and moved.Transform(geometry.Xform):
            found.append((own, moved))
    return found


def _kind(geometry: Geometry) -> str:
    rhino3dm = rhino3dm_module()

    kinds = (
        (rhino3dm.Mesh, "mesh"),
        (rhino3dm.Curve, "curve"),
        (rhino3dm.PointCloud, "point cloud"),
        (rhino3dm.Point, "point"),
        (rhino3dm.TextDot, "text dot"),
    )
    return next((name for kind, name in kinds if isinstance(geometry, kind)), type(geometry).__name__)


def _texts(thing: Geometry) -> dict[str, str]:
    return {key.strip().casefold(): value for key, value in thing.GetUserStrings() or ()}


def _damaged(path: Path) -> FileError:
    return FileError(f"{path} is damaged; open it in Rhino (the command Rescue3dmFile may help) and save it again")


def _check_frame(path: Path) -> None:
    """Check the magic word at the beginning of a file, and the end mark with its length."""
    if path.is_dir():
        raise FileError(f"{path} is a folder; give the path of a .3dm file in it")
    try:
        with open(path, "rb") as file:
            head = file.read(32)
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - 20))
            tail = file.read(20)
    except FileNotFoundError:
        raise FileError(no_file(path)) from None
    except OSError as error:
        raise FileError(f"{path} cannot be read ({error.strerror})") from None
    if not head.startswith(_MAGIC):
        what = "is empty" if size == 0 else "is not a Rhino file, despite its suffix"
        raise FileError(f"{path} {what}; give a .3dm file saved by Rhino or compas_cgc")
    version = head[24:32].strip()
    if version == b"1":
        # Archives of Rhino 1 have no end mark, so completeness cannot be checked.
        raise FileError(f"{path} was saved by Rhino 1; open it in a newer Rhino and save it again")
    if version.isdigit() and int(version) >= 50:
        code, _, length = struct.unpack("<IQQ", tail) if len(tail) == 20 else (0, 0, 0)
    else:
        code, _, length = struct.unpack("<III", tail[-12:]) if len(tail) >= 12 else (0, 0, 0)
    if code != 0x7FFF or length != size:
        raise FileError(f"{path} is incomplete: its end is missing or wrong; copy it again or save it again from Rhino")


def _check_in_child(path: Path) -> None:
    """Read the file in a child process with limited memory and time."""
    if not os.path.basename(sys.executable or "").lower().startswith(("python", "pypy")):
        return  # Inside Rhino the executable is Rhino.
    size = path.stat().st_size
    memory, seconds = TRIAL_MEMORY + TRIAL_MEMORY_PER_BYTE * size, TRIAL_SECONDS + TRIAL_SECONDS_PER_BYTE * size
    command = [sys.executable, "-c", _TRIAL, str(path.resolve()), str(memory), str(seconds)]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=TRIAL_PATIENCE * seconds)
    except subprocess.TimeoutExpired:
        raise _damaged(path) from None
    except OSError:
        return
    if done.returncode != 0:
        raise _damaged(path)
