"""Keys of a server: names, roles, and rate limit of wrong keys."""

from __future__ import annotations

import hashlib
import hmac
import re
import sys
import threading
import time
from collections import OrderedDict
from collections.abc import Iterator
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union

from ..errors import CGCError

__all__ = ["LOCAL", "OPERATOR", "ROLES", "USER", "Key", "Keys", "Throttle", "read_keys"]

USER, OPERATOR = "user", "operator"
ROLES = (USER, OPERATOR)
NAME = re.compile(r"[A-Za-z0-9_-]{1,40}")
MIN_LENGTH = 8  # characters of a key
ATTEMPTS, WINDOW = 20, 60.0  # number of wrong keys of one address within a time [s] above which the address is blocked
MAX_ADDRESSES = 10_000  # number of addresses whose wrong keys are counted


class Key(NamedTuple):
    """A key and its owner."""

    name: str  # name of the owner
    role: str
    digest: bytes  # SHA-256 of the key


LOCAL = Key("", OPERATOR, b"")
"""Owner of everything on a server without keys, or with a single key without a name."""


class Keys(Sequence):
    """Keys that a server accepts.

    Parameters
    ----------
    keys
        None, one key, several keys, or named keys. A single key without a name belongs to the operator, the only owner. Each of
        several keys without names belongs to a user named by the hash of the key.

    Raises
    ------
    CGCError
        If a key is too short or has characters other than printable ASCII.
    """

    def __init__(self, keys: Union[None, str, Sequence[str], Sequence[Key]] = None):
        texts: tuple[Any, ...] = () if not keys else (keys,) if isinstance(keys, str) else tuple(keys)
        self._keys = tuple(key if isinstance(key, Key) else _nameless(key, len(texts) == 1) for key in texts)

    def __len__(self) -> int:
        return len(self._keys)

    def __iter__(self) -> Iterator[Key]:
        return iter(self._keys)

    def __getitem__(self, index: Any) -> Any:
        return self._keys[index]

    def find(self, compute: str, authorization: str) -> Optional[Key]:
        """Return the key in the header RhinoComputeKey or Authorization, None if neither holds a valid key."""
        given = [hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest() for text in _texts(compute, authorization)]
        # Compare all keys, so that the time does not depend on the key.
        found = [key for key in self._keys for digest in given if hmac.compare_digest(digest, key.digest)]
        return found[0] if found else None


def read_keys(path: Union[str, Path]) -> Keys:
    """Read a file of keys.

    Parameters
    ----------
    path
        A .toml file with a table for each owner: ``[anna]``, ``key = "..."`` or ``sha256 = "..."``, ``role = "user"`` or ``"operator"``.

    Raises
    ------
    CGCError
        If the file cannot be read, or an entry is invalid.
    """
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib
    try:
        found = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        raise CGCError(f"the file of keys {path} cannot be read ({error})") from None
    if not found:
        raise CGCError(f"{path} holds no key; add a table for each owner, such as [anna] with key and role")
    keys = [_named(path, name, entry) for name, entry in found.items()]
    if len({key.digest for key in keys}) < len(keys):
        raise CGCError(f"{path}: two owners have the same key; use a different key for each")
    return Keys(keys)


def _named(path: Union[str, Path], name: str, entry: object) -> Key:
    if not NAME.fullmatch(name):
        raise CGCError(f"{path}: the name {name!r:.60} must be 1 to 40 letters, digits, - or _")
    if not isinstance(entry, dict) or set(entry) - {"key", "sha256", "role"} or ("key" in entry) == ("sha256" in entry):
        raise CGCError(f"{path}: [{name}] must hold key or sha256, and role")
    role = entry.get("role", USER)
    if role not in ROLES:
        raise CGCError(f"{path}: the role of {name} must be {' or '.join(ROLES)}, not {role!r:.40}")
    if "key" in entry:
        return Key(name, role, _digest(entry["key"]))
    text = entry["sha256"]
    if not isinstance(text, str) or not re.fullmatch(r"[0-9a-f]{64}", text):
        raise CGCError(f"{path}: sha256 of {name} must be 64 hexadecimal digits in lower case")
    return Key(name, role, bytes.fromhex(text))


def _nameless(text: str, single: bool) -> Key:
    digest = _digest(text)
    return LOCAL._replace(digest=digest) if single else Key(f"key-{digest.hex()[:8]}", USER, digest)


def _digest(text: object) -> bytes:
    if not isinstance(text, str) or len(text) < MIN_LENGTH or not text.isascii() or not text.isprintable() or " " in text:
        raise CGCError(f"the key must have at least {MIN_LENGTH} printable ASCII characters and no spaces")
    return hashlib.sha256(text.encode()).digest()


def _texts(compute: str, authorization: str) -> list[str]:
    """Return the keys in the headers RhinoComputeKey and Authorization."""
    scheme, _, bearer = authorization.partition(" ")
    return [text for text in (compute, bearer.strip() if scheme.lower() == "bearer" else "") if text]


class Throttle:
    """Counter of wrong keys by address.

    Parameters
    ----------
    attempts, window
        Number of wrong keys within a time [s] above which an address is blocked.
    """

    def __init__(self, attempts: int = ATTEMPTS, window: float = WINDOW):
        self._attempts, self._window = attempts, window
        self._wrong: OrderedDict[str, list[float]] = OrderedDict()
        self._lock = threading.Lock()

    def pause(self, address: str) -> float:
        """Return the time until an address is no longer blocked [s], 0 if it is not blocked."""
        with self._lock:
            times = self._recent(address)
            return times[-self._attempts] + self._window - time.monotonic() if len(times) >= self._attempts else 0.0

    def add(self, address: str) -> None:
        """Count a wrong key."""
        with self._lock:
            self._wrong[address] = [*self._recent(address), time.monotonic()]
            self._wrong.move_to_end(address)
            if len(self._wrong) > MAX_ADDRESSES:
                self._wrong.popitem(last=False)

    def _recent(self, address: str) -> list[float]:
        since = time.monotonic() - self._window
        return [moment for moment in self._wrong.get(address, ()) if moment > since]
