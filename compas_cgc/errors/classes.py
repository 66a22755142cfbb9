"""Error classes of the package."""

from __future__ import annotations

from collections.abc import Sequence

from .sentence import joined

__all__ = ["ArgumentError", "CGCError", "FileError", "MeshError", "ProblemError"]


class CGCError(ValueError):
    """Base class of errors that a user can cause and correct."""


class MeshError(CGCError):
    """The vertices and faces do not form a mesh on which curvature can be measured."""


class FileError(CGCError):
    """A file cannot be read or written."""


class ArgumentError(CGCError, TypeError):
    """An argument has the wrong type, shape or name."""


class ProblemError(CGCError):
    """A problem cannot be solved as stated.

    Attributes
    ----------
    problems
        Messages of :meth:`compas_cgc.datastructures.CGCMesh.check` about the errors that prevent the solve.
    """

    def __init__(self, problems: Sequence[str]):
        self.problems = list(problems)
        super().__init__(joined(self.problems))
