"""Component manifest: a checked folder with code, metadata and an icon."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from typing import Optional
from uuid import UUID

from ...errors import FileError
from .guids import HINTS
from .guids import own_guid
from .placeholders import filled
from .signature import signature_problems

__all__ = ["ACCESS", "Bundle", "Parameter", "read_bundle", "read_bundles", "sources_folder"]

ACCESS = ("item", "list", "tree")
EXPOSURES = (-1, 2, 4, 8, 16, 32, 64, 128)

# Keys and the types of their values; keys with a default are optional.
COMPONENT_KEYS = {"name": str, "nickname": str, "category": str, "subcategory": str, "description": str, "exposure": int, "ghpython": dict}
GHPYTHON_KEYS = {"iconDisplay": int, "marshalGuids": bool, "inputParameters": list, "outputParameters": list}
INPUT_KEYS = {"name": str, "description": str, "typeHintID": str, "scriptParamAccess": str, "optional": bool}
OUTPUT_KEYS = {"name": str, "description": str}
OPTIONAL = {"exposure", "iconDisplay", "marshalGuids", "scriptParamAccess", "optional"}


@dataclass(frozen=True)
class Parameter:
    """An input or output of a component."""

    name: str
    description: str
    hint: str = "none"  # a name in HINTS
    access: str = "item"  # a name in ACCESS
    optional: bool = True


@dataclass(frozen=True)
class Bundle:
    """Sources of a component."""

    key: str  # name of the folder and of the user object file
    name: str
    nickname: str
    category: str
    subcategory: str
    description: str
    exposure: int
    icon_display: int
    marshal_guids: bool
    inputs: tuple[Parameter, ...]
    outputs: tuple[Parameter, ...]
    code: str
    icon: bytes

    @property
    def guid(self) -> UUID:
        """GUID of the user object."""
        return own_guid("component", self.key)


def sources_folder() -> Path:
    """Return the folder with the component bundles: inside the installed package, or beside it in a clone.

    Raises
    ------
    FileError
        If neither folder exists.
    """
    package = Path(__file__).resolve().parents[2]
    for parent in (package, package.parent):
        if (parent / "ghuser" / "components").is_dir():
            return parent / "ghuser" / "components"
    raise FileError(f"the components are neither in {package} nor beside it; reinstall compas_cgc, or give their folder with --source")


def read_bundles(folder: Optional[Path] = None) -> list[Bundle]:
    """Read all bundles of a folder, in the order of their names.

    Raises
    ------
    FileError
        If there are no bundles, or one is invalid.
    """
    folder = sources_folder() if folder is None else Path(folder)
    bundles = [read_bundle(path.parent) for path in sorted(folder.glob("*/metadata.json"))]
    if not bundles:
        raise FileError(f"there are no components in {folder}; a component is a folder with code.py, metadata.json and icon.png")
    return bundles


def read_bundle(folder: Path) -> Bundle:
    """Read a bundle.

    Raises
    ------
    FileError
        If a file is missing, a key is unknown, missing or of the wrong type, a placeholder is
        unknown, or the code does not match the inputs in the metadata.
    """
    try:
        code = filled((folder / "code.py").read_text(encoding="utf-8"))
        data = filled(json.loads((folder / "metadata.json").read_text(encoding="utf-8")))
        icon = (folder / "icon.png").read_bytes()
    except (OSError, ValueError) as error:
        raise FileError(f"{folder.name}: {error}") from None
    problems = _problems(data)
    sides = [] if problems else [data["ghpython"][side] for side in ("inputParameters", "outputParameters")]
    if sides:
        problems = signature_problems(code, *([row["name"] for row in rows] for rows in sides))
    if icon[:8] != b"\x89PNG\r\n\x1a\n" or icon[16:24] != b"\0\0\0\x18" * 2:
        problems.append("icon.png must be a PNG of 24 x 24 pixels")
    if problems:
        raise FileError("; ".join(f"{folder.name}: {problem}" for problem in problems))
    return Bundle(
        key=folder.name,
        name=data["name"],
        nickname=data["nickname"],
        category=data["category"],
        subcategory=data["subcategory"],
        description=data["description"],
        exposure=data.get("exposure", 2),
        icon_display=data["ghpython"].get("iconDisplay", 2),
        marshal_guids=data["ghpython"].get("marshalGuids", True),
        inputs=tuple(map(_parameter, sides[0])),
        outputs=tuple(map(_parameter, sides[1])),
        code=code,
        icon=icon,
    )


def _parameter(row: dict) -> Parameter:
    hint, access = row.get("typeHintID", "none"), row.get("scriptParamAccess", "item")
    return Parameter(row["name"], row["description"], hint, access, row.get("optional", True))


def _problems(data: Any) -> list[str]:
    problems = _keys("metadata.json", data, COMPONENT_KEYS)
    if problems:
        return problems
    problems = _keys("ghpython", data["ghpython"], GHPYTHON_KEYS)
    if problems:
        return problems
    if data.get("exposure", 2) not in EXPOSURES:
        problems.append(f"exposure must be one of {EXPOSURES}, not {data['exposure']}")
    for side, keys in (("inputParameters", INPUT_KEYS), ("outputParameters", OUTPUT_KEYS)):
        rows = data["ghpython"][side]
        found = [problem for i, row in enumerate(rows) for problem in _keys(f"{side} {i}", row, keys)]
        problems += found or [problem for row in rows for problem in _row_problems(row)]
        names = [row["name"] for row in rows] if not found else []
        problems += [f"{side} has {name!r} twice" for name in sorted(set(names)) if names.count(name) > 1]
    return problems


def _row_problems(row: dict) -> list[str]:
    problems = []
    if not row["name"].isidentifier():
        problems.append(f"the parameter {row['name']!r} must be a valid name of a variable")
    if row.get("typeHintID", "none") not in HINTS:
        problems.append(f"the type hint {row['typeHintID']!r} of {row['name']} is none of {', '.join(HINTS)}")
    if row.get("scriptParamAccess", "item") not in ACCESS:
        problems.append(f"scriptParamAccess of {row['name']} must be one of {', '.join(ACCESS)}, not {row['scriptParamAccess']!r}")
    return problems


def _keys(where: str, data: object, keys: dict) -> list[str]:
    if not isinstance(data, dict):
        return [f"{where} must be an object"]
    problems = [f"{where} has the unknown key {key!r}" for key in data if key not in keys]
    problems += [f"{where} has no key {key!r}" for key in keys if key not in data and key not in OPTIONAL]
    # A boolean is an integer in Python, but not in the file.
    wrong = [key for key, kind in keys.items() if key in data and type(data[key]) is not kind]
    return problems + [f"{key!r} of {where} must be of type {keys[key].__name__}, not {data[key]!r}" for key in wrong]
