"""A stand-in for Hops that raises where Hops would fail or show something else, written from its protocol."""

from __future__ import annotations

import json
import re
import urllib.error
import urllib.request
from xml.etree import ElementTree

import rhino3dm

from .server_process import PATIENCE

KINDS = (
    "arc boolean box brep circle colour curve domain geometry integer line mesh number plane point "
    "rectangle text transform subd surface vector"
)
SCALARS = {"Number": (int, float), "Integer": int, "Boolean": bool, "Text": str}
TYPES = {"Boolean": "System.Boolean", "Number": "System.Double", "Text": "System.String", "Integer": "System.Int32"}
TYPES.update({"Mesh": "Rhino.Geometry.Mesh", "Curve": "Rhino.Geometry.PolylineCurve", "Point": "Rhino.Geometry.Point3d"})
PATH = re.compile(r"\{\d+(;\d+)*\}")
LEAK = re.compile(r'Traceback|File "|\.py\b|site-packages|[A-Z]:\\|/(home|tmp|usr|var|root|work)/')


class HopsError(Exception):
    pass


def require(condition, message):
    if not condition:
        raise HopsError(message)


def get(url):
    """Return status, type and body; Hops sends no key here."""
    try:
        with urllib.request.urlopen(url, timeout=PATIENCE) as answer:
            return answer.status, answer.headers["Content-Type"], answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers["Content-Type"], error.read()


