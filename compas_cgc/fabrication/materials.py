"""Sheet materials and bending stress."""

from __future__ import annotations

from typing import NamedTuple
from typing import Union

from ..errors import CGCError
from ..model.units import METRES

__all__ = ["MATERIALS", "Material", "bending_stress", "material_named", "metres_per_unit", "refuse_foil"]


MIN_THICKNESS = 0.01  # of sheets, below which it is probably in other units [mm]


class Material(NamedTuple):
    """An isotropic elastic sheet material.

    Parameters
    ----------
    name
        Name of the material.
    modulus
        Young's modulus E [Pa].
    poisson
        Poisson's ratio.
    strength
        Characteristic bending strength without safety factor [Pa].
    ductile
        Whether the material yields, so that its strength limits the von Mises stress too.

    Examples
    --------
    >>> Material("plywood", 9000.0, 0.1, 40.0).name
    'plywood'
    """

    name: str
    modulus: float  # Young's modulus [Pa]
    poisson: float  # ν
    strength: float  # characteristic bending strength without safety factor [Pa]
    ductile: bool = False  # whether the strength limits the von Mises stress too

    @property
    def title(self) -> str:
        """Name for readers, with abbreviations in full."""
        return "glass-fibre reinforced plastic (gfrp)" if self.name == "gfrp" else self.name


# Annealed float glass EN 572 and EN 16612; steel S235, EN 1993-1-1; a glass-fibre laminate EN 13706 E23; timber C24, EN 338.
MATERIALS = {
    own.name: own
    for own in (
        Material("glass", 70e9, 0.23, 45e6),
        Material("steel", 210e9, 0.3, 235e6, ductile=True),
        Material("gfrp", 23e9, 0.3, 240e6),
        Material("timber", 11e9, 0.3, 24e6),
    )
}


def material_named(material: Union[str, Material]) -> Material:
    """Return the material with a name in :data:`MATERIALS`, or the given one.

    Raises
    ------
    CGCError
        If the name is unknown.
    """
    if isinstance(material, Material):
        return material
    found = MATERIALS.get(str(material).strip().lower())
    if found is None:
        raise CGCError(f"there is no material {material!r}; use one of {', '.join(MATERIALS)}, or give a Material")
    return found


def bending_stress(material: Material, thickness: float, change: float) -> float:
    """Return ``E t Δκ / 2 (1 - ν²)``, the largest stress of a plate bent by a change of curvature [Pa].

    Parameters
    ----------
    material
        Material of the plate.
    thickness
        Thickness of the plate [m].
    change
        Change of curvature [1/m].
    """
    return material.modulus * thickness * change / (2.0 * (1.0 - material.poisson**2))


def metres_per_unit(units: Union[str, None]) -> float:
    """Return the length of one drawing unit [m]; a drawing without units is in metres.

    Raises
    ------
    CGCError
        If the unit is unknown.
    """
    if units is None:
        return 1.0
    if units not in METRES:
        raise CGCError(f"the unit {units!r} is not supported; draw in {', '.join(METRES)}")
    return METRES[units]


def refuse_foil(thickness: float) -> None:
    """Refuse a thickness [mm] that is probably in metres.

    Raises
    ------
    CGCError
        With the thickness in millimetres.
    """
    if thickness < MIN_THICKNESS:
        raise CGCError(f"a thickness of {thickness:g} mm is thinner than foil; give it in mm, such as {1e3 * thickness:g}")
