"""Exit codes of ``compas-cgc``."""

from __future__ import annotations

DONE = 0
NOT_CONVERGED = 1
REFUSED = 2
ROUGH = 3  # the surface is rough, or panels are bent beyond the strength of their material
INCOMPLETE = 4  # the surface is written, another output could not be
INTERRUPTED = 130
TERMINATED = 143
