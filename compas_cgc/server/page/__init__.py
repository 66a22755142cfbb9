"""The page for a browser: static files, and what they ask the server for besides the job API."""

from __future__ import annotations

from .routes import index
from .routes import page
from .routes import wants_page

__all__ = ["index", "page", "wants_page"]
