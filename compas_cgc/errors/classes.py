"""The errors of the package, by what went wrong."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["ArgumentError", "CGCError", "FileError", "MeshError", "ProblemError"]


class CGCError(ValueError):
    """Base of all errors that a user of the package can cause and put right."""


class MeshError(CGCError):
    """The vertices and faces do not form a mesh that curvature can be measured on."""


class FileError(CGCError):
    """A file cannot be read or written."""


class ArgumentError(CGCError, TypeError):
    """An argument is of another kind than what a function takes."""


class ProblemError(CGCError):
    """A solve is refused.

    Attributes
    ----------
    problems
        The sentences of :meth:`compas_cgc.datastructures.CGCMesh.check` that refuse it.
    """

    def __init__(self, problems: Sequence[str]):
        self.problems = list(problems)
        super().__init__("; ".join(self.problems))
