"""Laws: relations f(H, K) = 0 between mean and Gaussian curvature that a region of a surface obeys."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union
from typing import cast

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import names_what_was_meant
from .given import checked_number

__all__ = [
    "ConstantCurvature",
    "ConstantMeanCurvature",
    "Law",
    "LinearWeingarten",
    "Minimal",
    "Piecewise",
    "Shape",
    "as_law",
    "laws_by_region",
    "types_of",
]

Curvature = Union[float, FloatArray]
Second = Optional[tuple[Curvature, Curvature, Curvature]]


class Shape(NamedTuple):
    """Shape operators that obey a law, as initial guesses: ``(mean ± round) I`` or ``mean I + saddle diag(1, -1)``, each (k,) or ()."""

    mean: FloatArray  # [1/L]
    round: FloatArray  # [1/L]
    saddle: FloatArray  # [1/L]


@names_what_was_meant()
class Law:
    """A relation f(H, K) = 0 between the mean curvature H and the Gaussian curvature K.

    H is the mean of the principal curvatures, positive where the surface is convex towards the side of its normals: a dome over
    a plan whose normals point up has H > 0, a sphere with outward normals H = 1/r. A subclass defines the methods below; no
    other part of the package needs to be changed for a new law. A law f = g(H, K) - c whose constant c may be an unknown also defines
    :attr:`constant` and :meth:`with_constant`.

    Examples
    --------
    >>> import numpy as np
    >>> from compas_cgc import ConstantMeanCurvature
    >>> ConstantMeanCurvature(0.1).residual(np.array([0.3]), np.array([0.0])).round(6).tolist()
    [0.2]
    """

    def __init__(self) -> None: ...

    def residual(self, H: FloatArray, K: FloatArray) -> FloatArray:
        """Return f (k,) at mean curvatures [1/L] and Gaussian curvatures [1/L^2] (k,)."""
        raise NotImplementedError

    def first_derivatives(self, H: FloatArray, K: FloatArray) -> tuple[Curvature, Curvature]:
        """Return the derivatives of f by H and by K, each (k,) or one number."""
        raise NotImplementedError

    def second_derivatives(self, H: FloatArray, K: FloatArray) -> Second:
        """Return the derivatives of f by HH, HK and KK, None if the law is linear."""
        raise NotImplementedError

    def shape(self) -> Shape:
        """Return shape operators that obey the law, for initial guesses."""
        raise NotImplementedError

    def scale(self, area: float) -> float:
        """Return the value that residuals are compared with, for a surface of this area [L^2]."""
        raise NotImplementedError

    def scaled(self, factor: float) -> Law:
        """Return the law of the surface with all lengths multiplied by a factor."""
        raise NotImplementedError

    def normalised(self) -> Law:
        """Return the same law, with first derivatives of order one."""
        return self

    @property
    def constant(self) -> Optional[float]:
        """The constant c of a law f = g(H, K) - c, such as h of H = h; None if the law has none. Similarities multiply it."""
        return None

    @property
    def constant_name(self) -> str:
        """The constant in words."""
        return "c"

    def with_constant(self, constant: float) -> Law:
        """Return the law with another constant."""
        raise ValueError(f"the law {self} has no constant")

    @property
    def is_isothermic(self) -> bool:
        """Whether lines of curvature of all its surfaces can be spaced so that they form squares, as for constant H."""
        return False

    def discriminant(self, H: FloatArray, K: FloatArray) -> FloatArray:
        r"""Return :math:`f_H^2 + 4 f_H f_K H + 4 f_K^2 K`, whose sign is the type: elliptic > 0, parabolic = 0, hyperbolic < 0.

        Normal moves u change f by :math:`-\operatorname{tr}((\tfrac12 f_H I + f_K \operatorname{cof} S) \nabla^2 u)` in the second
        derivatives of u; the discriminant is four times the determinant of this symbol.
        """
        by_H, by_K = self.first_derivatives(H, K)
        return np.asarray(by_H**2 + 4.0 * by_H * by_K * H + 4.0 * by_K**2 * K)

    @property
    def type(self) -> str:
        """``elliptic``, ``parabolic`` or ``hyperbolic`` (discriminant on a plane > 0, = 0, < 0)."""
        discriminant = float(np.max(self.discriminant(np.zeros(1), np.zeros(1))))
        return "elliptic" if discriminant > 0.0 else "hyperbolic" if discriminant < 0.0 else "parabolic"

    def excluded_within(self, length: float, area: float) -> str:
        """Return why no surface obeys the law within a plane closed curve of this length [L] and area [L^2], empty if one may."""
        return ""

    @property
    def words(self) -> str:
        """The residual in words, such as ``|K - 0.01|``."""
        return f"residual of {self}"

    @property
    def description(self) -> str:
        """What the law is used for, in one sentence."""
        return ""


class _Linear(Law):
    """A law a H + b K = c."""

    @property
    def coefficients(self) -> tuple[Curvature, Curvature, Curvature]:
        """The coefficients a, b, c."""
        raise NotImplementedError

    def residual(self, H: FloatArray, K: FloatArray) -> FloatArray:
        a, b, c = self.coefficients
        return np.asarray(a * H + b * K - c)

    def first_derivatives(self, H: FloatArray, K: FloatArray) -> tuple[Curvature, Curvature]:
        a, b, _ = self.coefficients
        return a, b

    def second_derivatives(self, H: FloatArray, K: FloatArray) -> Second:
        return None

    def discriminant(self, H: FloatArray, K: FloatArray) -> FloatArray:
        a, b, c = self.coefficients
        return np.broadcast_to(a**2 + 4.0 * b * c, np.shape(H))

    def shape(self) -> Shape:
        # With b not 0 the law reads det(S + (a / 2b) I) = (a² + 4 b c) / 4 b².
        a, b, c = self.coefficients
        if np.ndim(b) == 0 and b == 0.0:
            return Shape(np.asarray(c / a), np.zeros(()), np.zeros(()))
        square = np.asarray((a**2 + 4.0 * b * c) / (4.0 * b**2))
        return Shape(np.asarray(-0.5 * a / b), np.sqrt(np.maximum(square, 0.0)), np.sqrt(np.maximum(-square, 0.0)))

    def scale(self, area: float) -> float:
        a, b, c = self.coefficients
        largest = float(np.abs(c).max(initial=0.0))
        return largest if largest > 0.0 else abs(float(a)) / math.sqrt(area) + abs(float(b)) / area

    @property
    def constant(self) -> float:
        return cast(float, self.coefficients[2])

    @property
    def is_isothermic(self) -> bool:
        # With b = 0 the Hopf differential is holomorphic, so that squares have sides in proportion to 1 / sqrt(k1 - k2).
        return np.ndim(self.coefficients[1]) == 0 and self.coefficients[1] == 0.0

    @property
    def admissible(self) -> tuple[tuple[float, float], ...]:
        """Intervals of the mean curvature H that the law allows, since H² >= K on every surface [1/L]."""
        a, b, c = (float(value) for value in self.coefficients)
        if b == 0.0:
            return ((c / a, c / a),)
        discriminant = a**2 + 4.0 * b * c
        if discriminant <= 0.0:
            return ((-math.inf, math.inf),)
        middle, half = -0.5 * a / b, 0.5 * math.sqrt(discriminant) / abs(b)
        return ((-math.inf, middle - half), (middle + half, math.inf))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Linear) and self.coefficients == other.coefficients

    def __hash__(self) -> int:
        return hash(self.coefficients)


@names_what_was_meant()
@dataclass(frozen=True, eq=False)
class ConstantCurvature(_Linear):
    """Constant Gaussian curvature, K = k.

    Parameters
    ----------
    k
        Gaussian curvature [1/L^2].

    Examples
    --------
    >>> ConstantCurvature(-0.01).type
    'hyperbolic'
    """

    k: Curvature

    def __post_init__(self) -> None:
        if not isinstance(self.k, np.ndarray):
            _checked(self.k, "the Gaussian curvature k")

    @property
    def coefficients(self) -> tuple[Curvature, Curvature, Curvature]:
        """The coefficients 0, 1, k."""
        return 0.0, 1.0, self.k

    @property
    def constant_name(self) -> str:
        return "K"

    def with_constant(self, constant: float) -> Law:
        return ConstantCurvature(constant)

    def scaled(self, factor: float) -> ConstantCurvature:
        return ConstantCurvature(self.k / factor**2)

    def __str__(self) -> str:
        return f"K = {float(self.k)!r}"

    @property
    def words(self) -> str:
        return "|K - K̄|"

    @property
    def description(self) -> str:
        return "panels from one mould per region; K = 0 unrolls into plane sheets, K < 0 carries nets of straight laths"


@names_what_was_meant()
@dataclass(frozen=True, eq=False)
class ConstantMeanCurvature(_Linear):
    """Constant mean curvature, H = h: a membrane with equal tension in all directions under constant pressure.

    Parameters
    ----------
    h
        Mean of the principal curvatures [1/L], positive where the surface rises to the side of its normals.

    Examples
    --------
    >>> ConstantMeanCurvature(0.1).type
    'elliptic'
    """

    h: float

    def __post_init__(self) -> None:
        _checked(self.h, "the mean curvature h")

    @property
    def coefficients(self) -> tuple[Curvature, Curvature, Curvature]:
        """The coefficients 1, 0, h."""
        return 1.0, 0.0, self.h

    @property
    def constant_name(self) -> str:
        return "H"

    def with_constant(self, constant: float) -> Law:
        return ConstantMeanCurvature(constant)

    def scaled(self, factor: float) -> Law:
        return ConstantMeanCurvature(self.h / factor)

    def excluded_within(self, length: float, area: float) -> str:
        # Pressure 2 h on the area is in balance with a tension of 1 along the curve (Heinz, 1969).
        highest = 0.5 * length / area
        if abs(self.h) <= highest:
            return ""
        return f"within a boundary of length {length:.3g} around an area of {area:.3g}, |H| is at most {highest:.3g}; prescribe a smaller H"

    def __str__(self) -> str:
        return f"H = {float(self.h)!r}"

    @property
    def words(self) -> str:
        return f"|H - {self.h:.3g}|"

    @property
    def description(self) -> str:
        return "pneumatic cushions: equal tension in all directions carries constant pressure, and the curvature net has square panels"


@names_what_was_meant()
@dataclass(frozen=True, eq=False)
class Minimal(_Linear):
    """Mean curvature zero, H = 0: a soap film, whose area is stationary for its boundary.

    Examples
    --------
    >>> from compas_cgc import Minimal
    >>> print(Minimal(), Minimal().type)
    H = 0 elliptic
    """

    @property
    def coefficients(self) -> tuple[Curvature, Curvature, Curvature]:
        """The coefficients 1, 0, 0."""
        return 1.0, 0.0, 0.0

    @property
    def constant_name(self) -> str:
        return "H"

    def with_constant(self, constant: float) -> Law:
        return ConstantMeanCurvature(constant) if constant else self

    def scaled(self, factor: float) -> Law:
        return self

    def __str__(self) -> str:
        return "H = 0"

    @property
    def words(self) -> str:
        return "|H|"

    @property
    def description(self) -> str:
        return "prestressed membranes with equal tension in all directions; asymptotic and curvature nets meet at 45 degrees"


@names_what_was_meant()
@dataclass(frozen=True, eq=False)
class LinearWeingarten(_Linear):
    """A linear relation a H + b K = c, such as of surfaces parallel to one of constant K or constant H.

    Parameters
    ----------
    a, b, c
        Coefficients [1], [L] and [1/L], or multiples of these.

    Examples
    --------
    >>> LinearWeingarten(1, 2, 0.5).type
    'elliptic'
    """

    a: float
    b: float
    c: float

    def __post_init__(self) -> None:
        for name in ("a", "b", "c"):
            _checked(getattr(self, name), f"the coefficient {name}")
        if self.a == 0.0 and self.b == 0.0:
            raise ValueError("the coefficients a and b must not both be 0")

    @property
    def coefficients(self) -> tuple[Curvature, Curvature, Curvature]:
        """The coefficients a, b, c."""
        return self.a, self.b, self.c

    def with_constant(self, constant: float) -> Law:
        return LinearWeingarten(self.a, self.b, constant)

    def scaled(self, factor: float) -> Law:
        return LinearWeingarten(self.a * factor, self.b * factor**2, self.c)

    def normalised(self) -> Law:
        size = math.hypot(self.a, self.b)
        return LinearWeingarten(self.a / size, self.b / size, self.c / size)

    def __str__(self) -> str:
        return f"{float(self.a)!r} H {'-' if self.b < 0 else '+'} {abs(float(self.b))!r} K = {float(self.c)!r}"

    @property
    def words(self) -> str:
        return f"|{self.a:.3g} H {'-' if self.b < 0 else '+'} {abs(self.b):.3g} K {'+' if self.c < 0 else '-'} {abs(self.c):.3g}|"

    @property
    def description(self) -> str:
        return (
            "offsets of surfaces of constant K or constant H; one principal curvature determines the other, so that shapes of nodes repeat"
        )


def _checked(value: object, name: str) -> None:
    if not math.isfinite(checked_number(value, name)):
        raise ValueError(f"{name} must be a finite number, not {value!r}")


def types_of(targets: FloatArray) -> FloatArray:
    """Return the types of K = K̄ for targets (k,): 1 elliptic, 0 parabolic, -1 hyperbolic, NaN without a target."""
    return np.sign(ConstantCurvature(targets).discriminant(targets, targets))


class Piecewise(Law):
    """The laws of k points, each with its own.

    Parameters
    ----------
    laws
        Laws.
    of
        ``(k,)`` index of the law of each point.
    """

    def __init__(self, laws: Sequence[Law], of: IntArray):
        self.laws, self.of = laws, of
        places: list[Any] = [np.flatnonzero(of == i) for i in range(len(laws))] if len(laws) > 1 else [slice(None)]
        self.parts = list(zip(laws, places))

    def _put(self, values: Sequence[Curvature]) -> FloatArray:
        whole = np.empty(len(self.of))
        for (_, at), value in zip(self.parts, values):
            whole[at] = value
        return whole

    def residual(self, H: FloatArray, K: FloatArray) -> FloatArray:
        return self._put([law.residual(H[at], K[at]) for law, at in self.parts])

    def first_derivatives(self, H: FloatArray, K: FloatArray) -> tuple[FloatArray, FloatArray]:
        by_H, by_K = zip(*(law.first_derivatives(H[at], K[at]) for law, at in self.parts))
        return self._put(by_H), self._put(by_K)

    def second_derivatives(self, H: FloatArray, K: FloatArray) -> Second:
        found = [law.second_derivatives(H[at], K[at]) for law, at in self.parts]
        if not any(found):
            return None
        HH, HK, KK = (self._put(values) for values in zip(*(own or (0.0, 0.0, 0.0) for own in found)))
        return HH, HK, KK

    def shape(self) -> Shape:
        return Shape(*(self._put(values) for values in zip(*(law.shape() for law, _ in self.parts))))

    def discriminant(self, H: FloatArray, K: FloatArray) -> FloatArray:
        return self._put([law.discriminant(H[at], K[at]) for law, at in self.parts])

    def scales(self, area: float) -> FloatArray:
        """Return what residuals are compared with (k,)."""
        return self._put([law.scale(area) for law, _ in self.parts])

    def normalised(self) -> Piecewise:
        return Piecewise([law.normalised() for law, _ in self.parts], self.of)

    def largest(self, H: FloatArray, K: FloatArray) -> list[tuple[Law, float]]:
        """Return the largest absolute residual of each law, in its own units."""
        return [(law, float(np.abs(law.residual(H[at], K[at])).max(initial=0.0))) for law, at in self.parts]


NUMBER = r"[-+]?\s*(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
REGION = re.compile(r"\s*(\d+)\s*=")
TERM = re.compile(rf"\s*(?P<factor>{NUMBER}|[-+]?)\s*\*?\s*(?P<name>[HK])\b")


def as_law(given: object) -> Law:
    """Return the law of a value: a law, a number (constant K) or a text.

    Texts are ``minimal``, ``H = 0.1``, ``K = 0.01`` and ``2 H + 0.5 K = 0.3``; an equation without right side, such as ``H``, is one of 0.

    Raises
    ------
    ValueError
        If the text is no law.

    Examples
    --------
    >>> as_law("2 H - 0.5 K = 0.3")
    LinearWeingarten(a=2.0, b=-0.5, c=0.3)
    >>> as_law("minimal")
    Minimal()
    """
    if isinstance(given, Law):
        return given
    if not isinstance(given, str):
        return ConstantCurvature(checked_number(given, "a law that is not a text"))
    if given.strip().lower() == "minimal":
        return Minimal()
    left, equals, right = given.partition("=")
    factors, end = {"H": 0.0, "K": 0.0}, 0
    try:
        value = float(right) if equals else 0.0
        while left[end:].strip():
            term = TERM.match(left, end)
            if term is None or (end and not term["factor"].startswith(("+", "-"))) or not math.isfinite(value):
                raise ValueError
            factor = term["factor"].replace(" ", "")
            factors[term["name"]] += float(factor + "1" if factor in ("", "+", "-") else factor)
            end = term.end()
    except ValueError:
        raise ValueError(_no_law(given)) from None
    a, b = factors["H"], factors["K"]
    if a == 0.0 and b == 0.0:
        raise ValueError(_no_law(given))
    if b == 0.0:
        return ConstantMeanCurvature(value / a) if value else Minimal()
    return ConstantCurvature(value / b) if a == 0.0 else LinearWeingarten(a, b, value)


def laws_by_region(texts: Iterable[str], count: int) -> dict[int, str]:
    """Return laws by region from texts ``[REGION=]LAW`` for a number of regions; those for all regions apply where no other is given.

    Examples
    --------
    >>> laws_by_region(["1=H = 0.1", "minimal"], 3)
    {0: 'minimal', 1: 'H = 0.1', 2: 'minimal'}
    """
    laws: dict[int, str] = {}
    for text in sorted(texts, key=lambda text: REGION.match(text) is not None):
        found = REGION.match(text)
        laws.update(dict.fromkeys(range(count), text) if found is None else {int(found[1]): text[found.end() :]})
    return laws


def _no_law(given: str) -> str:
    return f"{given!r} is not a law; write minimal, H = 0.1, K = 0.01 or 2 H + 0.5 K = 0.3 (H mean, K Gaussian curvature)"
