"""SolveResult: the result of a solve."""

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
from ..model.measures import has_drifted
from ..model.measures import measured_curvature
from ..model.problem import CGCProblem
from ..model.result import FAILED
from ..model.result import Branch
from ..model.result import History
from ..model.result import Solution
from ..model.roles import DUMMY
from ..model.verdict import Verdict
from ..model.verdict import verdict
from ._summary import summary
from .cgcmesh import CGCMesh

__all__ = ["SolveResult"]


INSTEAD = {
    **dict.fromkeys(("K", "k", "gaussian_curvature"), "use result.curvature, or result.problem.region_targets() for regions"),
    **dict.fromkeys(("save", "write", "to_file"), 'use the function compas_cgc.write("roof.3dm", result)'),
    **dict.fromkeys(("show", "plot", "draw", "picture"), "draw pictures with compas_cgc.plot.studio, see 'A picture' in the recipes"),
    **dict.fromkeys(("height", "heights", "rise"), "use result.vertices[:, 2], or result.summary for a sentence"),
}


def _of_the_mesh(name: str) -> str:
    """Return what to use instead of an attribute that a result does not have."""
    return INSTEAD.get(name) or (f"use result.mesh.{name}" if hasattr(CGCMesh, name) else "")


class _Settings(Protocol):
    def to_dict(self) -> dict: ...


