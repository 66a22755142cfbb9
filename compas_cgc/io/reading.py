"""Problem as read from a file or a document: with what was done to it, and what of it could not be used."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import NamedTuple

from ..meshing import Diagnostic
from ..model.checks import refuse
from ..model.problem import CGCProblem

if TYPE_CHECKING:
    pass

__all__ = ["ReadProblem"]


class ReadProblem(NamedTuple):
    """What reading gives.

    Parameters
    ----------
    problem
        What is asked of which mesh.
    notes
        Sentences on what was found and done.
    diagnostics
        Sentences on what could not be used, each with object and mend.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.io import read_problem
    >>> read_problem(compas_cgc.get("nine_regions.3dm")).diagnostics
    ()
    """

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
