"""Definition of a study: parameters, sampling and measures, as a value and as a TOML file."""

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
from ..rationalisation.design import GivenDesign
from ..rationalisation.design_data import design_to_dict
from ..solvers.registry import settings_for
from ..solvers.settings import Settings
from .parameters import OF_DESIGNS
from .parameters import Parameter
from .parameters import parameter_of
from .sampling import MAX_VARIANTS
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
    "rationalise",
    "pareto",
    "best",
)
_PANELS = ("size", "count", "along", "material", "thickness", "tolerance")
_MEMBRANE = ("pressure", "weight", "edge_beams")
_RATIONALISE = ("moulds", "panel", "seams", "within", "flat", "supports", "edges", "tolerance", "costs", "weights")
_OF_DRAWINGS = ("supports", "target", "goals", "unknown", "method", "settings", "panels", "membrane")  # keys for surfaces of drawings


@dataclass(frozen=True)
class Ranking:
    """Objectives: columns of the table to minimise or maximise."""

    least: tuple[str, ...] = ()
    most: tuple[str, ...] = ()
    count: int = 0  # number of best variants written as separate files

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns, those to minimise first."""
        return (*self.least, *self.most)


@names_what_was_meant()
@dataclass(frozen=True)
class Study:
    """Definition of a study, from plain data by :meth:`from_dict` or from a file by :func:`read_study`.

    Parameters
    ----------
    parameters
        Parameters by name, each with values or a range.
    sample
        Kind of sampling.
    count
        Number of random samples.
    seed
        Seed of random samples.
    supports
        Supports that replace those of the drawing.
    target
        K of all regions, or by region [1/L^2].
    goals
        As for :func:`compas_cgc.solve`.
    unknown
        As for :func:`compas_cgc.solve`.
    method
        As for :func:`compas_cgc.solve`.
    settings
        As for :func:`compas_cgc.solve`.
    panels
        Options of the division into panels, if panels are measured.
    membrane
        Loads, if forces are measured.
    rationalise
        Options of :func:`compas_cgc.rationalise` that all variants share, if a freeform design is varied instead of a drawing.
    pareto
        Objectives of the Pareto front.
    best
        Ranking and number of the best variants that are written as files.
    data
        Plain data of the study.

    Examples
    --------
    >>> study = Study.from_dict({"parameters": {"K": {"from": 0.002, "to": 0.004, "count": 3}, "s": [0.0, 0.5]}})
    >>> len(study.variants), study.variants[1]
    (6, (0.002, 0.5))
    """

    parameters: tuple[Parameter, ...]
    sample: str = "grid"
    count: int = 0  # number of random samples
    seed: int = 1
    supports: Optional[Union[str, list[int]]] = None
    target: Any = None  # K of all regions, or by region [1/L^2]
    goals: tuple[Mapping[str, Any], ...] = ()
    unknown: Any = ()
    method: str = "auto"
    settings: Mapping[str, Any] = field(default_factory=dict)
    panels: Optional[Mapping[str, Any]] = None
    membrane: Optional[Mapping[str, Any]] = None
    rationalise: Optional[Mapping[str, Any]] = None
    pareto: Ranking = Ranking()
    best: Ranking = Ranking()
    data: Mapping[str, Any] = field(default_factory=dict)  # plain data of the study

    def __post_init__(self) -> None:
        if not (isinstance(self.parameters, tuple) and all(isinstance(each, Parameter) for each in self.parameters)):
            raise CGCError(f"create a study by Study.from_dict({{...}}) or read_study('study.toml'), not from {self.parameters!r:.60}")

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Study:
        """Return the study described by plain data.

        Raises
        ------
        CGCError
            If the data are invalid; the message lists the valid entries.
        """
        data = _plain(data)
        _known("a study", data, _KEYS)
        named = data.get("parameters")
        if not isinstance(named, Mapping) or not named:
            raise CGCError("a study requires parameters, such as K = { from = 0.002, to = 0.006, count = 9 } in the table [parameters]")
        parameters = tuple(parameter_of(name, given) for name, given in named.items())
        kind = data.get("sample", "grid")
        if kind not in SAMPLES:
            raise CGCError(f"sample must be one of {', '.join(SAMPLES)}, not {kind!r}")
        count = data.get("count", 0)
        drawn = kind in ("random", "latin hypercube")
        if drawn and (isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MAX_VARIANTS):
            raise CGCError(f"a {kind} sample requires count, the number of its variants, up to {MAX_VARIANTS}, not {count!r}")
        if not drawn and count:
            raise CGCError(f"count is for random samples; the number of variants of a {kind} follows from its values")
        seed = data.get("seed", 1)
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise CGCError(f"seed must be an integer of at least 0, not {seed!r}")
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
            _of_design(data, parameters),
            _ranking("pareto", data),
            _ranking("best", data),
            dict(data),
        )
        if not study.variants:
            raise CGCError("the study has no variants; give values for its parameters")
        return study

    @cached_property
    def variants(self) -> list[tuple[Any, ...]]:
        """Values of the parameters by variant."""
        return sample(self.sample, [own.values for own in self.parameters], self.count, self.seed)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(own.name for own in self.parameters)

    @property
    def solver_settings(self) -> Optional[Settings]:
        """Settings of the solves, None for the defaults."""
        return settings_for(self.method, self.settings) if self.settings else None

    def posed(self, problem: CGCProblem) -> CGCProblem:
        """Return the drawing with the supports, targets and goals that all variants share.

        Raises
        ------
        CGCError
            If a vertex or region does not exist in the drawing.
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

    def digest(self, drawing: Union[CGCProblem, GivenDesign]) -> str:
        """Return a digest of everything that determines the table: study, drawing and version."""
        told = {key: value for key, value in self.data.items() if key not in ("pareto", "best")}
        found = hashlib.blake2b(json.dumps(told, sort_keys=True).encode(), digest_size=16)
        if isinstance(drawing, GivenDesign):
            found.update(json.dumps(design_to_dict(drawing), sort_keys=True).encode())
            return found.hexdigest()
        problem = drawing
        for array in (problem.vertices, problem.faces, problem.roles, problem.targets, problem.s, problem.e, problem.creases):
            found.update(array.tobytes())
        found.update(repr(problem.goals).encode())
        found.update(repr(dict(problem.laws)).encode() if problem.laws else b"")
        return found.hexdigest()


