"""The chapter on goals: its examples run, and its table is what the code says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from compas_cgc.model.goals.measures import volume

PAGE = Path(__file__).parents[2] / "docs" / "goals.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_the_example_at_its_head(capsys):
    names: dict = {}
    exec(EXAMPLES[0], names)
    result = names["result"]
    assert result.converged and result.vertices[:, 2].max() == pytest.approx(4.0, abs=1e-10)
    said = capsys.readouterr().out
    assert "was found for region 0" in said and "1 % more K lifts the crown by" in said


def test_the_recipes():
    names: dict = {}
    exec(EXAMPLES[1], names)
    high, gate, large, oculus, low = (names[name] for name in ("high", "gate", "large", "oculus", "low"))
    assert all(result.converged for result in (high, gate, large, oculus, low))
    assert high.vertices[:, 2].max() == pytest.approx(4.0, abs=1e-10)
    x, y, z = gate.vertices.T
    assert z[(x >= 5.5) & (x <= 9.5) & (y <= 3.0) & (y >= 0.0)].min() >= 2.5 - 1e-9
    assert volume(large.vertices, large.faces, 0.0) == pytest.approx(300.0, rel=1e-10)
    ring = oculus.vertices[-40:]
    assert np.abs(np.linalg.norm(ring[:, :2], axis=1) - 1.0).max() < 1e-9 and np.ptp(ring[:, 2]) < 1e-9
    assert low.vertices[:, 2].max() == pytest.approx(3.0, abs=1e-10)


def test_the_table_knows_the_sphere():
    """The row of the circle is that of spherical caps, but for the mesh."""
    row = next(line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| circle"))
    found = [float(cell) for cell in row.split("|")[2:6]]
    caps = [225 * (2 * h / (h**2 + 7.5**2)) ** 2 for h in (1.0, 2.0, 3.0, 4.0)]
    assert np.allclose(found, caps, rtol=0.02)
