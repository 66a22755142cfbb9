"""Result of a rationalisation: the surface, its moulds, and how far it is from the design."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any
from typing import Optional

import numpy as np

from ..datastructures import SolveResult
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..model.counts import counted
from .costs import Costs
from .design import Design
from .distance import Distance
from .distance import Folds
from .distance import distance_from
from .distance import folds_at_seams
from .panelling import Panelling

__all__ = ["Rationalised"]


@dataclass(frozen=True, eq=False, repr=False)
class Rationalised:
    """A design made of panels from few moulds.

    Parameters
    ----------
    result
        The solved surface, in the exact measure.
    curvatures
        ``(k,)`` K of the moulds that are used, in rising order [1/L^2].
    classes
        ``(p,)`` mould of every panel, as a position in ``curvatures``.
    panelling
        The design and its panels, with the same vertices and faces.
    design
        The design.
    within
        Distance that was to be kept [L], None where none was given.
    cancelled
        Whether the search was cancelled before its end.
    suggestion
        What to change where the distance is not kept.
    costs
        Costs of moulds and panels by kind, None if there are none.
    weights
        ``(n,)`` factors by which distances at vertices are multiplied. Default: 1.

    Examples
    --------
    >>> from compas_cgc.rationalisation import SplineSurface, rationalise
    >>> import numpy as np
    >>> knots = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    >>> u, v = np.meshgrid([0.0, 4.0, 8.0], [0.0, 3.0, 6.0], indexing="ij")
    >>> height = 2.0 * np.outer([0.0, 1.0, 0.0], [0.2, 1.0, 0.2])
    >>> design = SplineSurface(np.stack([u, v, height, np.ones((3, 3))], axis=-1), (knots, knots), (2, 2))
    >>> found = rationalise(design, panel=2.0, moulds=2, edges=4)
    >>> found, int(found.panels_per_class.sum())
    (<Rationalised: 12 panels on 2 moulds, kept>, 12)
    """

    result: SolveResult
    curvatures: FloatArray
    classes: IntArray
    panelling: Panelling
    design: Design
    within: Optional[float] = None
    cancelled: bool = False
    suggestion: str = ""
    costs: Optional[Costs] = None
    weights: Optional[FloatArray] = None

    @cached_property
    def distance(self) -> Distance:
        """Signed distance of every vertex from the design [L]."""
        return distance_from(self.design.surface, self.panelling, self.result.vertices)

    @property
    def facet_deviation(self) -> Optional[float]:
        """Largest distance of the edges of a mesh from the smooth surface through its vertices [L], None if the design is not a mesh."""
        return None if self.design.mesh is None else self.design.mesh.facet_deviation

    @cached_property
    def folds(self) -> Folds:
        """Folds along the seams [deg]."""
        return folds_at_seams(self.panelling, self.result.vertices)

    @property
    def panels(self) -> IntArray:
        """Panel of every face (m,)."""
        return self.panelling.panels

    @property
    def farthest(self) -> float:
        """Upper bound of the weighted distance from the design as given [L].

        If the design is a mesh, it includes the deviation of the fitted surface from the vertices.
        """
        return self._largest(np.abs(self.distance.signed) + self.design.deviation)

    @property
    def weighted_deviation(self) -> float:
        """Largest weighted deviation of the surface fitted to a mesh [L], which ``farthest`` includes."""
        return self._largest(np.full(len(self.panelling.vertices), self.design.deviation))

    def _largest(self, distances: FloatArray) -> float:
        """Return the largest of distances (n,), weighted [L]."""
        return float((distances if self.weights is None else self.weights * distances).max(initial=0.0))

    @property
    def weighted(self) -> bool:
        """Whether distances have weights other than 1."""
        return self.weights is not None and bool((self.weights != 1.0).any())

    @property
    def costs_of_parts(self) -> tuple[float, float]:
        """Costs of the moulds and of the panels, 0 without costs."""
        return (0.0, 0.0) if self.costs is None else self.costs.parts(self.curvatures, self.panels_per_class)

    @property
    def kept(self) -> bool:
        """Whether the surface has converged and certainly lies within the distance that was to be kept, if one was."""
        return self.result.converged and (self.within is None or self.farthest <= self.within)

    @property
    def status(self) -> str:
        """``kept``, ``exceeded`` where the surface is too far from the design, else the status of the solve."""
        if self.cancelled:
            return "cancelled"
        if not self.result.converged:
            return self.result.status
        return "kept" if self.kept else "exceeded"

    @property
    def panels_per_class(self) -> IntArray:
        """Number of panels of every mould (k,)."""
        return np.bincount(self.classes, minlength=len(self.curvatures))

    @property
    def summary(self) -> str:
        """Moulds, panels and distances in a few sentences."""
        unit = self.design.drawing.units
        suffix = f" {unit.casefold()}" if unit else ""
        per_class = zip(self.curvatures, self.panels_per_class.tolist())
        moulds = ", ".join(f"{_radius(K, suffix)} ({counted(count, 'panel')})" for K, count in per_class)
        beyond = self.folds.beyond()
        lines = [
            f"{counted(self.panelling.panel_count, 'panel')} on {counted(len(self.curvatures), 'mould')}: {moulds}",
            f"distance from the design: largest {self.distance.largest:.3g}{suffix}, rms {self.distance.rms:.3g}{suffix}",
            f"folds at seams beyond those of the design: {beyond['largest']:.2g} degrees (largest), {beyond['median']:.2g} (median)",
            f"surface: {self.result.status}, {self.result.verdict}",
        ]
        if self.facet_deviation is not None:
            faces = f"the faces of the mesh are up to {self.facet_deviation:.2g}{suffix} from it"
            lines.insert(2, f"the design is the smooth surface through the vertices of the mesh; {faces}")
        if self.costs is not None:
            of_moulds, of_panels = self.costs_of_parts
            lines.insert(1, f"costs: {of_moulds + of_panels:,.10g}, moulds {of_moulds:,.10g} and panels {of_panels:,.10g}")
        return "\n".join(lines + ([self.suggestion] if self.suggestion else []))

    def __repr__(self) -> str:
        return f"<Rationalised: {counted(self.panelling.panel_count, 'panel')} on {counted(len(self.curvatures), 'mould')}, {self.status}>"

    def to_dict(self) -> dict[str, Any]:
        """Return the figures as plain data, ready for JSON."""
        folds = self.folds
        return {
            "status": self.status,
            "verdict": str(self.result.verdict),
            "units": self.design.drawing.units,
            "moulds": len(self.curvatures),
            "curvatures": self.curvatures.tolist(),
            "radii": [None if K == 0.0 else float(np.sign(K) / np.sqrt(abs(K))) for K in self.curvatures.tolist()],
            "panels": self.panelling.panel_count,
            "panels_per_class": self.panels_per_class.tolist(),
            "classes": self.classes.tolist(),
            "distance": {"max": self.distance.largest, "rms": self.distance.rms},
            "weighted_distance": self.farthest if self.weighted else None,
            "within": self.within,
            "costs": None if self.costs is None else {"moulds": self.costs_of_parts[0], "panels": self.costs_of_parts[1]},
            "fit_deviation": self.design.deviation,
            "facet_deviation": self.facet_deviation,
            "kinks": {
                "largest": float(folds.angles.max(initial=0.0)),
                "median": float(np.median(folds.angles)) if len(folds.edges) else 0.0,
                "design_largest": float(folds.design.max(initial=0.0)),
                "design_median": float(np.median(folds.design)) if len(folds.edges) else 0.0,
                "beyond": folds.beyond(),
            },
            "max_error": self.result.max_error,
            "suggestion": self.suggestion,
        }


def _radius(K: float, unit: str) -> str:
    if K == 0.0:
        return "flat"
    return f"{'sphere' if K > 0 else 'saddle'} of radius {1.0 / np.sqrt(abs(K)):.3g}{unit}"
