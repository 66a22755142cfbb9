"""Results of a study: its table and its surfaces."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import Any
from typing import Union

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..errors import CGCError
from ..errors import FileError
from ..errors import names_what_was_meant
from ..io import read_problem
from ..model.problem import CGCProblem
from ..rationalisation.design import GivenDesign
from ..rationalisation.design_data import design_from_dict
from .designs import NO_COMMON_MESH
from .designs import DesignPlan
from .designs import plan_of
from .spec import Ranking
from .spec import Study
from .table import cells
from .table import parsed
from .table import read_rows
from .variants import Plan

__all__ = ["DESIGN", "DRAWING", "PARQUET", "STUDY", "SURFACES", "TABLE", "Results", "refuse_no_results"]

STUDY, DRAWING, DESIGN = "study.json", "drawing.json", "design.json"
TABLE, PARQUET, SURFACES = "table.csv", "table.parquet", "surfaces.npy"


def refuse_no_results(given: object) -> None:
    """Raise an error for an argument that is not :class:`Results`.

    Raises
    ------
    CGCError
    """
    if not isinstance(given, Results):
        raise CGCError(f"the argument must be the results of a study, Results('folder'), not {given!r:.60}")


@names_what_was_meant()
class Results:
    """Results of a finished or running study in a folder.

    Parameters
    ----------
    folder
        The folder.

    Attributes
    ----------
    columns
        Names of the columns.
    rows
        Values by variant, None if missing.

    Raises
    ------
    FileError
        If the folder does not hold a study.

    Examples
    --------
    >>> Results.load("roofs").table  # doctest: +SKIP
    """

    def __init__(self, folder: Union[str, os.PathLike[str]]):
        if not isinstance(folder, (str, os.PathLike)):
            raise FileError(f"the argument must be the folder of a study, Results('folder'), not {folder!r:.60}")
        self.folder = Path(folder)
        self.columns, self.rows = read_rows(self.folder / TABLE)
        # The last row may be incomplete while the study is running.
        self.rows = [row for row in self.rows if len(row) == len(self.columns)]

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def _defined(self) -> tuple[Study, str]:
        """Definition of the study, and the digest of all that its table depends on."""
        try:
            about = json.loads((self.folder / STUDY).read_text(encoding="utf-8"))
            return Study.from_dict(about["study"]), about["digest"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise FileError(f"{self.folder / STUDY} cannot be read ({error}); give the folder of a study") from None

    @property
    def study(self) -> Study:
        """Definition of the study."""
        return self._defined[0]

    @cached_property
    def drawing(self) -> CGCProblem:
        """The drawing from which the variants are derived."""
        return read_problem(self.folder / DRAWING).checked()

    @cached_property
    def design(self) -> GivenDesign:
        """The freeform design from which the variants are derived.

        Raises
        ------
        FileError
            If it cannot be read.
        """
        try:
            return design_from_dict(json.loads((self.folder / DESIGN).read_text(encoding="utf-8")))
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
            raise FileError(f"{self.folder / DESIGN} cannot be read ({error}); run the study again") from None

    @property
    def of_design(self) -> bool:
        """Whether the variants are those of a freeform design."""
        return self.study.rationalise is not None

    @cached_property
    def plan(self) -> Union[Plan, DesignPlan]:
        """The study applied to the drawing, which returns the problem of any variant, or to the design.

        Raises
        ------
        FileError
            If drawing, table and study are not of one run.
        """
        study, digest = self._defined
        drawing = self.design if self.of_design else self.drawing
        plan = plan_of(study, drawing)
        starts = [[parsed(cell) for cell in cells(plan.start(k))] for k in range(len(study.variants))]
        if study.digest(drawing) != digest or any(row[: len(start)] != start for row, start in zip(self.rows, starts)):
            raise FileError(f"the files in {self.folder} are of different studies; run the study again")
        return plan

    @cached_property
    def surfaces(self) -> FloatArray:
        """Vertices of all variants (variants, n, 3) [L], NaN for variants without a surface; memory-mapped from the file.

        Raises
        ------
        CGCError
            If the variants are those of a design, which have no common mesh.
        """
        if self.of_design:
            raise CGCError(NO_COMMON_MESH)
        return np.load(self.folder / SURFACES, mmap_mode="r")

    def column(self, name: str) -> list[Any]:
        """Return the values of a column.

        Raises
        ------
        CGCError
            If the column does not exist.
        """
        if name not in self.columns:
            raise CGCError(f"the table has no column {name!r}; the columns are {', '.join(self.columns)}")
        k = self.columns.index(name)
        return [row[k] for row in self.rows]

    def numbers(self, name: str) -> FloatArray:
        """Return the numbers of a column, NaN if missing."""
        return np.array([value if isinstance(value, (int, float)) else np.nan for value in self.column(name)], dtype=np.float64)

    def row(self, variant: int) -> dict[str, Any]:
        """Return the row of a variant by column.

        Raises
        ------
        CGCError
            If the variant does not exist.
        """
        if not 0 <= variant < len(self.rows):
            raise CGCError(f"there is no variant {variant}; the table has {len(self.rows)} variants, counted from 0")
        return dict(zip(self.columns, self.rows[variant]))

    def has_surface(self, variant: int) -> bool:
        """Check whether a variant has a surface."""
        return bool(np.isfinite(self.surfaces[variant]).all())

    def problem(self, variant: int) -> CGCProblem:
        """Return the problem of a variant with its solved surface and the K solved for.

        Raises
        ------
        CGCError
            If the variant does not exist or has no surface.
        """
        vertices = self.vertices(variant)
        problem, unknown = self.plan.problem(variant).with_vertices(vertices), self.plan.found
        found = {int(name[1:]): value for name, value in zip(self.columns, self.rows[variant]) if name in unknown and value is not None}
        return problem.with_targets(found) if found else problem

    def vertices(self, variant: int) -> FloatArray:
        """Return the vertices of a variant (n, 3) [L].

        Raises
        ------
        CGCError
            If the variant does not exist or has no surface.
        """
        row = self.row(variant)
        if not self.has_surface(variant):
            raise CGCError(f"variant {variant} has no surface: {row['note']}")
        return np.array(self.surfaces[variant])

    def good(self) -> Indices:
        """Return the variants that reached K with a fair surface (k,); if there are none, all that reached K."""
        status, verdict = self.column("status"), self.column("verdict")
        fair = [k for k in range(len(self)) if status[k] == "converged" and verdict[k] == "fair"]
        return np.array(fair or [k for k in range(len(self)) if status[k] == "converged"], dtype=np.int64)

    def best(self, ranking: Ranking) -> list[int]:
        """Return the best of the good variants, sorted by the columns of the ranking in order."""
        good = self.good()
        keys = [self.numbers(name)[good] for name in ranking.least] + [-self.numbers(name)[good] for name in ranking.most]
        known = np.isfinite(keys).all(axis=0) if keys else np.zeros(len(good), bool)
        # In lexsort, the last key is the primary one.
        order = np.lexsort([good[known], *(key[known] for key in reversed(keys))])
        return good[known][order][: ranking.count].tolist()
