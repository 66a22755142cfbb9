"""IFC 4 files: the roof and its panels as plates, with the data that makes each panel, through IfcOpenShell."""

from __future__ import annotations

import uuid
from importlib import import_module
from typing import Any
from typing import Optional

from .._version import __version__
from ..discrete import face_areas
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..errors import FileError
from ..fabrication.mould_report import MouldReport
from ..fabrication.panel_courses import panel_courses
from ..model.problem import CGCProblem

__all__ = ["PANEL_PROPERTIES", "ifc_bytes"]

CONSTANT_TIME = "1980-01-01T00:00:00"  # equal surfaces give equal files
NAMESPACE = uuid.UUID("6f1d1b3c-6f0a-5b62-9a3f-2f1c8c0f6b57")  # of the identifiers of this package
PANEL_PROPERTIES = "CGC_Panel"


def ifc_bytes(problem: CGCProblem, report: MouldReport) -> bytes:
    """Return an IFC 4 file in metres: a roof made of plates, one for each panel, and a type of plate for each mould.

    Every plate has the name of its panel, its surface in place, the quantities ``Qto_PlateBaseQuantities`` and the properties
    ``CGC_Panel``: Class, MouldKind, GaussianCurvature [1/m^2], MouldRadius [m], Area [m^2], Course, Region, and BendingStress [Pa].

    Parameters
    ----------
    problem
        The solved surface.
    report
        Its moulds.

    Raises
    ------
    FileError
        If the package that writes IFC files is not installed.
    """
    model = _Model(problem.drawing.name or "roof")
    building, context = model.building()
    roof = model.rooted("IfcRoof", "roof", Name=model.name, PredefinedType="FREEFORM", ObjectPlacement=model.placement())
    model.rooted("IfcRelContainedInSpatialStructure", "contained", RelatedElements=[roof], RelatingStructure=building)
    material = model.create("IfcMaterial", Name=report.material.name)
    unit = report.unit
    types = {
        mould.number: model.rooted(
            "IfcPlateType", f"mould {mould.number}", Name=f"mould {mould.number}", Description=mould.kind, PredefinedType="SHEET"
        )
        for mould in report.moulds
    }
    plates: dict[int, list[Any]] = {number: [] for number in types}
    moulds = {mould.number: mould for mould in report.moulds}
    for fit, course in zip(report.panels, panel_courses(problem, report)):
        name, mould = fit.panel.name, moulds[fit.mould]
        plate = model.rooted(
            "IfcPlate",
            f"panel {name}",
            Name=name,
            Tag=name,
            ObjectType=f"mould {mould.number}",
            ObjectPlacement=model.placement(roof.ObjectPlacement),
            Representation=model.surface(context, unit * fit.vertices, fit.faces),
        )
        plates[mould.number].append(plate)
        area = unit**2 * float(face_areas(fit.vertices, fit.faces).sum())
        radius = mould.radius_of_curvature
        values: dict[str, tuple[str, Any, str]] = {
            "Class": ("IfcLabel", f"mould {mould.number}", "panels of one class are made on one mould"),
            "MouldKind": ("IfcLabel", mould.kind, "type of the surface of the mould"),
            "GaussianCurvature": ("IfcReal", mould.K / unit**2, "Gaussian curvature of mould and panel in 1/m2"),
            "Area": ("IfcAreaMeasure", area, "area of the panel"),
            "Course": ("IfcInteger", course, "course of erection, 1 on the supports"),
            "Region": ("IfcInteger", fit.panel.region, "region of constant curvature"),
        }
        if radius is not None:
            values["MouldRadius"] = ("IfcPositiveLengthMeasure", unit * radius, "radius of curvature of the mould")
        if fit.stress is not None:
            values["BendingStress"] = ("IfcPressureMeasure", 1e6 * fit.stress, "largest stress of bending from the mould to the position")
        model.properties(plate, name, values)
        model.quantities(plate, name, area, 1e-3 * report.thickness)
    for number, own in plates.items():
        model.rooted("IfcRelDefinesByType", f"type {number}", RelatedObjects=own, RelatingType=types[number])
    every = [plate for own in plates.values() for plate in own]
    model.rooted("IfcRelAggregates", "panels", RelatingObject=roof, RelatedObjects=every)
    model.rooted("IfcRelAssociatesMaterial", "material", RelatedObjects=every, RelatingMaterial=material)
    return model.content()


