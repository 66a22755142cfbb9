"""Backup and restore of a store."""

from __future__ import annotations

import os
import shutil
import sqlite3
import tempfile
import time
from contextlib import closing
from contextlib import suppress
from pathlib import Path
from typing import Union

from ...errors import FileError
from .blobs import blob_name
from .store import DESIGN
from .store import INLINE
from .store import REQUEST
from .store import RESULT
from .store import design_blob
from .store import locked
from .store import siblings

__all__ = ["backup_store", "restore_store"]

TABLES = "jobs.sqlite"
FILES = f"{TABLES}-files"
ROUNDS = 10  # number of copies of the tables after which a file that they name counts as lost
PARTS = ("", "-wal", "-shm", "-files")


def backup_store(store: Union[str, Path], folder: Union[str, Path]) -> int:
    """Copy a store into a new folder; a server may use it meanwhile.

    Parameters
    ----------
    store
        The file with the jobs.
    folder
        The backup. It must not exist, and appears when it is complete.

    Returns
    -------
    int
        Number of jobs.

    Raises
    ------
    FileError
        If the store is missing or damaged, or the folder exists or cannot be written.
    """
    source, target = Path(store), Path(folder)
    if not source.is_file():
        raise FileError(f"there is no store {source}; give the file that the server uses with --store")
    if target.exists():
        raise FileError(f"{target} exists; give the name of a new folder")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
        try:
            count = _copy(source, temporary)
            os.replace(temporary, target)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except (sqlite3.Error, OSError) as error:
        raise FileError(f"{source} cannot be copied to {target} ({error})") from None
    return count


def _copy(source: Path, folder: Path) -> int:
    """Copy tables and files until all files that the tables name are there."""
    files = folder / FILES
    files.mkdir(mode=0o700)
    sizes: dict[str, int] = {}
    count = 0
    for _ in range(ROUNDS):
        with (
            closing(sqlite3.connect(f"{source.resolve().as_uri()}?mode=ro", uri=True)) as base,
            closing(sqlite3.connect(folder / TABLES)) as copy,
        ):
            base.backup(copy)
            _check(copy)
            sizes = _sizes(copy)
            count = copy.execute("SELECT count(*) FROM jobs").fetchone()[0]
        # A file is written before the tables name it, and deleted after they no longer do.
        for name in _missing(files, sizes):
            with suppress(FileNotFoundError):
                shutil.copyfile(siblings(source, "-files") / name, files / name)
        if not _missing(files, sizes):
            break
    for path in files.iterdir():
        if path.name not in sizes:
            path.unlink()
    return count


def _missing(files: Path, sizes: dict[str, int]) -> list[str]:
    return [name for name, size in sizes.items() if not (files / name).exists() or (files / name).stat().st_size != size]


def restore_store(folder: Union[str, Path], store: Union[str, Path]) -> list[Path]:
    """Put a backup in the place of a store that no server uses.

    Parameters
    ----------
    folder
        The backup.
    store
        The file with the jobs. An existing one is renamed.

    Returns
    -------
    list of Path
        New names of the files of the existing store.

    Raises
    ------
    FileError
        If the backup is incomplete or damaged, or a server uses the store.
    """
    source, target = Path(folder), Path(store)
    if not (source / TABLES).is_file() or not (source / FILES).is_dir():
        raise FileError(f"{source} is not a backup of a store; give a folder that compas-cgc backup has written")
    try:
        owner = locked(target)
    except (sqlite3.Error, OSError) as error:
        raise FileError(f"{target} cannot be replaced ({error}); stop the server first") from None
    new = [siblings(target, f".restored{part}") for part in ("", "-files")]
    try:
        shutil.copyfile(source / TABLES, new[0])
        os.chmod(new[0], 0o600)
        with closing(sqlite3.connect(new[0])) as base:
            _check(base)
        shutil.rmtree(new[1], ignore_errors=True)
        shutil.copytree(source / FILES, new[1])
        stamp = time.strftime("%Y%m%d-%H%M%S")
        aside = []
        for part in PARTS:
            if siblings(target, part).exists():
                aside.append(siblings(target, f".replaced-{stamp}{part}"))
                os.replace(siblings(target, part), aside[-1])
        # The tables last: a server that starts without them would delete the files.
        os.replace(new[1], siblings(target, "-files"))
        os.replace(new[0], target)
    except (sqlite3.Error, OSError) as error:
        raise FileError(f"{source} cannot be restored to {target} ({error})") from None
    finally:
        new[0].unlink(missing_ok=True)
        shutil.rmtree(new[1], ignore_errors=True)
        owner.close()
    return aside


def _check(base: sqlite3.Connection) -> None:
    found = base.execute("PRAGMA quick_check(1)").fetchone()[0]
    if found != "ok":
        raise sqlite3.DatabaseError(found)


def _sizes(base: sqlite3.Connection) -> dict[str, int]:
    """Return the sizes of large requests, results and designs by the names of their files."""
    requests = base.execute("SELECT id, bytes FROM requests JOIN sizes USING (id) WHERE bytes > ?", (INLINE,)).fetchall()
    results = base.execute("SELECT id, size FROM results JOIN jobs USING (id) WHERE size > ?", (INLINE,)).fetchall()
    designs = base.execute("SELECT id, revision, bytes FROM designs WHERE bytes > ?", (INLINE,)).fetchall()
    kept = [(design_blob(id, revision), size) for id, revision, size in designs]
    return {blob_name(kind, id): size for kind, rows in ((REQUEST, requests), (RESULT, results), (DESIGN, kept)) for id, size in rows}
