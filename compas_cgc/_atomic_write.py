"""Atomic writes: files are written beside their targets and take their places together, complete and on the disk."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import signal
import socket
import sys
import tempfile
import threading
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from contextlib import suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Optional
from typing import Union

from .errors import CGCError
from .errors import FileError

__all__ = [
    "PartlyPublished",
    "end_process",
    "further_outputs",
    "is_full",
    "published_together",
    "recover",
    "replacing",
    "unwritable",
    "write_text",
]

# The umask can only be read by setting it, which is not safe when threads write files.
_UMASK = os.umask(0)
os.umask(_UMASK)

_HOST = f"{zlib.crc32(socket.gethostname().encode()):08x}"  # a process id says nothing about processes of another machine
_TEMPORARY = re.compile(r"\..*\.cgc-([0-9a-f]{8})-(\d+)-\w+(?:\.\w+)*")
_JOURNAL = re.compile(r"\.cgc-([0-9a-f]{8})-(\d+)-\w+\.journal")


class PartlyPublished(FileError):
    """Some outputs, but not the first, could not be written to their targets."""


class _Outputs:
    """Complete temporary files beside their targets, in the order of writing."""

    def __init__(self) -> None:
        self.files: list[tuple[Path, Path]] = []  # temporary file and target
        self.failures: list[str] = []  # reasons why other files could not be written

    def publish(self) -> None:
        """Rename all files to their targets; a journal lets the next command finish after a kill."""
        try:
            journal = self._journal() if len(self.files) > 1 else None
        except OSError as error:
            first = self.files[0][1]
            self.discard()
            raise OSError(error.errno, error.strerror, str(first)) from error
        for place, (temporary, target) in enumerate(self.files):
            try:
                _put(temporary, target)
            except OSError as error:
                if not place:
                    self.discard()
                    if journal is not None:
                        journal.unlink()
                    raise
                self.failures.append(unwritable(target, error))
        for folder in {target.parent for _, target in self.files}:
            _sync_folder(folder)
        if journal is not None:
            journal.unlink()
        self.discard()
        if self.failures:
            raise PartlyPublished("; ".join(self.failures))

    def discard(self, count: int = 0) -> None:
        """Remove the remaining temporary files, except for the first `count` ones."""
        for temporary, _ in self.files[count:]:
            with suppress(OSError):
                temporary.unlink()
        del self.files[count:]

    def _journal(self) -> Path:
        """Write the list of files atomically beside the first target."""
        folder = self.files[0][1].parent
        handle, name = tempfile.mkstemp(prefix=f".cgc-{_HOST}-{os.getpid()}-", suffix=".journal-new", dir=folder)
        journal = Path(name).with_suffix(".journal")
        try:
            with open(handle, "w", encoding="utf-8") as file:
                json.dump([[str(temporary), str(target)] for temporary, target in self.files], file)
                file.flush()
                os.fsync(file.fileno())
            os.replace(name, journal)
        except OSError:
            os.unlink(name)
            raise
        _sync_folder(folder)
        return journal


_outputs: ContextVar[Optional[_Outputs]] = ContextVar("_outputs", default=None)
_endings: list[SystemExit] = []  # exceptions of signals that end this process


def end_process(code: int) -> None:
    """Raise SystemExit; if a library turns it into another error, as imports of extension modules do, nothing is published any more."""
    _endings.append(SystemExit(code))
    raise _endings[-1]


@contextmanager
def published_together() -> Iterator[None]:
    """Publish all files written within a block together if it ends without error, and none of them otherwise.

    Files are renamed to their targets in the order of writing. Signals are delayed until this is complete. After a kill in between,
    the next command that accesses the folder completes it.

    Raises
    ------
    PartlyPublished
        If a file other than the first cannot be renamed to its target, or those of :func:`further_outputs` cannot be written; the
        others are published.
    FileError
        If the first file cannot be renamed to its target; no file is published.
    """
    if _outputs.get() is not None:
        yield
        return
    outputs = _Outputs()
    token = _outputs.set(outputs)
    try:
        yield
        if _endings:
            raise _endings[-1]
    except BaseException:
        outputs.discard()
        raise
    finally:
        _outputs.reset(token)
    with _signals_held():
        try:
            outputs.publish()
        except OSError as error:
            raise FileError(unwritable(error.filename2 or error.filename, error)) from None


@contextmanager
def further_outputs() -> Iterator[None]:
    """Leave out the files written within a block if it fails, so that the other files of :func:`published_together` are published.

    The reason is raised as :class:`PartlyPublished` when these are in their places.
    """
    outputs = _outputs.get()
    if outputs is None:
        raise RuntimeError("further outputs need published_together around them")
    count = len(outputs.files)
    try:
        yield
    except (CGCError, OSError) as error:
        outputs.discard(count)
        outputs.failures.append(str(error))


@contextmanager
def replacing(path: Union[str, os.PathLike]) -> Iterator[Path]:
    """Yield the path of a temporary file, which is renamed to `path` if the block ends without error.

    If the block raises, the temporary file is removed and `path` is unchanged. The temporary file has the suffix of `path`, on which
    some writers depend. Links are followed; a device or pipe at `path` receives the content instead of being replaced. Within
    :func:`published_together`, the file is renamed at the end of that block.

    Raises
    ------
    FileError
        If the file cannot be written, `path` is a folder, or another file of :func:`published_together` has the same path.
    """
    if os.path.isdir(path):
        raise FileError(f"{path} is a folder; give the path of a file in it")
    try:
        with _replacing(path) as temporary:
            yield temporary
    except OSError as error:
        raise FileError(unwritable(path, error)) from None


@contextmanager
def _replacing(path: Union[str, os.PathLike]) -> Iterator[Path]:
    special = os.path.exists(path) and not os.path.isfile(path)
    target = Path(path) if special else Path(os.path.realpath(path))
    together = _outputs.get()
    if not special and together is not None and any(target == other for _, other in together.files):
        raise FileError(f"two outputs would be written to {path}; give one of them another name")
    folder = Path(tempfile.gettempdir()) if special else target.parent
    folder.mkdir(parents=True, exist_ok=True)
    recover(folder)
    handle, name = tempfile.mkstemp(prefix=f".{target.stem[:100]}.cgc-{_HOST}-{os.getpid()}-", suffix=target.suffix, dir=folder)
    os.close(handle)
    temporary = Path(name)
    outputs = _Outputs() if together is None else together
    try:
        yield temporary
        os.chmod(temporary, target.stat().st_mode if target.is_file() else 0o666 & ~_UMASK)
        # Flush the content to the disk before the rename.
        with open(temporary, "r+b") as file:
            os.fsync(file.fileno())
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    outputs.files.append((temporary, target))
    if together is None:
        with _signals_held():
            outputs.publish()


def unwritable(path: Union[str, os.PathLike], error: OSError) -> str:
    """Return a sentence on a file that cannot be written, with the remedy."""
    usual = "close it in other programs, or choose another name or folder"
    mend = "free space on the disk, or choose another folder" if is_full(error) else usual
    return f"{path} cannot be written ({error.strerror or error}); {mend}"


def is_full(error: OSError) -> bool:
    """Check whether an error is caused by a full disk or a used-up quota."""
    return error.errno in (errno.ENOSPC, getattr(errno, "EDQUOT", None))


def write_text(path: Union[str, os.PathLike], text: str) -> None:
    """Write a text file in UTF-8 with LF line ends."""
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8"))


def recover(folder: Path) -> None:
    """Complete interrupted publications of killed processes of this machine in a folder, and remove their temporary files."""
    try:
        names = [entry.name for entry in os.scandir(folder) if entry.name.startswith(".") and ".cgc-" in entry.name]
    except OSError:
        return
    for name in names:
        found = _JOURNAL.fullmatch(name)
        if found and _is_gone(found):
            with suppress(OSError, ValueError):
                for temporary, target in json.loads((folder / name).read_text(encoding="utf-8")):
                    if _belongs(Path(temporary), Path(target), folder / name):
                        _put(Path(temporary), Path(target))
                (folder / name).unlink()
    for name in names:
        found = _TEMPORARY.fullmatch(name) or re.fullmatch(r"\.cgc-([0-9a-f]{8})-(\d+)-\w+\.journal-new", name)
        if found and _is_gone(found):
            with suppress(OSError):
                (folder / name).unlink()


def _belongs(temporary: Path, target: Path, journal: Path) -> bool:
    """Check whether a file in a journal is still to be published and was not replaced by another file."""
    named = _TEMPORARY.fullmatch(temporary.name)
    if not named or temporary.parent != target.parent or not temporary.is_file() or temporary.is_symlink():
        return False
    return sys.platform == "win32" or temporary.stat().st_uid == journal.stat().st_uid == os.getuid()


def _is_gone(found: re.Match[str]) -> bool:
    """Check whether the process that created a file ran on this machine and has ended."""
    host, process = found.group(1), int(found.group(2))
    if host != _HOST or process == os.getpid():
        return False
    if sys.platform == "win32":
        return False  # on Windows, os.kill would end the process
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except OSError:
        pass
    return False


def _put(temporary: Path, target: Path) -> None:
    if target.exists() and not target.is_file():
        with open(temporary, "rb") as content, open(target, "wb") as device:
            shutil.copyfileobj(content, device)
        temporary.unlink()
    else:
        os.replace(temporary, target)


def _sync_folder(folder: Path) -> None:
    """Flush the names in a folder to the disk, if the system supports it."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def _signals_held() -> Iterator[None]:
    """Delay signals that end the process until the end of a block."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
