"""Roofs of 1,000 m2: the distances that are promised for 160 and 640 panels."""

from __future__ import annotations

import pytest

import compas_cgc
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.rationalisation import read_design

from ..support.freeform import bumpy
from ..support.freeform import mesh_over

pytestmark = pytest.mark.nightly

LIMITS = {("soft", 4): 0.035, ("soft", 8): 0.022, ("sharp", 4): 0.050, ("sharp", 8): 0.028}


@pytest.mark.parametrize("moulds", (4, 8))
@pytest.mark.parametrize("seed", (0, 1, 2, 3, 4, 104))
@pytest.mark.parametrize("kind", ("soft", "sharp"))
def test_160_panels_are_near_the_design(kind, seed, moulds):
    design = read_design(mesh_over(bumpy(kind, seed)), tolerance=5e-4)
    found = compas_cgc.rationalise(design, panel=2.5, moulds=moulds)
    assert found.panelling.panel_count == 160 and found.result.converged and found.result.verdict.fair
    assert found.distance.largest <= LIMITS[kind, moulds]
    assert found.folds.beyond()["largest"] <= 0.5 and found.folds.beyond()["median"] <= 0.2


def test_640_panels_on_eight_moulds():
    design = read_design(mesh_over(bumpy("soft", 0)), tolerance=5e-4)
    found = compas_cgc.rationalise(design, panel=1.26, moulds=8)  # the roof is a little longer than its plan
    assert found.panelling.panel_count == 640 and found.distance.largest <= 0.012


def test_every_panel_lies_on_its_mould():
    found = compas_cgc.rationalise(mesh_over(bumpy("soft", 0)), panel=2.5, moulds=4)
    report = moulds(found.result, panels(found.result, count=1))
    gaps = [fit.gap for fit in report.panels]
    assert len(gaps) == 160 and max(gaps) <= 1e-9, "millimetres"