class _Model:
    """An IFC model with identifiers that depend on names only."""

    def __init__(self, name: str):
        try:
            self.ifc = import_module("ifcopenshell")
        except ImportError:
            raise FileError("IFC files require the package ifcopenshell; install it with: pip install 'compas_cgc[bim]'") from None
        self.name = name
        self.file = self.ifc.file(schema="IFC4")

    def create(self, kind: str, **attributes: Any) -> Any:
        return self.file.create_entity(kind, **attributes)

    def rooted(self, kind: str, key: str, **attributes: Any) -> Any:
        """Return a new entity with an identifier made of the name of the model and a key."""
        identifier = self.ifc.guid.compress(uuid.uuid5(NAMESPACE, f"{self.name}/{kind}/{key}").hex)
        return self.create(kind, GlobalId=identifier, **attributes)

    def placement(self, within: Optional[Any] = None) -> Any:
        return self.create("IfcLocalPlacement", PlacementRelTo=within, RelativePlacement=self.axes())

    def axes(self) -> Any:
        return self.create("IfcAxis2Placement3D", Location=self.create("IfcCartesianPoint", Coordinates=(0.0, 0.0, 0.0)))

    def building(self) -> tuple[Any, Any]:
        """Return a building in a new project in metres, and the context of its surfaces."""
        units = [("LENGTHUNIT", "METRE"), ("AREAUNIT", "SQUARE_METRE"), ("PLANEANGLEUNIT", "RADIAN"), ("PRESSUREUNIT", "PASCAL")]
        assigned = self.create("IfcUnitAssignment", Units=[self.create("IfcSIUnit", UnitType=kind, Name=name) for kind, name in units])
        whole = self.create(
            "IfcGeometricRepresentationContext",
            ContextType="Model",
            CoordinateSpaceDimension=3,
            Precision=1e-6,
            WorldCoordinateSystem=self.axes(),
        )
        body = self.create(
            "IfcGeometricRepresentationSubContext",
            ContextIdentifier="Body",
            ContextType="Model",
            ParentContext=whole,
            TargetView="MODEL_VIEW",
        )
        project = self.rooted("IfcProject", "project", Name=self.name, RepresentationContexts=[whole], UnitsInContext=assigned)
        site = self.rooted("IfcSite", "site", Name="site", ObjectPlacement=self.placement())
        building = self.rooted("IfcBuilding", "building", Name="building", ObjectPlacement=self.placement(site.ObjectPlacement))
        self.rooted("IfcRelAggregates", "site", RelatingObject=project, RelatedObjects=[site])
        self.rooted("IfcRelAggregates", "building", RelatingObject=site, RelatedObjects=[building])
        return building, body

    def surface(self, context: Any, vertices: FloatArray, faces: Faces) -> Any:
        points = self.create("IfcCartesianPointList3D", CoordList=vertices.tolist())
        mesh = self.create("IfcTriangulatedFaceSet", Coordinates=points, Closed=False, CoordIndex=(faces + 1).tolist())
        shape = self.create(
            "IfcShapeRepresentation",
            ContextOfItems=context,
            RepresentationIdentifier="Body",
            RepresentationType="Tessellation",
            Items=[mesh],
        )
        return self.create("IfcProductDefinitionShape", Representations=[shape])

    def properties(self, plate: Any, name: str, values: dict[str, tuple[str, Any, str]]) -> None:
        own = [
            self.create("IfcPropertySingleValue", Name=key, Description=text, NominalValue=self.create(kind, wrappedValue=value))
            for key, (kind, value, text) in values.items()
        ]
        made = self.rooted("IfcPropertySet", f"properties {name}", Name=PANEL_PROPERTIES, HasProperties=own)
        self._defined(plate, f"properties of {name}", made)

    def quantities(self, plate: Any, name: str, area: float, thickness: float) -> None:
        own = [
            self.create("IfcQuantityLength", Name="Width", LengthValue=thickness),
            self.create("IfcQuantityArea", Name="NetArea", AreaValue=area),
        ]
        made = self.rooted("IfcElementQuantity", f"quantities {name}", Name="Qto_PlateBaseQuantities", Quantities=own)
        self._defined(plate, f"quantities of {name}", made)

    def _defined(self, plate: Any, key: str, definition: Any) -> None:
        self.rooted("IfcRelDefinesByProperties", key, RelatedObjects=[plate], RelatingPropertyDefinition=definition)

    def content(self) -> bytes:
        header = self.file.header
        header.file_name.name = self.name
        header.file_name.time_stamp = CONSTANT_TIME
        header.file_name.originating_system = f"compas_cgc {__version__}"
        return self.file.to_string().encode("utf-8")
