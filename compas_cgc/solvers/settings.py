"""Table of options; checks, schemas, inputs and help texts are made from it."""

from __future__ import annotations

import math
import numbers
import re
import textwrap
from dataclasses import dataclass
from dataclasses import field
from dataclasses import fields
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import TypeVar

from ..errors import names_what_was_meant

__all__ = ["AutoSettings", "Option", "Settings", "documented", "option"]

LARGE = 1e12  # largest integer that an option takes; larger ones are typing errors, and overflow in the solvers
INFINITE = "infinite"


class Option(NamedTuple):
    """One option of a method.

    Parameters
    ----------
    name
        By which doors ask for it.
    kind
        Int, float, str or bool.
    default
        None where it follows from the mesh.
    text
        What it does, in the first sentence on its own.
    low
        Least value, or None.
    high
        Largest value, or None.
    above
        As low, but itself not in the range.
    below
        As high, but itself not in the range.
    choices
        What a word may be; empty for numbers.
    infinite
        May be infinite, which JSON calls "infinite".
    alias
        What doors for designers call it.

    Examples
    --------
    >>> from compas_cgc.solvers import options
    >>> options()["s"].default
    """

    name: str
    kind: type  # int, float, str or bool
    default: Any
    text: str  # what it does, in the first sentence on its own
    low: Optional[float] = None
    high: Optional[float] = None
    above: Optional[float] = None  # as low, but itself not in the range
    below: Optional[float] = None  # as high, but itself not in the range
    choices: tuple[str, ...] = ()
    infinite: bool = False  # may be infinite, which JSON calls "infinite"
    alias: str = ""  # what doors for designers call it

    @property
    def summary(self) -> str:
        """The first sentence of the text."""
        return re.split(r"(?<!Eq)\. ", self.text)[0].rstrip(".").replace("\n", " ") + "."

    @property
    def rule(self) -> str:
        """What a value has to be, in words."""
        none = ", or None" if self.default is None else ""
        if self.kind is bool:
            return "True or False"
        if self.choices:
            return "one of " + ", ".join(self.choices)
        what = "a whole number" if self.kind is int else "a number"
        low = self.low if self.above is None else self.above
        high = self.high if self.below is None else self.below
        if low is not None and high is not None:
            return f"between {low:g} and {high:g}"
        if self.above is not None:
            return f"a positive number{none}" if low == 0 else f"greater than {low:g}"
        return f"{what} from {low:g} up{none}"

    def checked(self, value: Any) -> Any:
        """Return a value as a plain Python one.

        Raises
        ------
        ValueError
            If it is none of those that the option takes.
        """
        if value is None and self.default is None:
            return None
        plain = self._plain(value)
        if plain is None:
            raise ValueError(f"{self.name} must be {self.rule}, not {value!r}")
        return plain

    def _plain(self, value: Any) -> Any:
        if self.kind is bool:
            return bool(value) if type(value).__name__ in ("bool", "bool_") else None
        if self.choices:
            return value if value in self.choices else None
        if self.infinite and value == INFINITE:
            return math.inf
        # numpy's truth values are no numbers either; its numbers are.
        wanted: Any = numbers.Integral if self.kind is int else numbers.Real
        if isinstance(value, bool) or not isinstance(value, wanted) or (self.kind is int and abs(value) > LARGE):
            return None
        number = self.kind(value)
        return number if self._within(number) else None

    def _within(self, number: float) -> bool:
        if math.isnan(number) or (math.isinf(number) and not self.infinite):
            return False
        inside = (self.low is None or number >= self.low) and (self.high is None or number <= self.high)
        return inside and (self.above is None or number > self.above) and (self.below is None or number < self.below)


def option(default: Any, text: str, kind: type, **rules: Any) -> Any:
    """Return a field of settings, see :class:`Option`."""
    return field(default=default, metadata={"option": {"kind": kind, "text": text, **rules}})


@names_what_was_meant()
@dataclass(frozen=True)
class Settings:
    """What all methods have in common.

    Examples
    --------
    >>> from compas_cgc import FlowSettings
    >>> FlowSettings(s=0.5).to_dict()["s"]
    0.5
    """

    def __post_init__(self) -> None:
        for name, own in self.options().items():
            object.__setattr__(self, name, own.checked(getattr(self, name)))

    @classmethod
    def options(cls) -> dict[str, Option]:
        """Return the options by name."""
        return {own.name: Option(own.name, default=own.default, **own.metadata["option"]) for own in fields(cls)}

    def to_dict(self) -> dict:
        """Return the values by name, ready for JSON."""
        values = {own.name: getattr(self, own.name) for own in fields(self)}
        return {name: INFINITE if isinstance(value, float) and math.isinf(value) else value for name, value in values.items()}


S = TypeVar("S", bound=Settings)


def documented(kind: type[S]) -> type[S]:
    """Write the options of settings into their docstring, and have wrong names answered; to be put above ``@dataclass``."""
    lines = [(kind.__doc__ or "").rstrip(), "", "    Parameters", "    ----------"]
    for name, own in kind.options().items():
        lines += [f"    {name}", textwrap.indent(textwrap.fill(f"{own.text} Default: {own.default}.", 100), 8 * " ")]
    kind.__doc__ = "\n".join(lines) + "\n"
    return names_what_was_meant()(kind)


TOLERANCE_TEXT = (
    "Largest |K - K̄| at which the solve stops, relative to the largest |K̄|. If all targets are zero, it is relative to 1 / area. The "
    "solve also stops at rounding level."
)
REST_TEXT = " The position of the fairest surface is computed to 1e-7 of its size, or to this tolerance if that is larger."
MEASURES = ("auto", "defect", "smooth", "exact", "exact-arc")
MEASURE_TEXT = (
    "Measure of K on the mesh. defect: angle defect divided by area, as in the paper. smooth: the same, corrected for the errors "
    "of an irregular mesh. auto: one of these two, selected by the irregularity and the corners of the mesh. "
)
EXACT_TEXT = (
    "exact: angles of triangles in the space of constant curvature, so that every region consists of the triangles of its mould; edges "
    "are chords of the mould. exact-arc: the same with edges as arcs on the mould."
)


@documented
@dataclass(frozen=True)
class AutoSettings(Settings):
    """Settings that all methods have in common, for use with the method ``auto``.

    Examples
    --------
    >>> from compas_cgc import AutoSettings
    >>> AutoSettings(steps=50).steps
    50
    """

    steps: Optional[int] = option(None, "Maximum number of steps of the selected method.", int, low=1)
    tolerance: Optional[float] = option(None, TOLERANCE_TEXT + REST_TEXT, float, low=0)
    measure: str = option("auto", MEASURE_TEXT + EXACT_TEXT, str, choices=MEASURES)
