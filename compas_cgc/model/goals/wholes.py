"""Goals for one quantity of the whole surface, and unknown K."""

from __future__ import annotations

import math
from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import replace
from typing import Optional
from typing import Union

from ..constraints import Constraint
from ..constraints import Height
from ..given import checked_number
from ..motion import Motion
from .numbers import ALL
from .numbers import check_finite
from .numbers import check_positive

__all__ = ["Area", "Length", "Rise", "Unknown", "Volume", "Whole", "is_of_whole"]


@dataclass(frozen=True)
class Whole(Constraint):
    """Base class of goals for one quantity of the whole surface."""


@dataclass(frozen=True)
class Rise(Whole):
    """Prescribe the height of the crown over the mean height of the supports; negative if the surface hangs.

    Parameters
    ----------
    rise
        Height over the supports [L]; not 0.

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

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must stay vertical."""
        return up != 0.0

    def transformed(self, motion: Motion) -> Rise:
        """Return the rise after a motion."""
        return replace(self, rise=motion.up * motion.measure(self.rise))


@dataclass(frozen=True)
class Volume(Whole):
    """Prescribe the volume between the surface and a horizontal plane.

    Parameters
    ----------
    volume
        Positive volume [L^3].
    level
        z of the plane [L]. Default: the mean height of the supports.

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

    def admits(self, up: float) -> bool:
        """Check whether the goal can follow a motion: the z axis must keep its direction."""
        return up > 0.0

    def transformed(self, motion: Motion) -> Volume:
        """Return the volume after a motion."""
        level = None if self.level is None else motion.height(self.level)
        return replace(self, volume=motion.measure(self.volume, 3), level=level)


@dataclass(frozen=True)
class Area(Whole):
    """Prescribe the area of the surface.

    Parameters
    ----------
    area
        Area of the surface [L^2].

    Examples
    --------
    >>> from compas_cgc import Area
    >>> Area(240.0)
    Area(area=240.0)
    """

    area: float

    def __post_init__(self) -> None:
        check_positive(self.area, "area")

    def transformed(self, motion: Motion) -> Area:
        """Return the area after a motion."""
        return replace(self, area=motion.measure(self.area, 2))


@dataclass(frozen=True)
class Length(Whole):
    """Prescribe the length of a path of vertices.

    Parameters
    ----------
    vertices
        Indices of two or more vertices, in their order.
    length
        Length of the path on the surface [L].

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
            raise ValueError("vertices of a length must be a path of two or more vertices")

    def transformed(self, motion: Motion) -> Length:
        """Return the length after a motion."""
        return replace(self, length=motion.measure(self.length))


@dataclass(frozen=True)
class Unknown(Constraint):
    """Regions whose K, or whose constant of another law, is determined by the solve; the drawn value is the initial guess.

    Parameters
    ----------
    regions
        Numbers of regions, or ``"all"``.
    ratio
        Whether the regions keep the ratios of their drawn values, so that they are one unknown.
    sign
        1 or -1: the sign that K must have. Default: that of the drawn value.
    bounds
        The least and the largest K allowed [1/L^2].

    Examples
    --------
    >>> from compas_cgc import Unknown
    >>> Unknown([0, 2]).regions
    [0, 2]
    >>> Unknown([0, 2], ratio=True, bounds=[0.01, 0.05]).least
    0.01
    """

    regions: Union[str, Sequence[int]] = ALL
    ratio: bool = False
    sign: Optional[int] = None
    bounds: Optional[Sequence[float]] = None

    def __post_init__(self) -> None:
        if isinstance(self.regions, str) and self.regions != ALL:
            raise ValueError(f"regions of unknown K must be their numbers or 'all', not {self.regions!r}")
        if self.sign not in (None, 1, -1):
            raise ValueError(f"the sign of an unknown K must be 1 or -1, not {self.sign!r}")
        if self.bounds is not None:
            ends = [checked_number(end, "every bound of K") for end in self.bounds]
            if len(ends) != 2 or not -math.inf < ends[0] < ends[1] < math.inf:
                raise ValueError(
                    f"bounds of an unknown K must be its least and its largest value, such as [0.01, 0.05], not {self.bounds!r}"
                )
        if not self.least < self.largest:
            raise ValueError(f"the bounds {self.bounds!r} of an unknown K leave no K of the sign {self.sign}")

    @property
    def least(self) -> float:
        """The least K allowed [1/L^2]."""
        low = -math.inf if self.bounds is None else float(self.bounds[0])
        return max(low, 0.0) if self.sign == 1 else low

    @property
    def largest(self) -> float:
        """The largest K allowed [1/L^2]."""
        high = math.inf if self.bounds is None else float(self.bounds[1])
        return min(high, 0.0) if self.sign == -1 else high

    @property
    def words(self) -> str:
        """The values allowed, in words."""
        if math.isinf(self.largest):
            return f"at least {self.least:.6g}"
        return f"at most {self.largest:.6g}" if math.isinf(self.least) else f"between {self.least:.6g} and {self.largest:.6g}"

    def transformed(self, motion: Motion) -> Unknown:
        """Return the bounds after a motion."""
        return self if self.bounds is None else replace(self, bounds=[motion.measure(end, -2) for end in self.bounds])

    def with_regions(self, number: Callable[[int], int]) -> Unknown:
        """Return the goal with other numbers of its regions."""
        return self if isinstance(self.regions, str) else replace(self, regions=[number(region) for region in self.regions])


def is_of_whole(goal: Constraint) -> bool:
    """Check whether a goal prescribes a quantity of the whole surface or makes K unknown."""
    return isinstance(goal, (Whole, Unknown)) or (isinstance(goal, Height) and isinstance(goal.vertices, str))
