"""Goals that are one number of the whole surface, and K that is to be found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import Optional
from typing import Union

from ..constraints import AtHeight
from ..constraints import Constraint
from ..frame import Frame
from .numbers import ALL
from .numbers import check_finite
from .numbers import check_positive
from .numbers import local_height

__all__ = ["Area", "Length", "Rise", "Unknown", "Volume", "Whole", "is_of_whole"]


@dataclass(frozen=True)
class Whole(Constraint):
    """Base of goals that are one number of the whole surface."""


@dataclass(frozen=True)
class Rise(Whole):
    """Height of the crown over the mean height of the supports [L]; negative where the surface hangs.

    Parameters
    ----------
    rise
        Of the crown over the supports [L]; not 0.

    Examples
    --------
    >>> import compas_cgc
    >>> mesh = compas_cgc.read(compas_cgc.get("cushion.3dm"))
    >>> result = compas_cgc.solve(mesh, goals=[compas_cgc.Rise(0.6)], unknown="all")
    >>> float(round(result.vertices[:, 2].max(), 6))
    0.6
    """

    rise: float

    def __post_init__(self) -> None:
        check_finite(self.rise, "rise")
        if not self.rise:
            raise ValueError(f"rise must be a number other than 0, not {self.rise!r}")

    def local(self, frame: Frame) -> Rise:
        """Return the rise in a local frame."""
        return replace(self, rise=self.rise / frame.scale)


@dataclass(frozen=True)
class Volume(Whole):
    """Volume between the surface and a level z [L^3]; default: the mean height of the supports.

    Parameters
    ----------
    volume
        Above zero [L^3].
    level
        z that it counts from [L]. Default: the mean height of the supports.

    Examples
    --------
    >>> from compas_cgc import Volume
    >>> Volume(300.0).level is None
    True
    """

    volume: float
    level: Optional[float] = None

    def __post_init__(self) -> None:
        check_positive(self.volume, "volume")
        if self.level is not None:
            check_finite(self.level, "level")

    def local(self, frame: Frame) -> Volume:
        """Return the volume in a local frame."""
        level = None if self.level is None else local_height(self.level, frame)
        return replace(self, volume=self.volume / frame.scale**3, level=level)


@dataclass(frozen=True)
class Area(Whole):
    """Area of the surface [L^2].

    Parameters
    ----------
    area
        Of the surface [L^2].

    Examples
    --------
    >>> from compas_cgc import Area
    >>> Area(240.0)
    Area(area=240.0)
    """

    area: float

    def __post_init__(self) -> None:
        check_positive(self.area, "area")

    def local(self, frame: Frame) -> Area:
        """Return the area in a local frame."""
        return replace(self, area=self.area / frame.scale**2)


@dataclass(frozen=True)
class Length(Whole):
    """Length of a path of vertices, in their order [L].

    Parameters
    ----------
    vertices
        A path of two or more, in their order.
    length
        Of the path on the surface [L].

    Examples
    --------
    >>> from compas_cgc import Length
    >>> Length([0, 1, 2], 2.5).length
    2.5
    """

    vertices: Sequence[int]
    length: float

    def __post_init__(self) -> None:
        check_positive(self.length, "length")
        if len(self.vertices) < 2:
            raise ValueError("vertices of a length must be a path of two or more")

    def local(self, frame: Frame) -> Length:
        """Return the length in a local frame."""
        return replace(self, length=self.length / frame.scale)


@dataclass(frozen=True)
class Unknown(Constraint):
    """Regions whose K is not given but found, together with the surface: those numbered, or ``"all"``.

    Parameters
    ----------
    regions
        Numbers of regions, or ``"all"``.

    Examples
    --------
    >>> from compas_cgc import Unknown
    >>> Unknown([0, 2]).regions
    [0, 2]
    """

    regions: Union[str, Sequence[int]] = ALL

    def __post_init__(self) -> None:
        if isinstance(self.regions, str) and self.regions != ALL:
            raise ValueError(f"regions of unknown K must be their numbers or 'all', not {self.regions!r}")


def is_of_whole(goal: Constraint) -> bool:
    """Return whether a goal is one number of the whole surface, or K that is to be found."""
    return isinstance(goal, (Whole, Unknown)) or (isinstance(goal, AtHeight) and isinstance(goal.vertices, str))