@names_what_was_meant()
@dataclass(frozen=True, eq=False, repr=False)
class SolveResult:
    """Result of :func:`compas_cgc.solve`.

    Parameters
    ----------
    problem
        Problem with its vertices on the surface, without dummies.
    status
        ``converged``, ``step_limit``, ``stalled``, ``diverged``, ``infeasible`` or ``cancelled``.
    ending
        One sentence on how the method ended, with advice if it did not converge.
    iterations
        Number of steps.
    seconds
        Wall time of the solve [s].
    max_error
        Largest residual of the equations K = K̄ [1/L^2]; ``analyse`` reports the error of K that is read off the surface.
    history
        Energy, error norm, largest error, step length and trials of every step.
    method
        Name of the method.
    settings
        Settings given by the user; None if there were none.
    drawn
        The input mesh, if a mesh was given.
    remarks
        Warnings of the check before the solve.
    start
        ``(n, 3)`` vertices before the solve [L]; None if unknown.
    measure
        Measure of K in the errors: ``mid-edge``, ``defect``, ``smooth``, ``exact`` or ``exact-arc``.
    evenness
        Length over which the method ``bending`` made the curvature vary evenly, relative to the square root of the area; 0: not at all.
    turned
        Number of faces that differ from the input: edges of triangles too slender for K < 0 were flipped.
    branches
        Surfaces with this curvature that the method ``bending`` found, with vertices, energy, verdict and mirror twin; the first is
        the result.
        On large meshes, the others were computed on a coarser mesh; to complete them: ``solve(problem.with_vertices(branch.vertices))``.

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
    evenness: float = 0.0
    turned: int = 0
    branches: tuple[Branch, ...] = ()

    @classmethod
    def from_solution(
        cls,
        problem: CGCProblem,
        solution: Solution,
        settings: Optional[_Settings] = None,
        drawn: Optional[CGCMesh] = None,
        remarks: Iterable[Diagnostic] = (),
    ) -> SolveResult:
        """Return the result for a solution of a problem."""
        problem = solution.with_found(problem)
        turned = 0
        if solution.faces is not None:
            turned = int(np.count_nonzero((solution.faces != problem.faces).any(axis=1)))
            # The input mesh has other faces, so that the mesh of the result is built from the problem.
            problem, drawn = replace(problem, faces=solution.faces), None
        before = problem.without_dummies()
        surface = solution.vertices[problem.roles != DUMMY]
        real = replace(before, vertices=surface).drawn_as(before.vertices, solution.measure, solution.evenness)
        made = cls(
            real,
            *solution[1:8],
            settings=settings,
            drawn=drawn,
            remarks=tuple(remarks),
            start=before.vertices,
            measure=solution.measure,
            evenness=solution.evenness,
            turned=turned,
            branches=solution.branches,
        )
        if solution.verdict is not None:
            # The choice of the method has judged it already.
            made.__dict__["verdict"] = solution.verdict
        return made

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            return find_attribute(self, name, _of_the_mesh)

    @property
    def converged(self) -> bool:
        """Whether all target curvatures are met within the tolerance."""
        return self.status == "converged"

    @cached_property
    def verdict(self) -> Verdict:
        """Whether the surface is fair or rough, with reasons; not fair if no surface was found."""
        judged = verdict(self.problem, self.start)
        return replace(judged, fair=False, reasons=["no surface was found"]) if self.status in FAILED else judged

    @cached_property
    def summary(self) -> str:
        """One sentence: verdict, heights, K and supports."""
        return summary(self.problem, self.start, self.status, self.verdict, self.max_error)

    @cached_property
    def message(self) -> str:
        """The summary and how the method ended, or why K was not reached."""
        return f"{self.summary}; {self.ending}{self._read_again()}" if self.converged else self.ending

    def _read_again(self) -> str:
        """Return the error of K with the layout correction of the smooth measure evaluated on the result, if it is not negligible."""
        if self.measure != "smooth" or not has_drifted(self.problem, self.curvature):
            return ""
        off = np.abs(self.curvature - self.problem.targets)[self.problem.asked]
        middle, most = float(np.median(off)), float(off.max())
        return (
            f"; with the layout error of the mesh estimated on the final surface, the error of K is {middle:.2g} (median) "
            f"and {most:.2g} (largest)"
        )

    @cached_property
    def curvature(self) -> PerVertex:
        """Gaussian curvature at each vertex in the measure of the solve, NaN where it is not prescribed or read (n,) [1/L^2]."""
        return measured_curvature(self.problem, self.measure)

    @property
    def vertices(self) -> FloatArray:
        """Vertices of the surface (n, 3) [L]."""
        return self.problem.vertices

    @property
    def faces(self) -> IntArray:
        """Faces of the surface (m, 3)."""
        return self.problem.faces

    def __repr__(self) -> str:
        return f"<SolveResult of {self.problem!r}: {self.ending}>"

    def __post_init__(self) -> None:
        if self.drawn is not None:
            # Copied at once, because the user may change the input mesh.
            self.__dict__["mesh"] = self._redrawn(self.drawn)

    @cached_property
    def mesh(self) -> CGCMesh:
        """The solved mesh: a copy of the input with new coordinates and all goals, without dummies."""
        return CGCMesh.from_problem(self.problem)

    def _redrawn(self, drawn: CGCMesh) -> CGCMesh:
        mesh = drawn.with_coordinates(self.vertices)
        mesh.origin = self.problem.origin
        mesh.set_goals(self.problem.goals)
        found = [own.regions for own in self.problem.goals if isinstance(own, Unknown)]
        for region, law in enumerate(self.problem.region_laws() if found else ()):
            if law is not None and any(isinstance(regions, str) or region in regions for regions in found):
                mesh.set_law(law, region=region)
        return mesh

    def to_problem(self) -> CGCProblem:
        """Return the problem with its vertices on the surface."""
        return self.problem

    def to_dict(self, history: bool = True) -> dict:
        """Return the report of the solve as a dict that can be written as JSON; non-finite numbers are None."""
        words = {
            "method": self.method,
            "measure": self.measure,
            "evenness": self.evenness,
            "settings": None if self.settings is None else self.settings.to_dict(),
            "status": self.status,
            "verdict": self.verdict.to_dict(),
            "message": self.message,
            "steps": self.iterations,
            "seconds": self.seconds,
            "max_error": self.max_error if np.isfinite(self.max_error) else None,
        }
        return {**words, "history": self.history.to_dict()} if history else words
