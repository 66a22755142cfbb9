"""Routes of the page, its files, models and examples."""

from __future__ import annotations

import functools
import gzip
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Optional

from flask import Blueprint
from flask import Response
from flask import current_app
from flask import request

from ...io.formats import listed
from ..api.blocking_calls import run_in_reader
from ..api.decoding import check_length
from ..api.decoding import read_json
from ..api.design_files import DESIGN_KINDS
from ..api.mesh_files import KINDS
from ..api.requests import accept
from ..api.responses import respond
from ..api.schemas import PLAN_KINDS
from ..api.uploads import body_held
from ..errors import BadRequest
from ..errors import NotFound
from ..errors import Unprocessable
from .curvatures import curvatures
from .drawing import mesh_of_sketch
from .drawing import read_sketch
from .gallery import GALLERY
from .preview import read_example
from .preview import read_model
from .preview import read_plan
from .preview import read_surface

__all__ = ["index", "page", "wants_page"]

page = Blueprint("page", __name__)

STATIC = Path(__file__).parent / "static"
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml", ".png": "image/png"}
# Only these files are ever opened, whatever path is requested.
FILES = {path.relative_to(STATIC).as_posix(): path for path in STATIC.rglob("*") if path.suffix in TYPES}
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
_examples: dict[str, bytes] = {}


def wants_page() -> bool:
    """Check whether a client prefers HTML to JSON; a client that accepts anything gets JSON.

    Returns
    -------
    bool
        True for a browser.

    Examples
    --------
    >>> wants_page()  # doctest: +SKIP
    """
    accepted = request.accept_mimetypes
    return accepted["text/html"] > accepted["application/json"]


def index() -> Response:
    """Return the page.

    Returns
    -------
    flask.Response
        HTML.

    Examples
    --------
    >>> index()  # doctest: +SKIP
    """
    answer = _file("index.html")
    answer.headers["Content-Security-Policy"] = POLICY
    answer.headers["Referrer-Policy"] = "no-referrer"
    return answer


@page.get("/page/<path:name>")
def file(name: str) -> Response:
    """Return a file of the page."""
    if name not in FILES or name == "index.html":
        raise NotFound("the page has no such file")
    return _file(name)


def _file(name: str) -> Response:
    path = FILES[name]
    packed = path.suffix != ".png" and request.accept_encodings["gzip"] > 0
    content = _packed(path, path.stat().st_mtime_ns) if packed else _content(path)
    answer = Response(content, mimetype=TYPES[path.suffix])
    answer.headers["Cache-Control"] = "no-cache"
    answer.vary.add("Accept-Encoding")
    if packed:
        answer.headers["Content-Encoding"] = "gzip"
    answer.add_etag()
    answer.make_conditional(request)
    return answer


@functools.lru_cache(maxsize=256)
def _packed(path: Path, changed: int) -> bytes:
    """Return a file compressed with gzip, about a quarter of its size; deterministic."""
    return gzip.compress(_content(path), mtime=0)


def _content(path: Path) -> bytes:
    """Return the bytes of a file, with the kinds of files that the server reads in the page."""
    content = path.read_bytes()
    if path.name != "index.html":
        return content
    meshes, plans, designs = ([f".{kind}" for kind in kinds] for kinds in (KINDS, PLAN_KINDS, DESIGN_KINDS))
    words = {
        "accept": ",".join(dict.fromkeys([*meshes, *plans, ".json"])),
        "meshes": " ".join(KINDS),
        "plans": " ".join(PLAN_KINDS),
        "accept designs": ",".join(designs),
        "designs": " ".join(DESIGN_KINDS),
        "mesh files": listed(meshes),
        "design files": listed(designs),
        "plan files": listed(plans),
    }
    for name, text in words.items():
        content = content.replace(f"{{{{{name}}}}}".encode(), text.encode())
    return content


@page.post("/api/v1/models")
def model() -> Response:
    """Return the contents of a file."""
    kind, name = request.args.get("kind", ""), request.args.get("name", "")[:100]
    if kind not in KINDS:
        raise Unprocessable(f"'kind' must be {' or '.join(KINDS)}; save the mesh in one of these formats")
    with _file_held() as body:
        found = run_in_reader(read_model, kind, body, name, current_app.config["LIMITS"], _edge_length())
    return Response(found, mimetype="application/json")


@page.post("/api/v1/plans")
def plan() -> Response:
    """Read the curves and points of a drawing."""
    kind = request.args.get("kind", "")
    if kind not in PLAN_KINDS:
        raise Unprocessable(f"'kind' must be {' or '.join(PLAN_KINDS)}")
    with _file_held() as body:
        return Response(run_in_reader(read_plan, kind, body, _join()), mimetype="application/json")


@page.post("/api/v1/surfaces")
def surface() -> Response:
    """Return the surface of a freeform design as a mesh."""
    kind = request.args.get("kind", "")
    if kind not in DESIGN_KINDS:
        raise Unprocessable(f"'kind' must be {' or '.join(DESIGN_KINDS)}; save the design in one of these formats")
    with _file_held() as body:
        return Response(run_in_reader(read_surface, kind, body, current_app.config["LIMITS"]), mimetype="application/json")


@contextmanager
def _file_held() -> Iterator[bytes]:
    """Return the bytes of the file in the request, see :func:`body_held`."""
    with body_held() as body:
        if not body:
            raise BadRequest("the request is empty; send the bytes of the file")
        yield body


def _join() -> Optional[float]:
    """Return the distance within which ends of curves are joined [L], None where none is given."""
    text = request.args.get("join")
    if text is None:
        return None
    try:
        distance = float(text)
    except ValueError:
        distance = math.nan
    if not (math.isfinite(distance) and distance >= 0):
        raise Unprocessable(f"'join' must be a length of zero or more, not {text!r:.40}")
    return distance


def _edge_length() -> Optional[float]:
    """Return the edge length for meshing curves and surfaces [L], None if not given."""
    text = request.args.get("edge_length")
    if text is None:
        return None
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not (math.isfinite(length) and length > 0):
        raise Unprocessable(f"the edge length must be a number greater than zero, not {text!r:.40}")
    return length


@page.post("/api/v1/drawings")
def drawing() -> Response:
    """Mesh a drawing."""
    limits = current_app.config["LIMITS"]
    check_length(request.content_length, limits)
    with body_held() as body:
        sketch = read_sketch(read_json(body, limits), limits)
    return Response(run_in_reader(mesh_of_sketch, sketch, limits), mimetype="application/json")


@page.post("/api/v1/curvatures")
def measured() -> Response:
    """Return the curvatures of a surface."""
    limits = current_app.config["LIMITS"]
    check_length(request.content_length, limits)
    with body_held() as body:
        surface = accept(read_json(body, limits), limits, body)
    return Response(run_in_reader(curvatures, surface, limits), mimetype="application/json")


@page.get("/api/v1/examples")
def examples() -> Response:
    """List the examples."""
    found = [{"name": entry.name, "number": entry.number, "title": entry.title, "text": entry.text} for entry in GALLERY.values()]
    return respond({"examples": found})


@page.get("/api/v1/examples/<name>")
def example(name: str) -> Response:
    """Return the contents of an example."""
    if name not in GALLERY:
        raise NotFound(f"there is no example {name[:60]!r}; the examples are {', '.join(GALLERY)}")
    if name not in _examples:
        entry = GALLERY[name]
        _examples[name] = run_in_reader(read_example, name, entry.title, entry.text)
    return Response(_examples[name], mimetype="application/json")
