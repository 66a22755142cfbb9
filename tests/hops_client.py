"""A stand-in for Hops that raises where Hops would fail, written from its protocol."""

from __future__ import annotations

import json
import urllib.error
import urllib.request

import rhino3dm

KINDS = (
    "arc boolean box brep circle colour curve domain geometry integer line mesh number plane point "
    "rectangle text transform subd surface vector"
)
TYPES = {"System.Boolean", "System.Double", "System.String", "System.Int32", "Rhino.Geometry.Mesh"}


class HopsError(Exception):
    pass


def get(url):
    """Return status, type and body; Hops sends no key here."""
    try:
        with urllib.request.urlopen(url, timeout=20) as answer:
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
    """

    def __init__(self, url, generation=8, key=None, comma=False):
        self.url, self.generation, self.key, self.comma = url, generation, key, comma
        self.root, self.pointer = "/".join(url.split("/")[:3]), "/".join(url.split("/")[3:])
        for _ in range(2):
            status, kind, body = get(url)
            if "json" not in kind:
                raise HopsError("taken for a .gh file")
            if generation == 2026 and status != 200:
                raise HopsError(json.loads(body)["message"])
        self.description = json.loads(body)
        self._check()

    def _check(self):
        found = self.description
        if not isinstance(found, dict):
            raise HopsError("an array at a component path")
        for name in ("InputNames", "OutputNames"):
            if not isinstance(found.get(name), list):
                raise HopsError(f"null reference: {name}")
        for name in ("Errors", "Warnings"):
            if not isinstance(found.get(name, []), list):
                raise HopsError(f"{name} is null")
        for entry in found["Inputs"] + found["Outputs"]:
            if entry["ParamType"].lower() not in KINDS.split():
                raise HopsError(f"unknown type {entry['ParamType']}")
        for entry in found["Inputs"]:
            default = entry.get("Default")
            if default is not None and not isinstance(default, (bool, int, float, str)):
                raise HopsError("a default that is no scalar")
            if self.generation == 7 and entry.get("AtLeast", 1) == 0 and default is not None:
                raise HopsError("an optional input with a default")
        names = [entry["Name"] for entry in found["Inputs"]]
        if len(set(names)) < len(names):
            raise HopsError("names are not unique")

    def access(self, name):
        entry = next(entry for entry in self.description["Inputs"] if entry["Name"] == name)
        bounds = (entry.get("AtLeast", 1), entry.get("AtMost", 2147483647))
        return "tree" if entry.get("TreeAccess") or bounds == (-1, -1) else "item" if bounds == (1, 1) else "list"

    def request(self, path="{0}", **inputs):
        """Return the body that Hops sends; an unconnected input takes its default or stays empty."""
        values = []
        for entry in self.description["Inputs"]:
            name = entry["Name"]
            value = inputs.get(name, entry.get("Default"))
            items = [] if value is None else value if isinstance(value, list) else [value]
            if not items and entry.get("AtLeast", 1) > 0:
                raise HopsError(f"Input parameter {name} failed to collect data")
            tree = {path: [write(item, entry["ParamType"], self.generation) for item in items]} if items else {}
            values.append({"ParamName": name, "InnerTree": tree})
        body = {"absolutetolerance": 0.001, "angletolerance": 1.0, "modelunits": "Meters", "dataversion": 7, "algo": None}
        body.update(pointer=self.pointer, cachesolve=True, values=values, warnings=[], errors=[])
        if self.generation == 2026:
            body.update({"dataformat": 0, "filename": None, "values-grasshopper": {"Values": {}}})
        return body

    def solve(self, path="{0}", **inputs):
        return self.post(json.dumps(self.request(path, **inputs)).encode())

    def post(self, body, address="/solve", kind="application/json; charset=utf-8"):
        """Send a body and return status, outputs by name, errors and warnings."""
        headers = {"Content-Type": kind, **({"RhinoComputeKey": self.key} if self.key else {})}
        try:
            with urllib.request.urlopen(urllib.request.Request(self.root + address, body, headers), timeout=100) as answer:
                status, length, content = answer.status, answer.headers["Content-Length"], answer.read()
        except urllib.error.HTTPError as error:
            status, length, content = error.code, error.headers["Content-Length"], error.read()
        if length is None:
            raise HopsError("no Content-Length")
        try:
            schema = json.loads(content)
        except ValueError:
            raise HopsError("Object reference not set to an instance of an object") from None
        for name in ("values", "errors", "warnings"):
            if not isinstance(schema.get(name), list):
                raise HopsError(f"{name} is no list")
        if schema["values"] and [value["ParamName"] for value in schema["values"]] != self.description["OutputNames"]:
            raise HopsError("the outputs have changed")
        outputs = {
            value["ParamName"]: [self.read(item) for branch in value["InnerTree"].values() for item in branch] for value in schema["values"]
        }
        return status, outputs, schema["errors"], schema["warnings"]

    def read(self, item):
        kind, data = item["type"], item["data"]
        if isinstance(data, (dict, list)):
            raise HopsError("the body cannot be read")
        if kind not in TYPES:
            raise HopsError(f"unknown type {kind}")
        text = str(data) if not isinstance(data, str) else data.strip('"')
        if kind == "System.Double":
            # double.Parse with the user's culture: in German the point is a thousands mark.
            return float(text.replace(".", "").replace(",", ".") if self.comma else text)
        if kind == "System.Int32":
            return int(text)
        if kind == "System.Boolean":
            return {"true": True, "false": False}[text]
        if kind == "System.String":
            if self.generation != 2026:
                return text
            try:
                value = json.loads(data)
            except ValueError:
                return data
            return value if isinstance(value, str) else str(value) if not isinstance(value, dict) else data
        return rhino3dm.CommonObject.Decode(json.loads(data))


def write(value, kind, generation):
    """Return an item as Hops writes it."""
    more = {"id": "00000000-0000-0000-0000-000000000000"} if generation == 2026 else {}
    if kind == "Text":
        return {"type": "System.String", "data": json.dumps(value), **more}
    if kind == "Number":
        return {"type": "System.Double", "data": repr(float(value)), **more}
    if kind == "Integer":
        return {"type": "System.Int32", "data": str(value), **more}
    if kind == "Point":
        return {"type": "Rhino.Geometry.Point3d", "data": json.dumps(dict(zip("XYZ", map(float, value)))), **more}
    encoded = value.Encode()
    return {"type": f"Rhino.Geometry.{type(value).__name__}", "data": json.dumps({**encoded, "archive3dm": 70}), **more}
