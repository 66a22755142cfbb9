"""Report on moulds and the fit of panels."""

from __future__ import annotations

import math
from dataclasses import dataclass
from dataclasses import field
from functools import cached_property
from typing import Any
from typing import Optional

import numpy as np

from ..discrete import face_areas
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices
from ..model.counts import counted
from ..model.counts import listed
from .development import Development
from .figures import SHORT
from .figures import on_most_of_the_area
from .figures import two_digits
from .fitting import Fit
from .flattening import LONG_ASPECT
from .flattening import STRAIN
from .flattening import strain_of_width
from .flattening import widest_panel
from .materials import MATERIALS
from .materials import Material
from .materials import bending_stress
from .mould_surface import MouldSurface
from .mould_surface import cap_mesh
from .panel_seams import PanelSeam
from .panelling import Panel
from .picture_key import K_MEANING
from .pieces import best_box
from .revolved_mould import RevolvedMould

__all__ = ["Mould", "MouldReport", "PanelFit"]

SCHEDULE = "see the schedule"  # where the names of many panels are


@dataclass(frozen=True)
class Mould:
    """One mould: a cap of a surface of constant curvature."""

    number: int  # from 1
    surface: MouldSurface
    radius: float  # geodesic radius of the smallest cap that holds each of its panels [L]
    panels: int  # number of panels made on it

    @cached_property
    def depth(self) -> float:
        """Height of the cap along the normal of its middle [L]."""
        return float(np.ptp(cap_mesh(self.surface, self.radius)[0][:, 2]))

    @property
    def K(self) -> float:
        """Gaussian curvature [1/L^2]."""
        return self.surface.K

    @property
    def kind(self) -> str:
        """Type of the surface: plane, sphere or pseudosphere, or spindle, bulge or hyperboloid if chosen for least bending."""
        return self.surface.kind

    @property
    def size(self) -> Optional[float]:
        """Radius of the equator of a spindle or bulge, or of the throat of a hyperboloid, on which the pole lies, otherwise None [L]."""
        return self.surface.size if isinstance(self.surface, RevolvedMould) else None

    @property
    def radius_of_curvature(self) -> Optional[float]:
        """``1/√|K|``, None for a plane [L]."""
        return 1.0 / math.sqrt(abs(self.K)) if self.K else None


@dataclass(frozen=True)
class PanelFit:
    """One panel on its mould."""

    panel: Panel
    mould: int  # number of the mould
    radius: float  # geodesic radius of the smallest cap around the panel [L]
    gap: float  # largest distance between the positions of a vertex in different faces [mm]
    edge_error: float  # largest relative difference of edges on the mould
    rigid: float  # largest deviation from its position if it is not bent [mm]
    change: Optional[float]  # largest principal change of curvature from mould to position [1/m]
    stress: Optional[float]  # largest stress of this bending [MPa]
    development: Development  # of the mesh faces that it covers, with the pole at the centre of the cap
    vertices: Vertices  # (p, 3) vertices in position [L]
    faces: Faces  # (f, 3) faces, flipped if the panel is concave towards its normals
    on_mould: Vertices  # (p, 3) vertices on the mould, whose pole is at the origin [L]
    into_place: Fit  # best rigid motion from the mould to the position
    stresses: FloatArray  # (f,) stress of bending of every face, the mean over its corners [MPa]
    sag: float  # largest distance of the edges of its flat triangles from the smooth surface [mm]
    causes: tuple[str, ...]  # why its largest stress grows as the mesh is refined, such as ``a point support``; empty if it does not

    @property
    def singular(self) -> bool:
        """Whether its largest stress grows as the mesh is refined."""
        return bool(self.causes)

    @property
    def stress_95(self) -> float:
        """95th percentile, by area, of the stress of bending [MPa]; unlike the maximum it converges under refinement."""
        return _percentile_95([self])

    @property
    def width(self) -> float:
        """Shorter side of its bounding rectangle in the mean plane [L]."""
        away = self.vertices - self.vertices.mean(axis=0)
        box = best_box(away @ np.linalg.svd(away, full_matrices=False)[2][:2].T, (math.inf, math.inf))
        return min(box.length, box.width)

    def to_dict(self) -> dict[str, Any]:
        """Return the figures as a dict that can be written as JSON."""
        own = {
            name: getattr(self, name) for name in ("mould", "radius", "gap", "edge_error", "rigid", "change", "stress", "singular", "sag")
        }
        return {"panel": self.panel.name, "region": self.panel.region, "faces": len(self.panel.faces), **own}


