"""A small Grasshopper: runs a definition from its file, from sliders to meshes, over the stand-ins."""

from __future__ import annotations

import base64
import json
import time
import types
import urllib.error
import urllib.request
from urllib.parse import urlsplit

from . import rhino_classes
from .rhino_classes import Component
from .rhino_classes import Document

PATIENCE = 300.0  # for a canvas that comes to rest, which takes as long as something is compiled [s]

# As McNeel's files have them.
KINDS = {
    "719467e6-7cf5-4848-99b0-c5dd57e5442c": "script",
    "c69bb52c-88ba-4640-b69f-188d111029e8": "hops",
    "57da07bd-ecab-415d-9d86-af36d7073abc": "slider",
    "59e0b89a-e487-49f8-bab8-b5bab16be14c": "panel",
    "2e78987b-9dfb-42a2-8b76-3923ac8bd91a": "toggle",
    "a8b97322-2d53-47cd-905e-b932c3ccd74e": "button",
    "00027467-0d24-4fa7-b178-8dc0ac5f42ec": "list",
    "7f5c6c55-f846-4a08-9c9a-cfdc285cc6fe": "scribble",
    "c552a431-af5b-46a9-a8a4-0fcbc27ef596": "group",
}
TYPES = {
    "3e8ca6be-fda8-4aaf-b5c0-3c54c8bb7312": "Number",
    "2e3ab970-8545-46bb-836c-1c11e5610bce": "Integer",
    "cb95db89-6165-43b6-9c41-5702bc5bf137": "Boolean",
    "3ede854e-c753-40eb-84cb-b48008f14fd4": "Text",
    "1e936df3-0eea-4246-8549-514cb8862b7a": "Mesh",
    "d5967b9f-e8ee-436b-a8ad-29fdcecf32d5": "Curve",
    "fbac3e32-f100-4292-8692-77240a42fd1a": "Point",
}
CASTS = {
    "48d01794-d3d8-4aef-990e-127168822244": int,
    "9d51e32e-c038-4352-9554-f4137ca91b9a": float,
    "3aceb454-6dbd-4c5b-9b6b-e71f8c1cdf88": str,
    "d60527f5-b5af-4ef6-8970-5f96fe412559": bool,
}


class Placed:
    """A script component as the file holds it, with one run after another."""

    def __init__(self, container, document):
        self.container = container
        self.component = Component(document)
        self.component.InstanceGuid = container.get("InstanceGuid")
        data = container.child("ParameterData")
        self.inputs, self.outputs = data.children("InputParam"), data.children("OutputParam")
        self.script = None

    def execute(self, code, space):
        """Run the lines of the script, which define its class."""
        exec(code, space)

    def run(self, values):
        """Return the values of the output parameters by their GUIDs."""
        self.component.balloons.clear()
        if self.script is None:
            space = {"ghenv": types.SimpleNamespace(Component=self.component)}
            self.execute(base64.b64decode(self.container.child("Script").get("Text")).decode("utf-8"), space)
            (self.script,) = [value for value in space.values() if isinstance(value, type) and value.__module__ == "builtins"]
        given = []
        for part in self.inputs:
            own = [value for i in range(part.get("SourceCount")) for value in values[part.get("Source", i)]]
            cast = CASTS.get(str(part.get("TypeHintID")), lambda value: value)
            own = [cast(value) for value in own]
            if part.get("Access", default=0) == 2:
                given.append(rhino_classes.DataTree({(0,): own} if own else {}))
            elif part.get("Access", default=0) == 1:
                given.append(own or None)
            else:
                assert len(own) < 2, f"{part.get('Name')} takes one item and is given {len(own)}"
                given.append(own[0] if own else None)
        returned = self.script().RunScript(*given)
        returned = returned if len(self.outputs) > 1 else [returned]
        return {part.get("InstanceGuid"): as_list(value) for part, value in zip(self.outputs, returned)}


