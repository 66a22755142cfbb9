"""Build of all Grasshopper files from the sources."""

from __future__ import annotations

from pathlib import Path
from typing import Optional

from ..._atomic_write import replacing
from ...errors import FileError
from .archive import definition_problems
from .archive import from_bytes
from .archive import from_xml
from .archive import to_bytes
from .archive import to_xml
from .component_manifest import read_bundles
from .component_manifest import sources_folder
from .definition import EXAMPLES
from .definition import definition_archive
from .definition import definition_svg
from .package_source import with_package
from .userobject import user_object
from .yak import yak_bytes
from .yak import yak_name

__all__ = ["build_all", "built_files", "user_object_files"]


def user_object_files(source: Optional[Path] = None, package: Optional[str] = None) -> dict[str, bytes]:
    """Return the user objects by file name.

    Raises
    ------
    FileError
        If a component is invalid, or there is no wheel at `package`, see :func:`~.package_source.requirement`.
    """
    return {f"{bundle.key}.ghuser": to_bytes(user_object(bundle)) for bundle in with_package(read_bundles(source), package)}


def built_files(source: Optional[Path] = None, package: Optional[str] = None) -> dict[str, bytes]:
    """Return user objects, example definitions, their pictures and the package by path, deterministically.

    Raises
    ------
    FileError
        If a component is invalid, or a definition cannot be read back without loss.
    """
    users = user_object_files(source, package)
    files = {f"components/{name}": data for name, data in users.items()}
    files.update(_definitions(source, package))
    icon = _icon((source or sources_folder()).parent / "icon.png")
    examples = {f"examples/{Path(name).name}": data for name, data in files.items() if name.endswith(".gh")}
    files[yak_name()] = yak_bytes({**users, **examples, "icon.png": icon})
    return files


def build_all(folder: Path, source: Optional[Path] = None, package: Optional[str] = None) -> list[Path]:
    """Write all files below a folder, and return their paths.

    Raises
    ------
    FileError
        As :func:`built_files`.
    """
    paths = []
    for name, data in built_files(source, package).items():
        path = Path(folder) / name
        with replacing(path) as temporary:
            temporary.write_bytes(data)
        paths.append(path)
    return paths


def _definitions(source: Optional[Path], package: Optional[str]) -> dict[str, bytes]:
    bundles = {bundle.key: bundle for bundle in with_package(read_bundles(source), package)}
    files = {}
    for definition in EXAMPLES:
        root = definition_archive(definition, bundles)
        binary, text = to_bytes(root), to_xml(root)
        problems = definition_problems(root)
        if problems or from_bytes(binary) != root or from_xml(text) != root:
            raise FileError(f"{definition.name}: {'; '.join(problems) or 'it cannot be read back without loss'}")
        files[f"definitions/{definition.name}.gh"] = binary
        files[f"definitions/{definition.name}.ghx"] = text
        files[f"definitions/{definition.name}.svg"] = definition_svg(root).encode("utf-8")
    return files


def _icon(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise FileError(f"the icon of the package {path} cannot be read ({error.strerror}); put a PNG file there") from None
