"""Variants of a freeform design: panels and moulds by the options of a study, and the measures of their surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any
from typing import NoReturn
from typing import Union

from ..errors import CGCError
from ..model.problem import CGCProblem
from ..model.units import length_of
from ..model.units import within
from ..rationalisation import Rationalised
from ..rationalisation import rationalise
from ..rationalisation import read_design
from ..rationalisation.design import Design
from ..rationalisation.design import GivenDesign
from .spec import Study
from .variants import Measured
from .variants import Plan
from .variants import check_columns

__all__ = ["NO_COMMON_MESH", "DesignPlan", "plan_of"]

NO_COMMON_MESH = "variants of a design have no common mesh; results.plan.solve(variant) returns the panels of a variant"

MEASURES = ("status", "verdict", "panels", "moulds", "distance", "rms", "fold", "error")
LENGTHS = ("panel", "within", "tolerance")
DEFAULT_MOULDS = 4


class DesignPlan:
    """A study applied to a freeform design.

    Parameters
    ----------
    study
        Parameters, sampling and options.
    drawing
        The design as it is given.

    Raises
    ------
    CGCError
        If the design cannot be read, or an objective is not a column.
    """

    block_size = 1  # variants per block
    found: tuple[str, ...] = ()  # columns of unknown K; those of moulds differ in number

    def __init__(self, study: Study, drawing: GivenDesign):
        self.study = study
        self.drawing = drawing
        self.shared = {name: self._option(name, value) for name, value in (study.rationalise or {}).items()}
        check_columns(study, self.columns)

    @cached_property
    def design(self) -> Design:
        """The design with its surface, which all variants share."""
        return read_design(self.drawing, tolerance=self.shared.get("tolerance"))

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the table."""
        costs = ("costs",) if "costs" in self.shared else ()
        return ("variant", *self.inputs, *MEASURES, *costs, "note")

    @property
    def inputs(self) -> tuple[str, ...]:
        """Columns of the parameters: their names, made distinct from the measures."""
        return tuple(f"{name} asked" if name in (*MEASURES, "costs") else name for name in self.study.names)

    def start(self, variant: int) -> tuple[Any, ...]:
        """Return the first values of the row of a variant: its number and parameters."""
        return (variant, *(self._option(own.kind, value) for own, value in zip(self.study.parameters, self.study.variants[variant])))

    def solve(self, variant: int) -> Rationalised:
        """Return the design made of the panels of a variant.

        Raises
        ------
        CGCError
            If an option is invalid.
        """
        kinds = [own.kind for own in self.study.parameters]
        options = {**self.shared, **dict(zip(kinds, self.start(variant)[1:]))}
        if "moulds" not in options:
            options["moulds"] = None if "within" in options else DEFAULT_MOULDS
        return rationalise(self.design, **options)

    def problem(self, variant: int) -> NoReturn:
        """Refuse the problem of a variant, which has its own mesh.

        Raises
        ------
        CGCError
        """
        raise CGCError(NO_COMMON_MESH)

    def measured(self, variant: int) -> Measured:
        """Return the row of a variant; errors are reported in its note."""
        try:
            found = self.solve(variant)
        except CGCError as error:
            return self.refused(variant, str(error))
        judged = found.result.verdict
        notes = [] if found.result.converged else [found.result.message]
        notes += [found.suggestion] if found.suggestion else []
        notes += judged.reasons if judged is not None and not judged.fair else []
        figures = {
            "status": "exceeded" if found.status == "exceeded" else found.result.status,
            "verdict": None if judged is None else judged.word,
            "panels": found.panelling.panel_count,
            "moulds": len(found.curvatures),
            "distance": found.farthest,
            "rms": found.distance.rms,
            "fold": found.folds.beyond()["largest"],
            "error": found.result.max_error,
            "costs": sum(found.costs_of_parts),
        }
        return Measured(self._row(variant, figures, "; ".join(notes)), None)

    def refused(self, variant: int, note: str, status: str = "refused") -> Measured:
        """Return the row of a variant without a surface."""
        return Measured(self._row(variant, {"status": status}, note), None)

    def _row(self, variant: int, figures: Mapping[str, Any], note: str) -> tuple[Any, ...]:
        own = dict(zip(("variant", *self.inputs), self.start(variant)))
        known = {**figures, **own, "note": note}
        return tuple(known.get(column) for column in self.columns)

    def _option(self, name: str, value: Any) -> Any:
        """Return an option in the units of the design, and a number of moulds as a whole number."""
        if name in LENGTHS:
            return within(length_of(value, name), self.drawing.drawing.units)
        if name == "moulds" and isinstance(value, float):
            return round(value)
        return value


def plan_of(study: Study, drawing: Union[CGCProblem, GivenDesign]) -> Union[Plan, DesignPlan]:
    """Return a study applied to a drawing or to a freeform design.

    Raises
    ------
    CGCError
        If a parameter refers to something that the drawing does not have.
    """
    return DesignPlan(study, drawing) if isinstance(drawing, GivenDesign) else Plan(study, drawing)
