"""Mesh on a wire: a problem of arrays, whose COMPAS mesh is made when a script first uses it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING
from typing import Any

from ...datastructures import CGCMesh
from ...model.problem import CGCProblem

__all__ = ["WireMesh"]


class WireMesh:
    """A problem on a wire of the canvas, which has all attributes of its :class:`CGCMesh`.

    Components exchange arrays: a COMPAS mesh takes a thousand times as long to copy as its arrays. Scripts on the canvas can use the
    value as a mesh; what they change in it is part of the problem.

    Parameters
    ----------
    problem
        The problem.

    Examples
    --------
    >>> wire = WireMesh(CGCMesh.from_meshgrid(dx=2, nx=2).to_problem())
    >>> wire.number_of_vertices()
    9
    """

    def __init__(self, problem: CGCProblem):
        self.problem = problem

    @cached_property
    def mesh(self) -> CGCMesh:
        """The COMPAS mesh."""
        return CGCMesh.from_problem(self.problem)

    def to_problem(self) -> CGCProblem:
        """Return the problem, with the changes that scripts made in the mesh."""
        return self.mesh.to_problem() if "mesh" in self.__dict__ else self.problem

    def __getstate__(self) -> dict[str, CGCProblem]:
        return {"problem": self.to_problem()}

    def __setstate__(self, state: dict[str, CGCProblem]) -> None:
        self.problem = state["problem"]

    def __repr__(self) -> str:
        return repr(self.problem)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if "problem" not in self.__dict__:  # while it is unpickled
                raise AttributeError(name)
            return getattr(self.mesh, name)
