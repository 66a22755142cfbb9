"""Exit codes of ``compas-cgc``."""

from __future__ import annotations

DONE = 0
NOT_CONVERGED = 1
REFUSED = 2
ROUGH = 3
INCOMPLETE = 4  # the surface is written, another output could not be
INTERRUPTED = 130
TERMINATED = 143
