"""Exit codes of ``compas-cgc``."""

from __future__ import annotations

DONE = 0
NOT_CONVERGED = 1
REFUSED = 2
ROUGH = 3
INTERRUPTED = 130