class Hops:
    """A Hops component.

    Parameters
    ----------
    url
        Path of the component.
    generation
        7 (Rhino 7), 8 (Rhino 8) or 2026.
    key
        API key of the preferences.
    comma
        Whether the user's culture writes 0,25.
    memory
        Whether good answers are kept by the client ("Cache In Memory").
    """

    def __init__(self, url, generation=8, key=None, comma=False, memory=False):
        self.url, self.generation, self.key, self.comma = url, generation, key, comma
        self.memory = {} if memory else None
        self.root, self.pointer = "/".join(url.split("/")[:3]), "/".join(url.split("?")[0].split("/")[3:])
        for _ in range(2):
            status, kind, body = get(url)
            require("json" in kind, "taken for a .gh file")
            if generation == 2026 and status != 200:
                raise HopsError(json.loads(body)["message"])
        self.description = json.loads(body)
        self._check()

    def _check(self):
        # Property names are read in any case.
        found = {name[:1].upper() + name[1:]: value for name, value in self.description.items()}
        require(isinstance(found, dict), "an array at a component path")
        for name in ("Inputs", "Outputs", *(("InputNames", "OutputNames") if self.generation == 2026 else ())):
            require(isinstance(found.get(name), list), f"null reference: {name}")
        for name in ("Errors", "Warnings"):
            require(isinstance(found.get(name, []), list), f"{name} is null")
        require(not found.get("Errors"), f"the component is red: {found.get('Errors')}")
        require(isinstance(found["Description"], str) and found["Description"], "no description")
        icon = ElementTree.fromstring(found["Icon"]) if found.get("Icon") else None
        require(icon is None or icon.tag == "{http://www.w3.org/2000/svg}svg", "the icon is no SVG")
        for side in ("Inputs", "Outputs"):
            names = [entry["Name"] for entry in found[side]]
            require(len(set(names)) == len(names), "names are not unique")
            require(found[f"{side[:-1]}Names"] == names, f"{side[:-1]}Names are others than those of {side}")
            for entry in found[side]:
                require(entry["ParamType"].lower() in KINDS.split(), f"unknown type {entry['ParamType']}")
                require(not entry["Name"].startswith("RH_"), "a name with a meaning of its own")
        for entry in found["Inputs"]:
            default, kind = entry.get("Default"), entry["ParamType"]
            if default is not None:
                right = isinstance(default, SCALARS.get(kind, ())) and isinstance(default, bool) == (kind == "Boolean")
                require(right, "a default that is no scalar of its type: read by the user's culture, or not at all")
                require((entry.get("AtLeast", 1), entry.get("AtMost")) == (1, 1), "a default at an input of lists")

    def entry(self, name):
        return next(entry for entry in self.description["Inputs"] if entry["Name"] == name)

    def access(self, name):
        entry = self.entry(name)
        bounds = (entry.get("AtLeast", 1), entry.get("AtMost", 2147483647))
        return "tree" if entry.get("TreeAccess") or bounds == (-1, -1) else "item" if bounds == (1, 1) else "list"

    def request(self, path="{0}", units="Meters", tolerance=0.001, **inputs):
        """Return the body that Hops sends; an unconnected input takes its default or stays empty."""
        values = []
        for entry in self.description["Inputs"]:
            name = entry["Name"]
            value = inputs.pop(name, entry.get("Default"))
            items = [] if value is None else value if isinstance(value, list) else [value]
            optional = entry.get("AtLeast", 1) == 0 and self.generation != 7
            require(items or optional, f"Input parameter {name} failed to collect data")
            require(len(items) == 1 or self.access(name) != "item", f"{name} takes one item, each of {len(items)} would be sent on its own")
            require(not items or entry.get("AtLeast", 1) <= len(items) <= entry.get("AtMost", 2147483647), f"{name}: number of items")
            if entry["ParamType"] in ("Number", "Integer"):
                low, high = entry.get("Minimum", float("-inf")), entry.get("Maximum", float("inf"))
                require(all(low <= item <= high for item in items), f"{name} value must be within the specified bounds")
            tree = {path: [write(item, entry["ParamType"], self.generation) for item in items]} if items else {}
            values.append({"ParamName": name, "InnerTree": tree})
        require(not inputs, f"there is no input {sorted(inputs)}")
        body = {"absolutetolerance": tolerance, "angletolerance": 1.0, "modelunits": units, "dataversion": 7, "algo": None}
        if not tolerance:
            del body["absolutetolerance"]
        body.update(pointer=self.pointer, cachesolve=True, values=values, warnings=[], errors=[])
        if self.generation == 2026:
            body.update({"dataformat": 0, "filename": None, "values-grasshopper": {"Values": {}}})
        return body

    def solve(self, path="{0}", **inputs):
        return self.post(json.dumps(self.request(path, **inputs)).encode())

    def post(self, body, address="/solve", kind="application/json; charset=utf-8", **headers):
        """Send a body and return status, outputs by name, errors and warnings."""
        if self.memory is not None and body in self.memory:
            return self.memory[body]
        headers = {"Content-Type": kind, **({"RhinoComputeKey": self.key} if self.key else {}), **headers}
        try:
            with urllib.request.urlopen(urllib.request.Request(self.root + address, body, headers), timeout=PATIENCE) as answer:
                status, told, content = answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            status, told, content = error.code, error.headers, error.read()
        self.headers, self.content = told, content
        require(told["Content-Length"] == str(len(content)), "no Content-Length")
        require(told["Content-Encoding"] is None, "compressed, which nobody asked for")
        require(status != 408, "Request timeout")
        found = status, *self._schema(content, status)
        if self.memory is not None and status == 200:
            self.memory[body] = found
        return found

    def _schema(self, content, status):
        try:
            schema = json.loads(content.decode("utf-8"), parse_constant=lambda name: require(False, f"{name} in JSON"))
        except ValueError:
            raise HopsError("Object reference not set to an instance of an object") from None
        require(isinstance(schema, dict) and isinstance(schema.get("message"), str), "no object with a message")
        for name in ("values", "errors", "warnings"):
            require(isinstance(schema.get(name), list), f"{name} is no list")
        for text in schema["errors"] + schema["warnings"]:
            require(isinstance(text, str) and text.strip() and not LEAK.search(text), f"not for the eyes of a user: {text!r}")
        require(status < 300 or schema["errors"], "a failure without a word")
        outputs = {entry["Name"]: entry["ParamType"] for entry in self.description["Outputs"]}
        if schema["values"]:
            names = [value["ParamName"] for value in schema["values"]]
            require(sorted(names) == sorted(outputs), "the outputs have changed")
        found = {}
        for value in schema["values"]:
            require(isinstance(value["InnerTree"], dict), "a tree that is null")
            require(all(PATH.fullmatch(path) for path in value["InnerTree"]), "a path that is no path")
            items = [item for branch in value["InnerTree"].values() for item in branch]
            found[value["ParamName"]] = [self.read(item, outputs[value["ParamName"]]) for item in items]
        return found, schema["errors"], schema["warnings"]

    def read(self, item, declared=None):
        kind, data = item["type"], item["data"]
        require(isinstance(data, (str, int, float, bool)), "the body cannot be read")
        require(kind in TYPES.values() and declared in (None, *(name for name in TYPES if TYPES[name] == kind)), f"unknown type {kind}")
        text = (data if isinstance(data, str) else json.dumps(data)).strip('"')
        if kind == "System.Double":
            # double.Parse with the user's culture: in German the point is a thousands mark.
            value = float(text.replace(".", "").replace(",", ".") if self.comma else text.replace(",", ""))
            require(abs(value) < float("inf"), "a number that poisons the definition")
            return value
        if kind == "System.Int32":
            require(re.fullmatch(r"[+-]?\d+", text) and abs(int(text)) < 2**31, "FormatException")
            return int(text)
        if kind == "System.Boolean":
            require(text.lower() in ("true", "false"), "FormatException")
            return text.lower() == "true"
        if kind == "System.String":
            return self.shown(data if isinstance(data, str) else text)
        fields = json.loads(text)
        if kind == TYPES["Point"]:
            require(set(fields) == set("XYZ") and all(isinstance(x, float) for x in fields.values()), "no point")
            return rhino3dm.Point3d(*(fields[axis] for axis in "XYZ"))
        require(all(isinstance(value, (str, int)) for value in fields.values()), "geometry that is no dictionary of texts")
        geometry = rhino3dm.CommonObject.Decode(fields)
        require(type(geometry).__name__ == kind.split(".")[-1] and geometry.IsValid, f"no valid {kind}")
        return geometry

    def shown(self, data):
        """Return what a panel shows of a text."""
        text = data.strip('"')
        if text.strip().startswith("{") and "\\" in text:
            return text.encode("latin-1", "backslashreplace").decode("unicode_escape")
        if self.generation != 2026:
            return text
        try:
            value = json.loads(data)
        except ValueError:
            return data
        return value if isinstance(value, str) else data if isinstance(value, (dict, list)) else "" if value is None else str(value)


def write(value, kind, generation=8):
    """Return an item as Hops writes it."""
    more = {"id": "00000000-0000-0000-0000-000000000000"} if generation == 2026 else {}
    if kind == "Text":
        return {"type": "System.String", "data": json.dumps(value), **more}
    if kind == "Number":
        return {"type": "System.Double", "data": repr(float(value)).upper(), **more}
    if kind == "Integer":
        return {"type": "System.Int32", "data": str(value), **more}
    if kind == "Boolean":
        return {"type": "System.Boolean", "data": "true" if value else "false", **more}
    if kind == "Point":
        return {"type": "Rhino.Geometry.Point3d", "data": json.dumps(dict(zip("XYZ", map(float, value)))), **more}
    # Rhino 7 and 8 number their archives so.
    archive = {"archive3dm": 70 if generation == 7 else 80}
    return {"type": f"Rhino.Geometry.{type(value).__name__}", "data": json.dumps({**value.Encode(), **archive}), **more}
