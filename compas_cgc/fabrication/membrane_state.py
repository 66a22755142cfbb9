"""The membrane state of a surface under a load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vectors
from ..model.problem import CGCProblem
from .loads import nodal_load
from .membrane_edges import EdgeLoads

__all__ = ["MembraneState", "forces_at_vertices"]


@dataclass(frozen=True, eq=False)
class MembraneState:
    """Membrane state of a surface under a load; tension is positive.

    Parameters
    ----------
    problem
        The surface.
    pressure
        Load along the normals [F/L^2].
    weight
        Downward load per area of the surface [F/L^2].
    forces
        (m, 2) principal forces N1 and N2 of every face, N1 the larger [F/L].
    directions
        (m, 2, 3) unit vectors of N1 and N2.
    edges
        (b, 2) edges inside regions.
    edge_forces
        (b,) edge forces in equilibrium [F].
    reactions
        (n, 3) forces on the surface at vertices around regions, 0 elsewhere [F].
    edge_loads
        Line loads along the boundaries of regions.
    out_of_balance
        Median residual of the forces by the formula, relative to the load; NaN with weight.
    correction
        Relative change of the edge forces for equilibrium; NaN with weight.
    imbalance
        Largest residual of the equilibrium state, relative to the load.
    remarks
        Notes in sentences.
    moved
        Largest displacement of a vertex by sliding [L].
    amplification
        Root mean square of the edge forces per width, relative to the load per area times the size.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import membrane
    >>> state = membrane(compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))), pressure=0.3)
    >>> state.imbalance < 1e-9
    True
    """

    problem: CGCProblem
    pressure: float  # along the normals [F/L^2]
    weight: float  # downwards, per area of the surface [F/L^2]
    forces: FloatArray  # (m, 2) N1 and N2 of every face, N1 the larger [F/L]
    directions: FloatArray  # (m, 2, 3) unit vectors of N1 and N2
    edges: Edges  # (b, 2) edges inside regions
    edge_forces: FloatArray  # (b,) edge forces in equilibrium [F]
    reactions: Vectors  # (n, 3) forces on the surface at vertices around regions, 0 elsewhere [F]
    edge_loads: EdgeLoads  # line loads along the boundaries of regions
    out_of_balance: float  # median residual of the formula relative to the load; NaN with weight
    correction: float  # relative change of the edge forces for equilibrium; NaN with weight
    imbalance: float  # largest residual relative to the load
    remarks: tuple[str, ...]  # notes in sentences
    moved: float = 0.0  # largest displacement of a vertex by sliding [L]
    amplification: float = 0.0  # root mean square of the edge forces per width, relative to load per area times size

    @property
    def load(self) -> Vectors:
        """Load at every vertex (n, 3) [F]."""
        return nodal_load(self.problem.vertices, self.problem.faces, self.pressure, self.weight)

    @property
    def totals(self) -> tuple[Vectors, Vectors]:
        """Sums of the loads and of the reactions, (3,) each [F]."""
        return self.load.sum(axis=0), self.reactions.sum(axis=0)

    @property
    def _size(self) -> float:
        return float(np.linalg.norm(self.load, axis=1).sum())

    def summary(self) -> str:
        """Return lines of text with the forces."""
        N1, N2 = self.forces.T
        lines = [
            f"under pressure {self.pressure:g} and weight {self.weight:g} per area alone; snow and wind act in .inp files only",
            f"N1 {N1.min():.4g} to {N1.max():.4g} (median {np.median(N1):.4g}), N2 {N2.min():.4g} to {N2.max():.4g}; tension is positive; "
            "units are force per length, with the load in force per area",
        ]
        for kind, name in enumerate(("supports", "creases", "free edges")):
            load = np.linalg.norm(self.edge_loads.load[self.edge_loads.kind == kind], axis=1)
            if len(load):
                lines.append(f"line load on {name}: up to {load.max():.4g}, median {np.median(load):.4g}")
        if np.isfinite(self.out_of_balance):
            change = f"corrected by changing edge forces by {100 * self.correction:.2g} %"
            lines.append(f"residual of the formula: {100 * self.out_of_balance:.2g} % of the load (median), {change}")
        sums = [", ".join(f"{x:.5g}" for x in np.where(np.abs(total) < 1e-9 * self._size, 0.0, total)) for total in self.totals]
        lines.append(
            f"equilibrium to {self.imbalance:.1g} of the load; total load ({sums[0]}), reactions of supports, creases, beams ({sums[1]})"
        )
        return "\n".join([*lines, *self.remarks])

    __str__ = summary


def forces_at_vertices(state: MembraneState) -> FloatArray:
    """Return N1 and N2 at every vertex, the mean of its faces (n, 2) [F/L]."""
    F, n = state.problem.faces, len(state.problem.vertices)
    count = np.maximum(np.bincount(F.ravel(), minlength=n), 1)
    return np.column_stack([np.bincount(F.ravel(), np.repeat(state.forces[:, k], 3), n) / count for k in (0, 1)])
