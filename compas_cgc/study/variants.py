"""Variants: the problems derived from a drawing by a study, and the measures of their surfaces."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..datastructures import SolveResult
from ..discrete.arrays import FloatArray
from ..errors import CGCError
from ..model.goals import measures
from ..model.goals.binding import support_height
from ..model.goals.binding import unknown_regions
from ..model.problem import CGCProblem
from ..model.result import FAILED
from ..solvers.choices import choose
from ..solvers.registry import settings_for
from ..solvers.run import solve
from .parameters import STRATEGIES
from .parameters import Change
from .spec import Study

__all__ = ["Measured", "Plan", "block_size", "check_columns"]

MEASURES = ("status", "verdict", "rise", "height", "area", "volume", "error", "roughness", "steps", "method")
CACHED_VERTICES = 1_000_000  # size of the cache of surfaces of identical variants [vertices]
CACHED_SHAPES = 16  # number of cached drawings with moved creases and supports
MAX_VERTICES, MAX_BLOCK = 4096, 16  # vertices and variants of a block
LONG_STUDY, MAX_GROWTH = 1024, 4  # number of variants above which blocks grow, and their largest growth factor


def block_size(vertices: int, variants: int) -> int:
    """Return the number of variants per block for a study on a mesh with `vertices` vertices."""
    growth = max(1, min(MAX_GROWTH, variants // LONG_STUDY))
    return max(1, growth * min(MAX_BLOCK, MAX_VERTICES // max(1, vertices)))


def check_columns(study: Study, columns: Sequence[str]) -> None:
    """Check that the objectives of a study are columns of its table.

    Raises
    ------
    CGCError
    """
    for column in (*study.pareto.columns, *study.best.columns):
        if column not in columns:
            raise CGCError(f"the table has no column {column!r}; the columns are {', '.join(columns)}")


class Measured(NamedTuple):
    """A variant with its surface."""

    row: tuple[Any, ...]  # row of the table, in the order of Plan.columns
    vertices: Optional[FloatArray]  # (n, 3) [L], None without a surface


class Plan:
    """A study applied to a drawing, with the data shared by all variants.

    Parameters
    ----------
    study
        Parameters, sampling and measures.
    drawing
        Vertices, faces, roles, targets and constraints, without dummies.

    Raises
    ------
    CGCError
        If a parameter refers to something that the drawing does not have.
    """

    def __init__(self, study: Study, drawing: CGCProblem):
        self.study = study
        self.drawing = study.posed(drawing.without_dummies())
        self._shapes = [k for k, own in enumerate(study.parameters) if own.is_shape]
        self._asked = [k for k, own in enumerate(study.parameters) if not own.is_shape]
        self._drawn: OrderedDict[tuple, tuple[CGCProblem, list[Change]]] = OrderedDict()
        self._solved: OrderedDict[tuple, tuple[dict[str, Any], str, Optional[FloatArray]]] = OrderedDict()
        self._settings = study.solver_settings
        self._unknown = list(unknown_regions(self.drawing))
        self._block = block_size(len(self.drawing.vertices), len(study.variants))
        # Report errors in the study before the first solve.
        for own in study.parameters:
            own.change(self.drawing)
        check_columns(study, self.columns)

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the table."""
        panels = ("panels", "moulds") if self.study.panels is not None else ()
        forces = ("tension", "compression") if self.study.membrane is not None else ()
        return ("variant", *self.inputs, *MEASURES, *self.found, *panels, *forces, "note")

    @property
    def found(self) -> tuple[str, ...]:
        """Columns of the unknown K, by region."""
        return tuple(f"K{region}" for region in self._unknown)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Columns of the parameters: their names, made distinct from the measures."""
        return tuple(f"{name} asked" if name in MEASURES else name for name in self.study.names)

    def start(self, variant: int) -> tuple[Any, ...]:
        """Return the first values of the row of a variant: its number and parameters."""
        return (variant, *self.study.variants[variant])

    def problem(self, variant: int) -> CGCProblem:
        """Return the problem of a variant.

        Raises
        ------
        CGCError
            If the values are not possible for the drawing.
        """
        values = self.study.variants[variant]
        problem, changes = self._shape(tuple(_hashable(values[k]) for k in self._shapes), values)
        for change, k in zip(changes, self._asked):
            problem = change(problem, values[k])
        return problem

    @property
    def block_size(self) -> int:
        """Number of variants per block; variants of different blocks are independent."""
        return self._block

    def solve(self, variant: int) -> SolveResult:
        """Return the result of a variant."""
        found = solve(self.problem(variant), method=self.study.method, settings=self._settings)
        if found.turned:  # The surfaces of a study share the faces of its drawing.
            found = solve(self.problem(variant), method="projection", settings=settings_for("projection", self.study.settings))
        return found

    def measured(self, variant: int) -> Measured:
        """Return the row of a variant and its surface; errors are reported in the note of the row."""
        try:
            problem = self.problem(variant)
        except CGCError as error:
            return self.refused(variant, str(error))
        key = self._decisive(problem, self.study.variants[variant])
        if key not in self._solved:
            self._solved[key] = self._solution(variant)
            if len(self._solved) > max(1, CACHED_VERTICES // len(problem.vertices)):
                self._solved.popitem(last=False)
        figures, note, vertices = self._solved[key]
        return Measured(self._row(variant, figures, note), vertices)

    def refused(self, variant: int, note: str, status: str = "refused") -> Measured:
        """Return the row of a variant without a surface."""
        return Measured(self._row(variant, {"status": status}, note), None)

    def _shape(self, key: tuple, values: tuple) -> tuple[CGCProblem, list[Change]]:
        """Return the drawing with its changed shape, and the functions that set the other parameters."""
        if key in self._drawn:
            self._drawn.move_to_end(key)
            return self._drawn[key]
        problem = self.drawing
        for k in self._shapes:
            problem = self.study.parameters[k].change(problem)(problem, values[k])
        self._drawn[key] = problem, [self.study.parameters[k].change(problem) for k in self._asked]
        if len(self._drawn) > CACHED_SHAPES:
            self._drawn.popitem(last=False)
        return self._drawn[key]

    def _decisive(self, problem: CGCProblem, values: tuple) -> tuple:
        """Return the values that determine the result of a variant, without strategies that the method does not use."""
        own = [_hashable(value) for value, one in zip(values, self.study.parameters) if one.kind not in STRATEGIES]
        methods = [one.method for one in choose(problem, self._settings)] if self.study.method == "auto" else [self.study.method]
        return (*own, *((problem.s.tobytes(), problem.e.tobytes()) if "flow" in methods else ()))

    def _solution(self, variant: int) -> tuple[dict[str, Any], str, Optional[FloatArray]]:
        """Return the measures of the surface of a variant, a note on errors, and its vertices."""
        try:
            result = self.solve(variant)
        except CGCError as error:
            return {"status": "refused"}, str(error), None
        return (*self._figures(result), result.vertices)

    def _row(self, variant: int, figures: Mapping[str, Any], note: str) -> tuple[Any, ...]:
        own = dict(zip(self.inputs, self.study.variants[variant]))
        known = {**figures, **own, "variant": variant, "note": note}
        return tuple(known.get(column) for column in self.columns)

    def _figures(self, result: SolveResult) -> tuple[dict[str, Any], str]:
        problem, judged = result.problem, None if result.status in FAILED else result.verdict
        V, F = problem.vertices, problem.faces
        figures: dict[str, Any] = {
            "status": result.status,
            "verdict": None if judged is None else judged.word,
            "height": float(V[:, 2].max()),
            "area": measures.area(V, F),
            "error": result.max_error / problem.target_scale,
            "roughness": None if judged is None else judged.roughness,
            "steps": result.iterations,
            "method": result.method,
        }
        if len(problem.supports):
            level = support_height(problem)
            figures["rise"] = _of_largest(V[:, 2] - level)
            figures["volume"] = measures.volume(V, F, level)
        targets = problem.region_targets() if self._unknown else []
        figures.update({f"K{region}": targets[region] for region in self._unknown})
        notes = [] if result.converged else [result.message]
        if judged is not None and not judged.fair:
            notes += judged.reasons
        if result.converged:
            for more in (self._moulds, self._forces):
                try:
                    figures.update(more(problem))
                except CGCError as error:
                    notes.append(str(error))
        return {name: _plain(value) for name, value in figures.items()}, "; ".join(notes)

    def _moulds(self, problem: CGCProblem) -> dict[str, Any]:
        if self.study.panels is None:
            return {}
        from ..fabrication import moulds
        from ..fabrication import panels

        asked = dict(self.study.panels)
        divided = panels(problem, asked.pop("size", None), count=asked.pop("count", None), along=asked.pop("along", "plan"))
        return {"panels": len(divided), "moulds": len(moulds(problem, divided, rough=True, **asked).moulds)}

    def _forces(self, problem: CGCProblem) -> dict[str, Any]:
        if self.study.membrane is None:
            return {}
        from ..fabrication import membrane

        state = membrane(problem, rough=True, **self.study.membrane)
        return {"tension": float(state.forces.max()), "compression": float(state.forces.min())}


def _of_largest(heights: FloatArray) -> float:
    """Return the height of the highest vertex, or the depth of the lowest if its absolute value is larger."""
    high, low = float(heights.max()), float(heights.min())
    return high if high >= -low else low


def _plain(value: Any) -> Any:
    """Return a value for the table, with None for NaN and infinity."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _hashable(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
