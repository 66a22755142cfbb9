"""Problem read from a file or document, with notes and errors."""

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
    """Result of reading a problem.

    Parameters
    ----------
    problem
        Mesh, supports, creases, targets and goals.
    notes
        Notes on the contents and on changes made to them.
    diagnostics
        Errors in the contents, each with the object and the remedy.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.io import read_problem
    >>> read_problem(compas_cgc.get("nine_regions.3dm")).diagnostics
    ()
    """

    problem: CGCProblem
    notes: tuple[str, ...] = ()  # contents, and changes made to them
    diagnostics: tuple[Diagnostic, ...] = ()  # errors in the contents, each with object and remedy

    def checked(self) -> CGCProblem:
        """Return the problem if there are no fatal diagnostics.

        Raises
        ------
        ProblemError
            With the fatal diagnostics, if there are any.
        """
        refuse(list(self.diagnostics))
        return self.problem
