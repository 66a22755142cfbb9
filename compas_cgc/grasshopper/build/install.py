"""Installation of user objects for Rhino 8."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Optional

from ..._atomic_write import replacing
from ...errors import FileError
from .userobject import is_ours

__all__ = ["install", "uninstall", "user_objects_folder"]

# On macOS, the name of the settings folder contains the id of the plug-in.
MAC = "Library/Application Support/McNeel/Rhinoceros/8.0/Plug-ins/Grasshopper (b45a29b1-4343-4035-989e-044e8580d9cf)"


def user_objects_folder(system: Optional[str] = None, environment: Optional[Mapping[str, str]] = None) -> Path:
    """Return Grasshopper's folder of user objects.

    Parameters
    ----------
    system
        Name of the system as in :func:`platform.system`. Default: this system.
    environment
        Environment variables. Default: those of the process.

    Raises
    ------
    FileError
        If Grasshopper has no settings folder on this machine.
    """
    system = system or platform.system()
    environment = os.environ if environment is None else environment
    if system == "Windows":
        settings = Path(environment.get("APPDATA", "")) / "Grasshopper"
    elif system == "Darwin":
        settings = Path(environment.get("HOME", "")) / MAC
    else:
        raise FileError("Rhino 8 runs on Windows and macOS only; choose a folder with --to, and copy its files")
    if not settings.is_dir():
        raise FileError(f"Grasshopper has no folder {settings}; start Rhino 8 and Grasshopper once, or choose a folder with --to")
    return settings / "UserObjects"


def install(files: Mapping[str, bytes], folder: Path, dry_run: bool = False) -> tuple[list[Path], list[Path]]:
    """Install user objects in a folder, and remove older ones of this package.

    Parameters
    ----------
    files
        User objects by file name.
    folder
        Grasshopper's folder.
    dry_run
        Whether to only report the changes.

    Returns
    -------
    written, removed

    Raises
    ------
    FileError
        If a file with the same name does not belong to this package.
    """
    ours = _ours(folder)
    for name in files:
        if (folder / name).exists() and folder / name not in ours:
            raise FileError(f"{folder / name} does not belong to compas_cgc; move it to another folder")
    written = [folder / name for name in sorted(files)]
    removed = [path for path in ours if path.name not in files]
    if not dry_run:
        for path in written:
            with replacing(path) as temporary:
                temporary.write_bytes(files[path.name])
        for path in removed:
            path.unlink()
    return written, removed


def uninstall(folder: Path, dry_run: bool = False) -> list[Path]:
    """Remove the user objects of this package from a folder, and return their paths."""
    removed = _ours(folder)
    if not dry_run:
        for path in removed:
            path.unlink()
    return removed


def _ours(folder: Path) -> list[Path]:
    return [path for path in sorted(Path(folder).glob("CGC_*.ghuser")) if is_ours(path.read_bytes())]