class HopsComponent:
    """A Hops component as the file holds it; asks the server that is given, as Hops does."""

    def __init__(self, container, document):
        self.container = container
        self.component = Component(document)
        data = container.child("ParameterData")
        self.inputs, self.outputs = data.children("InputParam"), data.children("OutputParam")
        self.kinds = [TYPES[str(data.get("InputId", i))] for i in range(data.get("InputCount"))]
        self.server = None

    def run(self, values):
        """Return the values of the output parameters by their GUIDs."""
        self.component.balloons.clear()
        if self.server is None:
            return {part.get("InstanceGuid"): [] for part in self.outputs}
        path = urlsplit(self.container.get("RemoteDefinitionLocation")).path
        description = self.ask("GET", path)
        assert description["InputNames"] == [part.get("Name") for part in self.inputs], "Hops would rebuild the component"
        assert description["OutputNames"] == [part.get("Name") for part in self.outputs]
        trees = []
        for part, kind, declared in zip(self.inputs, self.kinds, description["Inputs"]):
            own = [value for i in range(part.get("SourceCount")) for value in values[part.get("Source", i)]]
            if not own and declared["AtLeast"] and "Default" not in declared:
                self.component.AddRuntimeMessage("Warning", f"Input parameter {part.get('Name')} failed to collect data")
                return {out.get("InstanceGuid"): [] for out in self.outputs}
            tree = {"{0}": [encoded(kind, value) for value in own]} if own else {}
            trees.append({"ParamName": part.get("Name"), "InnerTree": tree})
        answer = self.ask(
            "POST", "/solve", {"pointer": path.strip("/"), "values": trees, "modelunits": "Meters", "absolutetolerance": 0.001}
        )
        for level, texts in (("Error", answer["errors"]), ("Warning", answer["warnings"])):
            for text in texts:
                self.component.AddRuntimeMessage(level, text)
        found = {entry["ParamName"]: [decoded(x) for branch in entry["InnerTree"].values() for x in branch] for entry in answer["values"]}
        return {part.get("InstanceGuid"): found.get(part.get("Name"), []) for part in self.outputs}

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode("utf-8")
        asked = urllib.request.Request(self.server + path, data, {"Content-Type": "application/json; charset=utf-8"}, method=method)
        try:
            with urllib.request.urlopen(asked, timeout=PATIENCE) as answer:
                return json.loads(answer.read())
        except urllib.error.HTTPError as error:
            return json.loads(error.read())


def encoded(kind, value):
    """Return a value as Hops sends it."""
    if kind == "Mesh":
        value = json.dumps(rhino3dm_mesh(value).Encode())
    elif kind == "Point":
        value = json.dumps({"X": value.X, "Y": value.Y, "Z": value.Z})
    elif kind == "Curve":
        import rhino3dm

        line = rhino3dm.Polyline([rhino3dm.Point3d(*point) for point in value.points])
        value = json.dumps(line.ToPolylineCurve().Encode())
    elif kind == "Number":
        value = repr(float(value))
    else:
        value = json.dumps(value)
    return {"type": kind, "data": value}


def rhino3dm_mesh(mesh):
    import rhino3dm

    made = rhino3dm.Mesh()
    for point in mesh.Vertices:
        made.Vertices.AddPoint3d(*point)
    for face in mesh.Faces:
        made.Faces.AddFace(*(face if face.C != face.D else face[:3]))
    return made


def decoded(entry):
    """Return a value as Hops reads it."""
    kind, data = entry["type"], entry["data"]
    assert isinstance(data, str), "anything else makes the answer unreadable to Hops"
    if kind == "Rhino.Geometry.Mesh":
        import rhino3dm

        mesh = rhino3dm.CommonObject.Decode(json.loads(data))
        points = [(p.X, p.Y, p.Z) for p in mesh.Vertices.ToPoint3dArray()]
        return rhino_classes.rhino_mesh(points, [mesh.Faces[i] for i in range(len(mesh.Faces))])
    return {"System.Double": float, "System.Int32": int, "System.String": str}[kind](data)


