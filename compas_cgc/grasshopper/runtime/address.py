"""Address of a server."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

__all__ = ["Address"]


@dataclass(frozen=True)
class Address:
    """Address of a server, and its key if it has one."""

    url: str
    key: Optional[str] = None

    @classmethod
    def from_text(cls, text: str, key: Optional[str] = None) -> Address:
        """Return the address in a text; a missing ``http://`` is added."""
        url = text.strip()
        return cls(url if "://" in url else f"http://{url}", key.strip() if key else None)

    def __str__(self) -> str:
        return self.url
