"""What moulds are needed and how every panel fits them: plain figures, a text for people and plain data for machines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any
from typing import Optional

import numpy as np

from ..discrete.arrays import Faces
from ..discrete.arrays import Vertices
from .development import Development
from .fitting import Fit
from .flattening import LONG
from .flattening import STRAIN
from .flattening import strain_of_width
from .flattening import widest_panel
from .materials import Material
from .mould_surface import Surface
from .panelling import Panel
from .pieces import best_box

__all__ = ["Mould", "MouldReport", "PanelFit"]


@dataclass(frozen=True)
class Mould:
    """One mould: a cap of a surface of constant curvature."""

    number: int  # from 1
    surface: Surface
    radius: float  # of the smallest cap with room for each of its panels, along the surface [L]
    panels: int  # made on it

    @property
    def K(self) -> float:
        """Gaussian curvature [1/L^2]."""
        return self.surface.K

    @property
    def kind(self) -> str:
        """What it is a piece of."""
        return "sphere" if self.K > 0.0 else "pseudosphere" if self.K < 0.0 else "plane"

    @property
    def radius_of_curvature(self) -> Optional[float]:
        """``1/√|K|``, None for a plane [L]."""
        return 1.0 / math.sqrt(abs(self.K)) if self.K else None


@dataclass(frozen=True)
class PanelFit:
    """One panel on its mould."""

    panel: Panel
    mould: int  # its number
    radius: float  # of the smallest cap around it [L]
    gap: float  # largest distance between places that its faces give to one vertex [mm]
    edge_error: float  # largest difference of an edge on the mould, against the edge
    rigid: float  # by which it misses its place if it is not bent, at most [mm]
    change: Optional[float]  # of curvature from the mould into place, the largest; None where no curvature could be measured [1/m]
    stress: Optional[float]  # of bending it so [MPa]
    development: Development  # of the whole faces that it has a part of, with the pole in the middle of the cap
    vertices: Vertices  # (p, 3) of the panel in place [L]
    faces: Faces  # (f, 3) of the panel, turned over where it is hollow
    on_mould: Vertices  # (p, 3) places of its vertices in space on the mould, whose pole is at the origin [L]
    into_place: Fit  # the rigid motion from there that comes nearest to its place

    @property
    def width(self) -> float:
        """Shorter side of the smallest rectangle around it in its mean plane [L]."""
        away = self.vertices - self.vertices.mean(axis=0)
        box = best_box(away @ np.linalg.svd(away, full_matrices=False)[2][:2].T, (math.inf, math.inf))
        return min(box.length, box.width)

    def to_dict(self) -> dict[str, Any]:
        """Return the figures, ready for JSON."""
        own = {name: getattr(self, name) for name in ("mould", "radius", "gap", "edge_error", "rigid", "change", "stress")}
        return {"panel": self.panel.name, "region": self.panel.region, "faces": len(self.panel.faces), **own}


@dataclass(frozen=True)
class MouldReport:
    """Moulds and panels of a surface.

    Parameters
    ----------
    moulds
        One for each K, or for those near each other.
    panels
        How each panel fits its mould.
    material
        What the panels are of.
    thickness
        Of the sheets [mm].
    unit
        Of the model [m].
    arc
        Edges are lengths along the moulds, not chords.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import moulds, panels
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    >>> len(moulds(result, panels(result, 3.0)).moulds)
    1
    """

    moulds: list[Mould]
    panels: list[PanelFit]
    material: Material
    thickness: float  # of the sheets [mm]
    unit: float  # of the model [m]
    arc: bool  # edges are lengths along the moulds, not chords

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists and dicts, ready for JSON."""
        moulds = [
            {
                "mould": own.number,
                "kind": own.kind,
                "K": own.K,
                "radius_of_curvature": own.radius_of_curvature,
                "cap_radius": own.radius,
                "panels": own.panels,
            }
            for own in self.moulds
        ]
        about = {"material": self.material.name, "thickness_mm": self.thickness, "unit_m": self.unit, "edges": self.edges}
        return {"moulds": moulds, "panels": [own.to_dict() for own in self.panels], **about}

    @property
    def edges(self) -> str:
        """What the edges of the mesh are on the moulds."""
        return "arcs" if self.arc else "chords"

    def __str__(self) -> str:
        return "\n".join(
            [
                f"{_many(len(self.panels), 'panel')} on {_many(len(self.moulds), 'mould')}, edges as {self.edges} of them",
                *(line for own in self.moulds for line in self._lines(own)),
                "congruent triangles do not say that a sheet can take the way: see the change of curvature and the stress",
            ]
        )

    def _lines(self, mould: Mould) -> list[str]:
        own = [fit for fit in self.panels if fit.mould == mould.number]
        long = mould.radius_of_curvature
        what = f"{mould.kind} of K = {mould.K:.6g}" + ("" if long is None else f", radius {long:.5g}")
        lines = [
            f"mould {mould.number}: {what}, a cap of {mould.radius:.4g} around its middle, for {_many(mould.panels, 'panel')}",
            f"  fit: gaps to {max(fit.gap for fit in own):.2g} mm, edges to {max(fit.edge_error for fit in own):.1e}",
            f"  not bent they miss their places by {_spread([fit.rigid for fit in own])} mm",
        ]
        changes = [fit.change for fit in own if fit.change is not None]
        stresses = [fit.stress for fit in own if fit.stress is not None]
        if changes:
            part = 1e6 * max(stresses) / self.material.strength
            lines.append(
                f"  bent they change curvature by {_spread(changes)} 1/m, {_spread(stresses)} MPa in {self.thickness:g} mm of "
                f"{self.material.name}, {100 * part:.0f} % of its characteristic strength without any factor of safety"
            )
        if mould.K:
            wide, strip = widest_panel(mould.K, STRAIN), widest_panel(mould.K, STRAIN, LONG)
            widths = [fit.width for fit in own]
            strains = [100 * strain_of_width(mould.K, width) for width in widths]
            lines.append(
                f"  flat sheets strained by {100 * STRAIN:g} % instead are at most {wide:.3g} wide if square, sqrt(24 strain / |K|); "
                f"long ones {strip:.3g}; these, {_spread(widths)} wide, would be strained by some {_spread(strains)} %"
            )
        return lines


def _many(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _spread(values: list[float]) -> str:
    return f"{_two_digits(float(np.median(values)))} (median) to {_two_digits(max(values))}"


def _two_digits(value: float) -> str:
    """Return a number to two digits, or to whole units, never with an exponent where it is large."""
    return f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"
