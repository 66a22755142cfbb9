"""Study: what is varied, how it is sampled and what is measured, as a value and as a TOML file."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field
from functools import cached_property
from pathlib import Path
from typing import Any
from typing import Optional
from typing import Union

from ..errors import CGCError
from ..errors import FileError
from ..errors import did_you_mean
from ..errors import names_what_was_meant
from ..model.constraint_data import as_goals
from ..model.problem import CGCProblem
from ..solvers.registry import settings_for
from ..solvers.settings import Settings
from .parameters import Parameter
from .parameters import parameter_of
from .sampling import MOST
from .sampling import SAMPLES
from .sampling import sample

__all__ = ["Ranking", "Study", "read_study"]

_KEYS = (
    "sample",
    "count",
    "seed",
    "parameters",
    "supports",
    "target",
    "goals",
    "unknown",
    "method",
    "settings",
    "panels",
    "membrane",
    "pareto",
    "best",
)
_PANELS = ("size", "count", "along", "material", "thickness", "tolerance")
_MEMBRANE = ("pressure", "weight", "edge_beams")


@dataclass(frozen=True)
class Ranking:
    """Columns of the table of which a designer wants the least or the most."""

    least: tuple[str, ...] = ()
    most: tuple[str, ...] = ()
    count: int = 0  # of the best that are written as files of their own

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns, those of which the least is wanted first."""
        return (*self.least, *self.most)


@names_what_was_meant()
@dataclass(frozen=True)
class Study:
    """Variants of a drawing: made of plain data by :meth:`from_dict`, or of a file by :func:`read_study`.

    Parameters
    ----------
    parameters
        What is varied, by name: values, or a range.
    sample
        How values are taken from the ranges.
    count
        Of random samples.
    seed
        Of what is taken at random.
    supports
        Other supports than those of the drawing.
    target
        K of all regions, or by region.
    goals
        As for :func:`compas_cgc.solve`.
    unknown
        As for :func:`compas_cgc.solve`.
    method
        As for :func:`compas_cgc.solve`.
    settings
        As for :func:`compas_cgc.solve`.
    panels
        How surfaces are divided, where panels are asked for.
    membrane
        Load, where forces are asked for.
    pareto
        Columns that are wanted small or large.
    best
        How many of the best are written as files.
    data
        That it was made of.

    Examples
    --------
    >>> study = Study.from_dict({"parameters": {"K": {"from": 0.002, "to": 0.004, "count": 3}, "s": [0.0, 0.5]}})
    >>> len(study.variants), study.variants[1]
    (6, (0.002, 0.5))
    """

    parameters: tuple[Parameter, ...]
    sample: str = "grid"
    count: int = 0  # of random samples
    seed: int = 1
    supports: Optional[Union[str, list[int]]] = None
    target: Any = None  # K of all regions, or by region
    goals: tuple[Mapping[str, Any], ...] = ()
    unknown: Any = ()
    method: str = "auto"
    settings: Mapping[str, Any] = field(default_factory=dict)
    panels: Optional[Mapping[str, Any]] = None
    membrane: Optional[Mapping[str, Any]] = None
    pareto: Ranking = Ranking()
    best: Ranking = Ranking()
    data: Mapping[str, Any] = field(default_factory=dict)  # that it was made of

    def __post_init__(self) -> None:
        if not (isinstance(self.parameters, tuple) and all(isinstance(each, Parameter) for each in self.parameters)):
            raise CGCError(
                f"a study is made of plain data: Study.from_dict({{...}}), or read_study('study.toml'), not {self.parameters!r:.60}"
            )

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Study:
        """Return the study that plain data describe.

        Raises
        ------
        CGCError
            If they are not understood, with what is.
        """
        data = _plain(data)
        _known("a study", data, _KEYS)
        named = data.get("parameters")
        if not isinstance(named, Mapping) or not named:
            raise CGCError("a study needs parameters, such as K = { from = 0.002, to = 0.006, count = 9 } in the table [parameters]")
        parameters = tuple(parameter_of(name, given) for name, given in named.items())
        kind = data.get("sample", "grid")
        if kind not in SAMPLES:
            raise CGCError(f"sample must be one of {', '.join(SAMPLES)}, not {kind!r}")
        count = data.get("count", 0)
        drawn = kind in ("random", "latin hypercube")
        if drawn and (isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST):
            raise CGCError(f"a {kind} sample needs count, the number of its variants, up to {MOST}, not {count!r}")
        if not drawn and count:
            raise CGCError(f"count belongs to random samples; a {kind} has as many variants as its values make")
        seed = data.get("seed", 1)
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise CGCError(f"seed must be a whole number from 0 up, not {seed!r}")
        goals, unknown = tuple(data.get("goals", ())), data.get("unknown", ())
        try:
            as_goals(goals)
            settings_for(data.get("method", "auto"), data.get("settings"))
        except (ValueError, TypeError) as error:
            raise CGCError(f"the study: {error}") from None
        study = cls(
            parameters,
            kind,
            count,
            seed,
            data.get("supports"),
            data.get("target"),
            goals,
            unknown,
            data.get("method", "auto"),
            dict(data.get("settings", {})),
            _table("panels", data, _PANELS),
            _table("membrane", data, _MEMBRANE),
            _ranking("pareto", data),
            _ranking("best", data),
            dict(data),
        )
        if not study.variants:
            raise CGCError("the study has no variants; give its parameters values")
        return study

    @cached_property
    def variants(self) -> list[tuple[Any, ...]]:
        """The values of the parameters, variant by variant."""
        return sample(self.sample, [own.values for own in self.parameters], self.count, self.seed)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(own.name for own in self.parameters)

    @property
    def solver_settings(self) -> Optional[Settings]:
        """The settings of the solves, None where all are left open."""
        return settings_for(self.method, self.settings) if self.settings else None

    def posed(self, problem: CGCProblem) -> CGCProblem:
        """Return the drawing with what the study asks of every variant.

        Raises
        ------
        CGCError
            If the drawing has no such vertex or region.
        """
        try:
            if self.supports is not None:
                problem = problem.with_supports(self.supports)
            if self.target is not None:
                by_region = isinstance(self.target, Mapping)
                problem = problem.with_targets({int(region): K for region, K in self.target.items()} if by_region else float(self.target))
            goals = [*self.goals, *([{"kind": "unknown", "regions": self.unknown}] if len(self.unknown) else [])]
            return problem.with_goals(goals) if goals else problem
        except (ValueError, TypeError) as error:
            raise CGCError(f"the study: {error}") from None

    def digest(self, problem: CGCProblem) -> str:
        """Return a name of what decides the table: this study of this drawing."""
        told = {key: value for key, value in self.data.items() if key not in ("pareto", "best")}
        found = hashlib.blake2b(json.dumps(told, sort_keys=True).encode(), digest_size=16)
        for array in (problem.vertices, problem.faces, problem.roles, problem.targets, problem.s, problem.e, problem.creases):
            found.update(array.tobytes())
        found.update(repr(problem.goals).encode())
        return found.hexdigest()


