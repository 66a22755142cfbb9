"""IFC files of panels: valid by IfcOpenShell, every panel found by name with its data and its surface."""

from __future__ import annotations

import numpy as np
import pytest

import compas_cgc
from compas_cgc.cli import main
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.io.builds import write_mould_files
from compas_cgc.io.ifc import PANEL_PROPERTIES

ifcopenshell = pytest.importorskip("ifcopenshell")


def errors_in(model):
    """Return what the validator of IfcOpenShell reports, with the rules of the schema."""
    from ifcopenshell import validate

    logger = validate.json_logger()
    validate.validate(model, logger, express_rules=True)
    return logger.statements


@pytest.mark.parametrize(("sample", "size"), [pytest.param("cushion", 2.0, marks=pytest.mark.nightly), ("canopy", 3.0)])
def test_every_panel_is_a_plate_with_its_data(sample, size, tmp_path):
    from ifcopenshell.util.element import get_aggregate
    from ifcopenshell.util.element import get_psets
    from ifcopenshell.util.element import get_type

    result = compas_cgc.solve(compas_cgc.read(compas_cgc.get(f"{sample}.3dm")), settings={"measure": "exact"})
    report = moulds(result, panels(result, size))
    path = tmp_path / "roof.ifc"
    assert write_mould_files(path, result.problem, report) == []
    model = ifcopenshell.open(str(path))
    assert model.schema == "IFC4" and errors_in(model) == []
    plates = {plate.Name: plate for plate in model.by_type("IfcPlate")}
    assert sorted(plates) == sorted(fit.panel.name for fit in report.panels)
    (roof,) = model.by_type("IfcRoof")
    courses = set()
    for fit in report.panels:
        plate, mould = plates[fit.panel.name], report.moulds[fit.mould - 1]
        own = get_psets(plate)[PANEL_PROPERTIES]
        assert own["Class"] == get_type(plate).Name == f"mould {fit.mould}" and get_aggregate(plate) == roof
        assert own["GaussianCurvature"] == mould.K and own["MouldRadius"] == pytest.approx(abs(mould.K) ** -0.5, rel=1e-12)
        assert own["Area"] == pytest.approx(face_areas(fit.vertices, fit.faces).sum()) and own["Region"] == fit.panel.region
        courses.add(own["Course"])
        (surface,) = plate.Representation.Representations[0].Items
        assert np.array_equal(surface.Coordinates.CoordList, fit.vertices)
        assert np.array_equal(np.array(surface.CoordIndex) - 1, fit.faces)
    assert courses == set(range(1, 1 + max(courses))) and len({plate.GlobalId for plate in plates.values()}) == len(plates)


def test_the_command_writes_ifc(tmp_path):
    solved, path = tmp_path / "solved.3dm", tmp_path / "roof.ifc"
    assert main(["solve", compas_cgc.get("cushion.3dm"), "-o", str(solved), "--measure", "exact", "-q"]) == 0
    assert main(["mould", str(solved), "-o", str(path), "--size", "2", "--thickness", "0.5", "--no-page", "-q"]) == 0
    assert ifcopenshell.open(str(path)).by_type("IfcPlate")
