"""The result of a solve, as users see it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional
from typing import Protocol

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import PerVertex
from ..errors import find_attribute
from ..errors import names_what_was_meant
from ..meshing import Diagnostic
from ..model.goals.wholes import Unknown
from ..model.measures import measured_curvature
from ..model.problem import CGCProblem
from ..model.problem import Origin
from ..model.result import History
from ..model.result import Solution
from ..model.roles import DUMMY
from ..model.verdict import Verdict
from ..model.verdict import verdict
from ._summary import summary
from .cgcmesh import CGCMesh

__all__ = ["SolveResult"]


INSTEAD = {
    **dict.fromkeys(("K", "k", "gaussian_curvature"), "it is result.curvature, and of regions result.problem.region_targets()"),
    **dict.fromkeys(("save", "write", "to_file"), 'it is a function: compas_cgc.write("roof.3dm", result)'),
    **dict.fromkeys(("show", "plot", "draw", "picture"), "a picture is drawn by compas_cgc.plot.studio, see 'A picture' in the recipes"),
    **dict.fromkeys(("height", "heights", "rise"), "they are in result.vertices[:, 2], and in words in result.summary"),
}


def _of_the_mesh(name: str) -> str:
    """Return where an attribute is that a result has not, but its mesh has."""
    return INSTEAD.get(name) or (f"its mesh has: result.mesh.{name}" if hasattr(CGCMesh, name) else "")


AGAIN = 1e-6  # of the largest |K̄|, by which K may be off when its part of the layout is read once more


class _Settings(Protocol):
    def to_dict(self) -> dict: ...


@names_what_was_meant()
@dataclass(frozen=True, eq=False, repr=False)
class SolveResult:
    """What :func:`compas_cgc.solve` returns.

    Parameters
    ----------
    problem
        The problem with its vertices on the surface that was found, without dummies.
    status
        ``converged``, ``step_limit``, ``stalled``, ``diverged``, ``infeasible`` or ``cancelled``.
    ending
        One sentence that says how the method ended, and what to do if it did not end well.
    iterations
        Steps taken.
    seconds
        Wall time of the solve.
    max_error
        Largest |K - K̄| over the vertices where K is asked for [1/L^2].
    history
        Energy, error norm, max error, step length and trials of every step.
    method
        The method that was used.
    settings
        What was set of it by the user; None where nothing was.
    drawn
        The mesh that was solved, where one was given.
    remarks
        What the check found that does not keep the problem from being solved.
    start
        ``(n, 3)`` where the vertices were before [L]; None where that is not known.
    measure
        How K is read off the mesh in the errors: ``defect``, ``smooth``, ``exact`` or ``exact-arc``.
    turned
        How many faces are not those of the mesh that was given: edges of triangles too stretched or too slender for K < 0 were turned.

    Examples
    --------
    >>> import compas_cgc
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> result.converged, str(result.verdict), result.mesh.number_of_vertices()
    (True, 'fair', 247)
    """

    problem: CGCProblem
    status: str
    ending: str
    iterations: int
    seconds: float
    max_error: float
    history: History
    method: str
    settings: Optional[_Settings] = None
    drawn: Optional[CGCMesh] = None
    remarks: tuple[Diagnostic, ...] = ()
    start: Optional[FloatArray] = None
    measure: str = "defect"
    turned: int = 0

    @classmethod
    def from_solution(
        cls,
        problem: CGCProblem,
        solution: Solution,
        settings: Optional[_Settings] = None,
        drawn: Optional[CGCMesh] = None,
        remarks: Iterable[Diagnostic] = (),
    ) -> SolveResult:
        """Return the result of a solution of a problem."""
        if solution.targets is not None:
            problem = problem.with_targets(solution.targets)
        turned = 0
        if solution.faces is not None:
            turned = int(np.count_nonzero((solution.faces != problem.faces).any(axis=1)))
            # The mesh that was given has other faces, so that the one of the result is made anew.
            problem, drawn = replace(problem, faces=solution.faces), None
        before = problem.without_dummies()
        surface = solution.vertices[problem.roles != DUMMY]
        real = replace(before, vertices=surface, origin=Origin(replace(before, origin=None), surface))
        made = cls(
            real,
            *solution[1:8],
            settings=settings,
            drawn=drawn,
            remarks=tuple(remarks),
            start=before.vertices,
            measure=solution.measure,
            turned=turned,
        )
        if solution.verdict is not None:
            # Judged already, when the method was chosen.
            made.__dict__["verdict"] = solution.verdict
        return made

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            return find_attribute(self, name, _of_the_mesh)

    @property
    def converged(self) -> bool:
        """Whether every curvature asked for was reached to the tolerance."""
        return self.status == "converged"

    @cached_property
    def verdict(self) -> Optional[Verdict]:
        """Whether the surface is fair or rough, and why: a status speaks of equations alone; None where none was found."""
        return None if self.status in ("infeasible", "diverged") else verdict(self.problem, self.start)

    @cached_property
    def summary(self) -> str:
        """The verdict and the surface in one sentence: its heights, its K, and what is held."""
        return summary(self.problem, self.start, self.status, self.verdict, self.max_error)

    @cached_property
    def message(self) -> str:
        """What came of it: the summary, then how the method ended; where K was not reached, why."""
        return f"{self.summary}; {self.ending}{self._read_again()}" if self.converged else self.ending

    def _read_again(self) -> str:
        """Return how far K is off where the layout's part of it, read off the surface that was found, is not that which was solved for."""
        if self.measure != "smooth":
            return ""
        asked = self.problem.asked
        off = np.abs(self.curvature - self.problem.targets)[asked]
        if not off.max(initial=0.0) > AGAIN * self.problem.target_scale:
            return ""
        middle, most = float(np.median(off)), float(off.max())
        return f"; with the layout's part read off this surface again, K is {middle:.2g} off in the middle and {most:.2g} at most"

    @cached_property
    def curvature(self) -> PerVertex:
        """K (n,) in the measure of the solve, NaN where none is asked [1/L^2]."""
        return measured_curvature(self.problem, self.measure)

    @property
    def vertices(self) -> FloatArray:
        """The surface (n, 3) [L]."""
        return self.problem.vertices

    @property
    def faces(self) -> IntArray:
        """Its faces (m, 3)."""
        return self.problem.faces

    def __repr__(self) -> str:
        return f"<SolveResult of {self.problem!r}: {self.ending}>"

    def __post_init__(self) -> None:
        if self.drawn is not None:
            # Made at once: the mesh that was solved is the user's, who may change it.
            self.__dict__["mesh"] = self._redrawn(self.drawn)

    @cached_property
    def mesh(self) -> CGCMesh:
        """A copy of the mesh that was solved, with the new coordinates and all constraints, without dummies."""
        return CGCMesh.from_problem(self.problem)

    def _redrawn(self, drawn: CGCMesh) -> CGCMesh:
        mesh = drawn.with_coordinates(self.vertices)
        mesh.origin = self.problem.origin
        mesh.set_goals(self.problem.goals)
        found = [own.regions for own in self.problem.goals if isinstance(own, Unknown)]
        for region, K in enumerate(self.problem.region_targets() if found else ()):
            if K is not None and any(isinstance(regions, str) or region in regions for regions in found):
                mesh.set_target(K, region=region)
        return mesh

    def to_problem(self) -> CGCProblem:
        """Return the problem on the surface that was found."""
        return self.problem

    def to_dict(self, history: bool = True) -> dict:
        """Return how the solve went, ready for JSON; numbers that are none are None."""
        words = {
            "method": self.method,
            "measure": self.measure,
            "settings": None if self.settings is None else self.settings.to_dict(),
            "status": self.status,
            "verdict": None if self.verdict is None else self.verdict.to_dict(),
            "message": self.message,
            "steps": self.iterations,
            "seconds": self.seconds,
            "max_error": self.max_error if np.isfinite(self.max_error) else None,
        }
        return {**words, "history": self.history.to_dict()} if history else words