@names_what_was_meant()
def read_study(path: Union[str, os.PathLike[str]]) -> Study:
    """Return the study described by a TOML file.

    Parameters
    ----------
    path
        Path of the file.

    Returns
    -------
    Study
        The checked study.

    Raises
    ------
    FileError
        If the file cannot be read or is not valid TOML.
    CGCError
        If the study is invalid.

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
        raise FileError(f"{path} is not valid TOML: {error}") from None
    try:
        return Study.from_dict(data)
    except CGCError as error:
        raise CGCError(f"{path}: {error}") from None


def _plain(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a study with NumPy numbers and arrays converted to plain ones."""
    try:
        return json.loads(json.dumps(dict(data), default=lambda value: value.tolist()))
    except (TypeError, ValueError, AttributeError) as error:
        raise CGCError(f"a study must consist of numbers, strings, lists and tables ({error})") from None


def _known(what: str, given: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    for key in given:
        if key not in keys:
            raise CGCError(f"{what} has no key {str(key)!r:.60}; the keys are {', '.join(keys)}{did_you_mean(str(key), keys)}")


def _table(name: str, data: Mapping[str, Any], keys: tuple[str, ...]) -> Optional[Mapping[str, Any]]:
    given = data.get(name)
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise CGCError(f"{name} must be a table with keys from {', '.join(keys)}, not {given!r}")
    _known(name, given, keys)
    return dict(given)


def _of_design(data: Mapping[str, Any], parameters: tuple[Parameter, ...]) -> Optional[Mapping[str, Any]]:
    """Return the options of a study of a design, None for a study of a drawing; a study is of one or the other."""
    given = _table("rationalise", data, _RATIONALISE)
    of_design = [own.name for own in parameters if own.kind in OF_DESIGNS]
    if given is None and not of_design:
        return None
    wrong = [own.name for own in parameters if own.kind not in OF_DESIGNS] + [key for key in _OF_DRAWINGS if key in data]
    if wrong:
        cause = f"the parameter {of_design[0]}" if of_design else "the table [rationalise]"
        raise CGCError(
            f"{cause} is for freeform designs, but {wrong[0]} is for drawings; parameters of designs are {', '.join(OF_DESIGNS)}, "
            "and other options belong to the table [rationalise]"
        )
    twice = [own.kind for own in parameters if own.kind in (given or {})]
    if twice:
        raise CGCError(f"{twice[0]} is a parameter and in the table [rationalise]; give it once")
    return given or {}


def _ranking(name: str, data: Mapping[str, Any]) -> Ranking:
    given = _table(name, data, ("least", "most", "count"))
    if given is None:
        return Ranking()
    sides = []
    for side in ("least", "most"):
        columns = given.get(side, ())
        columns = (columns,) if isinstance(columns, str) else tuple(columns)
        if not all(isinstance(column, str) for column in columns):
            raise CGCError(f"{name}: {side} must be names of columns of the table, not {given[side]!r}")
        sides.append(columns)
    count = given.get("count", 3 if name == "best" else 0)
    if isinstance(count, bool) or not isinstance(count, int) or count < 0:
        raise CGCError(f"{name}: count must be an integer, not {count!r}")
    if not any(sides):
        raise CGCError(f"{name} must name the columns to minimise (least) or maximise (most), such as least = 'area'")
    return Ranking(sides[0], sides[1], count)