@names_what_was_meant()
def read_study(path: Union[str, os.PathLike[str]]) -> Study:
    """Return the study that a TOML file describes.

    Parameters
    ----------
    path
        Of the file.

    Returns
    -------
    Study
        Checked.

    Raises
    ------
    FileError
        If the file cannot be read or is no TOML.
    CGCError
        If it is not understood.

    Examples
    --------
    >>> read_study("study.toml")  # doctest: +SKIP
    """
    try:
        import tomllib
    except ModuleNotFoundError:  # Python 3.10 and before
        import tomli as tomllib
    try:
        data = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError(f"{path} cannot be read ({error.strerror}); give a TOML file that describes a study") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileError(f"{path} is no TOML: {error}") from None
    try:
        return Study.from_dict(data)
    except CGCError as error:
        raise CGCError(f"{path}: {error}") from None


def _plain(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return a study as it can be written: numbers and arrays of NumPy as plain ones."""
    try:
        return json.loads(json.dumps(dict(data), default=lambda value: value.tolist()))
    except (TypeError, ValueError, AttributeError) as error:
        raise CGCError(f"a study must be plain data, of numbers, texts, lists and tables ({error})") from None


def _known(what: str, given: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    for key in given:
        if key not in keys:
            raise CGCError(f"{what} has no {str(key)!r:.60}; it has {', '.join(keys)}{did_you_mean(str(key), keys)}")


def _table(name: str, data: Mapping[str, Any], keys: tuple[str, ...]) -> Optional[Mapping[str, Any]]:
    given = data.get(name)
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise CGCError(f"{name} must be a table of {', '.join(keys)}, not {given!r}")
    _known(name, given, keys)
    return dict(given)


def _ranking(name: str, data: Mapping[str, Any]) -> Ranking:
    given = _table(name, data, ("least", "most", "count"))
    if given is None:
        return Ranking()
    sides = []
    for side in ("least", "most"):
        columns = given.get(side, ())
        columns = (columns,) if isinstance(columns, str) else tuple(columns)
        if not all(isinstance(column, str) for column in columns):
            raise CGCError(f"{name}: {side} must name columns of the table, not {given[side]!r}")
        sides.append(columns)
    count = given.get("count", 3 if name == "best" else 0)
    if isinstance(count, bool) or not isinstance(count, int) or count < 0:
        raise CGCError(f"{name}: count must be a whole number, not {count!r}")
    if not any(sides):
        raise CGCError(f"{name} must say of which columns the least or the most is wanted, such as least = 'area'")
    return Ranking(sides[0], sides[1], count)
