"""Solves as work: what is asked, and who does it."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from typing import Optional

from ...analysis import analyse
from ...datastructures import CGCMesh
from ...model.problem import CGCProblem
from ...model.result import SolveState
from ...solvers.solve import solve
from .address import Address
from .background import Progress

__all__ = ["Question", "Solved", "local_job", "part_done", "report_text"]

# What progress is measured against: to a designer the surface is done there.
GOAL = 1e-6


@dataclass(frozen=True)
class Question:
    """A mesh with its targets, and how to solve it."""

    mesh: CGCMesh
    settings: Any = None  # of one of the methods
    constraints: tuple = ()
    server: Optional[Address] = None  # who solves it, None for this process

    def is_same(self, other: Question) -> bool:
        """Tell whether another question is made of the same objects, which takes no time."""
        pairs = [(self.mesh, other.mesh), (self.settings, other.settings), *zip(self.constraints, other.constraints)]
        same = len(self.constraints) == len(other.constraints) and self.server == other.server
        return same and all(a is b for a, b in pairs)

    def fingerprint(self) -> str:
        """Return the same text for the same question, whatever objects it is made of."""
        mesh = self.mesh
        asked = (mesh.default_vertex_attributes, mesh.vertex, mesh.face, mesh.crease_edges(), self.settings, self.constraints)
        return hashlib.sha1(repr(asked).encode("utf-8")).hexdigest()


@dataclass(frozen=True)
class Solved:
    """What the canvas shows of a solve; no tuple or dict, which Grasshopper would take apart."""

    mesh: CGCMesh
    status: str
    message: str
    max_error: float  # [1/L^2]
    seconds: float
    history: dict
    report: str  # the analysis, to be read


def local_job(question: Question) -> Callable[[Callable[[Progress], bool]], Solved]:
    """Return the work of solving in this process."""

    def job(tell: Callable[[Progress], bool]) -> Solved:
        scale = CGCProblem.from_mesh(question.mesh).target_scale
        first: list[float] = []  # the error of the first step, once it is known

        def callback(state: SolveState) -> bool:
            first[:] = first or [state.max_error]
            return tell(Progress(state.step, state.max_error, part_done(first[0], state.max_error, GOAL * scale)))

        result = solve(question.mesh, settings=question.settings, constraints=question.constraints, callback=callback)
        report = report_text(result.message, result.mesh, question.mesh)
        return Solved(result.mesh, result.status, result.message, result.max_error, result.seconds, result.history.to_dict(), report)

    return job


def report_text(message: str, mesh: CGCMesh, before: CGCMesh) -> str:
    """Return what is to be read about a solve."""
    return f"{message}\n{analyse(mesh, before)}"


def part_done(first: float, error: float, goal: float) -> float:
    """Return how far an error has come from the first one to the goal, from 0 to 1 on a logarithmic scale."""
    if not goal < first or error >= first:
        return 0.0
    if error <= goal:
        return 1.0
    return math.log(first / error) / math.log(first / goal)