def as_list(value):
    """Return what an output holds: anything that can be run through is taken apart."""
    if value is None:
        return []
    if isinstance(value, rhino_classes.DataTree):
        return value.AllData()
    return list(value) if hasattr(value, "__iter__") and not isinstance(value, (str, rhino_classes.Point3d)) else [value]


class Canvas:
    """A definition that is open, from the root of its archive."""

    def __init__(self, root, script=Placed):
        self.document = Document()
        objects = root.child("Definition").child("DefinitionObjects").children("Object")
        self.objects = [(KINDS.get(str(part.get("GUID")), "parameter"), part.child("Container")) for part in objects]
        kinds = {"script": script, "hops": HopsComponent}
        self.scripts = {c.get("InstanceGuid"): kinds[kind](c, self.document) for kind, c in self.objects if kind in kinds}
        self.set = {}  # what the user set, by the nickname of the object

    def widget(self, kind, container):
        """Return the values that an object of Grasshopper's own gives, or None if they come by a wire."""
        name = container.get("NickName")
        if name in self.set:
            return self.set[name]
        if kind == "slider":
            slider = container.child("Slider")
            assert slider.get("Min") <= slider.get("Value") <= slider.get("Max")
            return [int(slider.get("Value")) if slider.get("Interval") else slider.get("Value")]
        if kind == "toggle":
            return [container.get("ToggleValue")]
        if kind == "button":
            return [False]
        if kind == "list":
            return [entry.get("Expression").strip('"') for entry in container.children("ListItem") if entry.get("Selected")]
        if kind == "panel" and not container.get("SourceCount"):
            text = container.get("UserText")
            return [text] if container.child("PanelProperties").get("Multiline") else text.split("\n")
        return None if container.get("SourceCount", default=0) else []

    def solution(self):
        """Run everything once, each object after what it is wired to; return all values by parameter."""
        values, waiting = {}, [pair for pair in self.objects if pair[0] not in ("group", "scribble")]
        while waiting:
            ready = [pair for pair in waiting if all(source in values for source in sources(pair[1]))]
            assert ready, "the wires run in a circle"
            for kind, container in ready:
                own = container.get("InstanceGuid")
                if own in self.scripts:
                    values.update(self.scripts[own].run(values))
                    continue
                given = self.widget(kind, container)
                values[own] = given if given is not None else [value for source in sources(container) for value in values[source]]
            waiting = [pair for pair in waiting if pair not in ready]
        return values

    def settle(self, seconds=PATIENCE):
        """Run until nothing is scheduled any more, and return the values."""
        values, end = self.solution(), time.monotonic() + seconds
        while self.document.scheduled:
            assert time.monotonic() < end, "the canvas does not come to rest"
            time.sleep(0.02)
            self.document.tick()
            values = self.solution()
        return values

    def out(self, values, component, output, nth=0):
        """Return the values of an output of the n-th component of a name."""
        found = [placed for placed in self.scripts.values() if component in names_of(placed.container)][nth]
        part = next(part for part in found.outputs if part.get("Name") == output)
        return values[part.get("InstanceGuid")]

    def panel(self, values, name):
        """Return what a panel shows."""
        return next(values[c.get("InstanceGuid")] for kind, c in self.objects if kind == "panel" and c.get("NickName") == name)

    def balloons(self, level):
        """Return all balloons of a level."""
        return [text for placed in self.scripts.values() for own, text in placed.component.balloons if own == level]


def names_of(container):
    return container.get("Name"), container.get("NickName")


def sources(part):
    """Return the instances that wires of an object come from."""
    found = [part.get("Source", i) for i in range(part.get("SourceCount", default=0))]
    return found + [source for child in part.chunks for source in sources(child)]
