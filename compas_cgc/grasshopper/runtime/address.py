"""Address of a server."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

__all__ = ["Address"]


@dataclass(frozen=True)
class Address:
    """The address of a server, and its key where it has one."""

    url: str
    key: Optional[str] = None

    @classmethod
    def from_text(cls, text: str, key: Optional[str] = None) -> Address:
        """Return the address that somebody has written, which gets the ``http://`` that it lacks."""
        url = text.strip()
        return cls(url if "://" in url else f"http://{url}", key.strip() if key else None)

    def __str__(self) -> str:
        return self.url
