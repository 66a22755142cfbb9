"""The browser page: static files and the routes they use besides the job API."""

from __future__ import annotations

from .routes import index
from .routes import page
from .routes import wants_page

__all__ = ["index", "page", "wants_page"]
