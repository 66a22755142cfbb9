"""Sampling of parameters: grids, lists, random samples and Latin hypercubes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ..errors import CGCError

__all__ = ["SAMPLES", "Values", "sample", "values_of"]

SAMPLES = ("grid", "list", "random", "latin hypercube")
MAX_VARIANTS = 1_000_000


@dataclass(frozen=True)
class Values:
    """Values of a parameter: a list, or a range between two numbers."""

    listed: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    count: int = 0  # number of values of a range in a grid or a list
    log: bool = False  # whether the scale is logarithmic

    def all(self) -> tuple[Any, ...]:
        """Return the values of a grid, in order."""
        if self.listed:
            return self.listed
        parts = [k / (self.count - 1) for k in range(self.count)] if self.count > 1 else [0.0]
        return tuple(self.at(part) for part in parts)

    def at(self, part: float) -> Any:
        """Return the value at a fraction (0..1) of the range or of the list."""
        if self.listed:
            return self.listed[min(int(part * len(self.listed)), len(self.listed) - 1)]
        if part >= 1.0:
            return self.high
        if self.log:
            return self.low * math.exp(part * math.log(self.high / self.low))
        return self.low + part * (self.high - self.low)


def values_of(name: str, given: Mapping[str, Any], words: bool) -> Values:
    """Return the values given by ``values``, or by ``from``, ``to``, ``count`` and ``scale``.

    Parameters
    ----------
    name
        Name of the parameter.
    given
        Its table in the study.
    words
        Whether the values are words or lists instead of numbers.

    Raises
    ------
    CGCError
        If the values are missing or invalid.
    """
    if "values" in given:
        listed = given["values"]
        if not isinstance(listed, (list, tuple)) or not len(listed):
            raise CGCError(f"the parameter {name}: values must be a list of one or more, not {listed!r}")
        if any(key in given for key in ("from", "to", "count", "scale")):
            raise CGCError(f"the parameter {name} has both values and a range; leave one of them out")
        return Values(tuple(listed) if words else tuple(_number(name, value) for value in listed))
    if words or "from" not in given or "to" not in given:
        range_too = "" if words else ", or a range: from, to and count"
        raise CGCError(f"the parameter {name} has no values; give values{range_too}")
    low, high = _number(name, given["from"]), _number(name, given["to"])
    count = given.get("count", 5)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MAX_VARIANTS:
        raise CGCError(f"the parameter {name}: count must be an integer of at least 1, not {count!r}")
    scale = given.get("scale", "linear")
    if scale not in ("linear", "log"):
        raise CGCError(f"the parameter {name}: scale must be linear or log, not {scale!r}")
    if scale == "log" and not low * high > 0.0:
        raise CGCError(f"the parameter {name}: a log scale requires two numbers of the same sign, not {low:g} and {high:g}")
    return Values(low=low, high=high, count=count, log=scale == "log")


def sample(kind: str, values: Sequence[Values], count: int, seed: int) -> list[tuple[Any, ...]]:
    """Return the values of every variant.

    A grid has every combination, with the last parameter varying fastest. A list combines the first values of all parameters, then
    the second ones, and so on. Random samples are independent. In a Latin hypercube, the range of each parameter is divided into as
    many equal parts as there are variants, with one value in each (McKay, Beckman, Conover, doi:10.2307/1268522).

    Raises
    ------
    CGCError
        If lists have different lengths, or there are too many variants.
    """
    if kind == "grid":
        total = math.prod(len(own.listed) or own.count for own in values)
        if total > MAX_VARIANTS:
            raise CGCError(f"this grid has {total} variants, but the limit is {MAX_VARIANTS}: use fewer values, or another kind of sample")
        return list(product(*(own.all() for own in values)))
    if kind == "list":
        columns = [own.all() for own in values]
        if len({len(column) for column in columns}) > 1:
            raise CGCError(
                "with the sample kind 'list' all parameters need the same number of values, "
                f"not {', '.join(str(len(column)) for column in columns)}"
            )
        return list(zip(*columns))
    random = np.random.Generator(np.random.PCG64(seed))
    if kind == "random":
        parts = random.random((count, len(values)))
    else:
        ranks = np.column_stack([random.permutation(count) for _ in values])
        parts = (ranks + random.random((count, len(values)))) / count
    return [tuple(own.at(float(part)) for own, part in zip(values, row)) for row in parts]


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise CGCError(f"the parameter {name}: {value!r} is not a number")
    return float(value)