@dataclass(frozen=True)
class MouldReport:
    """Moulds and panels of a surface.

    Parameters
    ----------
    moulds
        One mould per K, or per group of similar K.
    panels
        Fit of each panel.
    material
        Material of the panels.
    thickness
        Thickness of the sheets [mm].
    unit
        Length of the model unit [m].
    arc
        Whether edges are arc lengths on the moulds instead of chords.
    seams
        Lines along which panels meet.

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
    unit: float  # length of the model unit [m]
    arc: bool  # whether edges are arc lengths on the moulds instead of chords
    seams: list[PanelSeam] = field(default_factory=list)  # lines along which panels meet

    @property
    def sheet(self) -> float:
        """Thickness of the sheets [L]."""
        return 1e-3 * self.thickness / self.unit

    def to_dict(self) -> dict[str, Any]:
        """Return a dict that can be written as JSON."""
        moulds = [
            {
                "mould": own.number,
                "kind": own.kind,
                "K": own.K,
                "radius_of_curvature": own.radius_of_curvature,
                "size": own.size,
                "cap_radius": own.radius,
                "cap_depth": own.depth,
                "panels": own.panels,
            }
            for own in self.moulds
        ]
        beyond = [own.panel.name for own in self.overstressed]
        about = {
            "overstressed": beyond,
            "material": self.material.name,
            "thickness_mm": self.thickness,
            "unit_m": self.unit,
            "edges": self.edges,
        }
        panels = [{**own.to_dict(), "stress_95": own.stress_95, "bending_radius_m": self.bending_radius(own)} for own in self.panels]
        return {"moulds": moulds, "panels": panels, **about}

    @property
    def stress_95(self) -> float:
        """95th percentile, by area, of the bending stress of all panels [MPa]; unlike the maximum it converges under refinement."""
        return _percentile_95(self.panels)

    @property
    def overstressed(self) -> list[PanelFit]:
        """Panels that are bent beyond the strength of the material on more than 5 % of their area."""
        return [own for own in self.panels if 1e6 * own.stress_95 > self.material.strength]

    def bending_radius(self, fit: PanelFit) -> float:
        """Return the radius to which a flat sheet is bent with the same stress as a panel, on 95 % of its area [m]."""
        return bending_stress(self.material, 1e-3 * self.thickness, 1.0) / max(1e6 * fit.stress_95, 1e-300)

    @property
    def edges(self) -> str:
        """``arcs`` or ``chords``: what mesh edges are on the moulds."""
        return "arcs" if self.arc else "chords"

    def __str__(self) -> str:
        return "\n".join(
            [
                *self._overstressed(),
                f"{counted(len(self.panels), 'panel')} on {counted(len(self.moulds), 'mould')}; edges of triangles are "
                f"{self.edges} of the moulds",
                K_MEANING,
                *(line for own in self.moulds for line in self._lines(own)),
                f"bending stress on 95 % of the area of all panels together: at most {two_digits(self.stress_95)} MPa{self._elsewhere()}",
                *self._singular(),
                *self._short(),
                f"panels are drawn as flat triangles, whose edges lie up to {_length(max(own.sag for own in self.panels))} from the smooth "
                "surface; a finer mesh reduces this",
                "congruence does not guarantee that a sheet can be bent into place: check the change of curvature and the stress",
            ]
        )

    def _overstressed(self) -> list[str]:
        """Return a sentence on panels that would break, with remedies."""
        broken = self.overstressed
        if not broken:
            return []
        most = 1e6 * max(own.stress_95 for own in broken)
        strength, own = self.material.strength, self.material
        thinner = f"{self.thickness * strength / most:.2g} mm"
        # Stress is proportional to the stiffness of the plate for the same change of curvature.
        others = [
            other.title
            for other in MATERIALS.values()
            if most * other.modulus / (1.0 - other.poisson**2) / (own.modulus / (1.0 - own.poisson**2)) <= other.strength
        ]
        how = f", use {' or '.join(others)}" if others else ""
        order = sorted(broken, key=lambda fit: -fit.stress_95)
        names = [f"{fit.panel.name} ({two_digits(self.bending_radius(fit))} m, {two_digits(fit.stress_95)} MPa)" for fit in order]
        return [
            f"NOT BUILDABLE like this: {len(broken)} of {counted(len(self.panels), 'panel')} are bent beyond the strength of "
            f"{self.thickness:g} mm {own.title}, and the stress on 95 % of the area of the worst one is "
            f"{100 * most / strength:.0f} % of it "
            f"({two_digits(1e-6 * most)} of {1e-6 * strength:g} MPa, without safety factor). Panels, each with the radius of the cylinder "
            f"to which a flat sheet would be bent to reach the same stress, and this stress: {listed(names, SCHEDULE)}. Make these panels "
            "in their final shape (hot bending, casting) instead of bending them from a mould of constant K, use sheets of at most "
            f"{thinner}{how}"
        ]

    def _elsewhere(self) -> str:
        """Return the stress without the panels whose stress depends on the mesh, empty without such panels or others."""
        others = [own for own in self.panels if not own.singular]
        if not 0 < len(others) < len(self.panels):
            return ""
        return f", {two_digits(_percentile_95(others))} MPa without the panels at places of unbounded curvature"

    def _singular(self) -> list[str]:
        names = [own.panel.name for own in self.panels if own.singular]
        causes = dict.fromkeys(cause for own in self.panels for cause in own.causes)
        if not names:
            return []
        where = "all panels" if len(names) == len(self.panels) > 1 else f"panels {listed(names, SCHEDULE)}"
        return [
            f"curvature is unbounded at {' and '.join(causes)}, so that the largest stress depends on the mesh in {where}; "
            "judge these by the stress on 95 % of their area, on a mesh whose triangles are smaller than a twentieth of a panel"
        ]

    def _short(self) -> list[str]:
        short = [own for own in self.seams if own.length * self.unit < SHORT]
        names = [f"{'/'.join(own.panels)} ({1e3 * self.unit * own.length:.0f} mm)" for own in short]
        return [f"seams shorter than {1e3 * SHORT:g} mm: {', '.join(names)}; panels of another width move them"] if names else []

    def _lines(self, mould: Mould) -> list[str]:
        own = [fit for fit in self.panels if fit.mould == mould.number]
        long = mould.radius_of_curvature
        mm = 1e3 * self.unit
        radius = "" if long is None else f", radius {'' if mould.kind == 'sphere' else '1/√|K| = '}{mm * long:.0f} mm"
        what = f"{mould.kind} of K = {mould.K / self.unit**2:.6g} 1/m²" + radius
        if mould.size is not None:
            what += f", {mm * mould.size:.0f} mm at its {'throat' if mould.K < 0.0 else 'equator'}, on which panels are centred"
        lines = [
            f"mould {mould.number}: {what}, needed for {counted(mould.panels, 'panel')}: a round cap of "
            f"{mm * mould.radius:.0f} mm from its middle to its edge along the surface, {mm * mould.depth:.0f} mm deep",
            f"  fit: gaps between triangles up to {_length(max(fit.gap for fit in own))}, lengths of their edges up to "
            f"{_percent(max(fit.edge_error for fit in own))} different from those in position",
            f"  without bending, panels deviate from their position by {_spread([fit.rigid for fit in own], 'mm')}",
        ]
        changes = [fit.change for fit in own if fit.change is not None]
        stresses = [fit.stress for fit in own if fit.stress is not None]
        if changes:
            part = 1e6 * max(stresses) / self.material.strength
            lines.append(
                f"  bending changes their curvature by {_spread(changes, '1/m')}; stress in {self.thickness:g} mm of "
                f"{self.material.title}: {_spread(stresses, 'MPa')}, {100 * part:.0f} % of the characteristic strength without safety "
                "factor"
            )
        if mould.K:
            wide, strip = widest_panel(mould.K, STRAIN), widest_panel(mould.K, STRAIN, LONG_ASPECT)
            strains = [100 * strain_of_width(mould.K, fit.width) for fit in own]
            widths = _spread([mm * fit.width for fit in own], "mm")
            lines.append(
                f"  pressed flat sheets: {100 * STRAIN:g} % strain allows widths of {mm * wide:.0f} mm (square: sqrt(24 strain / |K|)) or "
                f"{mm * strip:.0f} mm (long strips); these ({widths}) need strains of {_spread(strains, '%')}"
            )
        return lines


def _percentile_95(panels: list[PanelFit]) -> float:
    stress = np.concatenate([own.stresses for own in panels])
    areas = np.concatenate([face_areas(own.vertices, own.faces) for own in panels])
    return on_most_of_the_area(stress, areas)


def _spread(values: list[float], unit: str = "") -> str:
    middle, most = (f"{two_digits(value)} {unit}".rstrip() for value in (float(np.median(values)), max(values)))
    return f"{middle} (median), {most} at most"


def _length(mm: float) -> str:
    """Return a length in millimetres, without digits that no workshop can measure."""
    return f"{two_digits(mm)} mm" if mm >= 1e-3 else "0.001 mm"


def _percent(ratio: float) -> str:
    return f"{two_digits(100 * ratio)} %" if ratio >= 1e-5 else "0.001 %"
