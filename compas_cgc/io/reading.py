"""Problem as read from a file or a document: with what was done to it, and what of it could not be used."""

from __future__ import annotations

from typing import NamedTuple

from ..meshing import Diagnostic
from ..model.checks import refuse
from ..model.problem import CGCProblem

__all__ = ["ReadProblem"]


class ReadProblem(NamedTuple):
    """What reading gives."""

    problem: CGCProblem
    notes: tuple[str, ...] = ()  # sentences on what was found and done
    diagnostics: tuple[Diagnostic, ...] = ()  # sentences on what could not be used, each with object and mend

    def checked(self) -> CGCProblem:
        """Return the problem if all of it could be used.

        Raises
        ------
        ProblemError
            With the diagnostics that are fatal, if there are any.
        """
        refuse(list(self.diagnostics))
        return self.problem
