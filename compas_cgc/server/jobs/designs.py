"""Designs of clients and links to them, in the store of the jobs."""

from __future__ import annotations

import hashlib
import re
import secrets
import time
from collections.abc import Iterable
from typing import NamedTuple
from typing import Optional

from ..errors import Conflict
from ..errors import NoRoom
from ..errors import NotFound
from ..errors import Unprocessable
from ..limits import Limits
from .store import DESIGN
from .store import Store
from .store import design_blob
from .store import owned_id

__all__ = ["MODES", "Design", "Designs", "Link", "shared"]

MODES = ("copy", "view")
LONGEST_NAME = 100  # characters
_ID = re.compile(r"[A-Za-z0-9_-]{8,64}")


class Design(NamedTuple):
    """A stored design, without its content."""

    id: str
    name: str
    revision: int  # counted from 1
    changed: float  # seconds since 1970
    bytes: int


class Link(NamedTuple):
    """A link to a design, without its token."""

    id: str
    mode: str  # copy, or view only
    created: float  # seconds since 1970


class Designs:
    """The designs of one owner.

    The content is opaque to the server. A design is replaced only by who knows its newest revision, so that no change is lost when two
    clients have the same design open.

    Parameters
    ----------
    store
        Where they are kept.
    owner
        Name of the owner, empty for the only one of a server without keys.
    limits
        Limits of the server.
    """

    def __init__(self, store: Store, owner: str, limits: Limits):
        self._store, self._owner, self._limits = store, owner, limits

    def all(self) -> list[Design]:
        """Return all designs, the newest first."""
        where, values = ("id GLOB ?", (f"{self._owner}:*",)) if self._owner else ("id NOT GLOB '*:*'", ())
        query = f"SELECT id, name, revision, changed, bytes FROM designs WHERE {where} ORDER BY changed DESC, rowid DESC"
        return [Design(id.rpartition(":")[2], *rest) for id, *rest in self._store.rows(query, *values)]

    def get(self, id: str) -> Design:
        """Return a design.

        Raises
        ------
        NotFound
            If there is none.
        """
        found = self._store.rows("SELECT name, revision, changed, bytes FROM designs WHERE id = ?", self._key(id))
        if not found:
            raise NotFound(f"there is no design {id:.80}; it was deleted or never existed")
        return Design(id, *found[0])

    def content(self, id: str) -> tuple[Design, bytes]:
        """Return a design and its content."""
        design = self.get(id)
        return design, _content(self._store, self._key(id))

    def put(self, id: str, name: str, content: Iterable[bytes], revision: int) -> Design:
        """Store the pieces of a design.

        Parameters
        ----------
        id
            Chosen by the client.
        name
            Its name.
        content
            Its bytes.
        revision
            The revision that is replaced, 0 for a new design.

        Raises
        ------
        Conflict
            If there is another revision.
        """
        if not _ID.fullmatch(id):
            raise Unprocessable("the id of a design must consist of 8 to 64 letters, digits, '-' or '_'")
        key, store, limits = self._key(id), self._store, self._limits
        with store.staged(content) as staged:
            if not staged.size:
                raise Unprocessable("the design is empty")
            free = store.free()
            if (free is not None and free < limits.free) or store.owner_bytes(self._owner) + staged.size > limits.owner_bytes:
                raise NoRoom("there is no room for more designs; delete some designs or jobs")
            with store.writing() as base:
                found = base.execute("SELECT revision FROM designs WHERE id = ?", (key,)).fetchone()
                before = found[0] if found else 0
                if revision and not before:
                    raise NotFound(f"there is no design {id}; it was deleted or never existed")
                if before != revision:
                    raise Conflict("the design was changed elsewhere; load it again, or store it under another id")
                new = Design(id, name[:LONGEST_NAME], before + 1, time.time(), staged.size)
                # Each revision has a file of its own, so that a failure leaves the one before.
                store.place(staged, DESIGN, design_blob(key, new.revision))
                base.execute("INSERT OR REPLACE INTO designs VALUES (?,?,?,?,?,?)", (key, *new[1:], staged.inline))
            store.blobs.delete(DESIGN, design_blob(key, before))
        return new

    def delete(self, id: str) -> None:
        """Delete a design and its links."""
        design = self.get(id)
        with self._store.writing() as base:
            base.execute("DELETE FROM designs WHERE id = ?", (self._key(id),))
            base.execute("DELETE FROM links WHERE design = ?", (self._key(id),))
        self._store.blobs.delete(DESIGN, design_blob(self._key(id), design.revision))

    def links(self, id: str) -> list[Link]:
        """Return the links to a design, the newest first."""
        self.get(id)
        query = "SELECT substr(digest, 1, 16), mode, created FROM links WHERE design = ? ORDER BY created DESC"
        return [Link(*row) for row in self._store.rows(query, self._key(id))]

    def share(self, id: str, mode: str) -> tuple[Link, str]:
        """Create a link to a design; return it and its token, which is not stored."""
        self.get(id)
        if mode not in MODES:
            raise Unprocessable(f"'mode' must be {' or '.join(MODES)}")
        token = secrets.token_urlsafe(16)
        link = Link(_digest(token)[:16], mode, time.time())
        with self._store.writing() as base:
            base.execute("INSERT INTO links VALUES (?,?,?,?)", (_digest(token), self._key(id), mode, link.created))
        return link, token

    def revoke(self, id: str, link: str) -> None:
        """Delete a link to a design."""
        self.get(id)
        with self._store.writing() as base:
            query = "DELETE FROM links WHERE design = ? AND substr(digest, 1, 16) = ?"
            if not base.execute(query, (self._key(id), link)).rowcount:
                raise NotFound("there is no such link; it was revoked or never existed")

    def _key(self, id: str) -> str:
        if ":" in id:
            raise NotFound(f"there is no design {id:.80}; it was deleted or never existed")
        return owned_id(self._owner, id)


def shared(store: Store, token: str) -> tuple[str, str, bytes]:
    """Return name, mode and content of the design to which a token gives access.

    Raises
    ------
    NotFound
        If the link was revoked or never existed.
    """
    found = store.rows("SELECT design, name, mode FROM links JOIN designs ON designs.id = design WHERE digest = ?", _digest(token))
    if not found:
        raise NotFound("there is no such link; it was revoked or never existed")
    key, name, mode = found[0]
    return name, mode, _content(store, key)


def _content(store: Store, key: str) -> bytes:
    content: Optional[bytes] = None
    # A design can be replaced between the two accesses.
    for _ in range(3):
        found = store.rows("SELECT content, revision FROM designs WHERE id = ?", key)
        content = (found[0][0] or store.blobs.get(DESIGN, design_blob(key, found[0][1]))) if found else None
        if content is not None:
            return content
    raise NotFound("the content of this design is lost; store it again")


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()
