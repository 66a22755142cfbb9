"""Routes of designs and of links to them."""

from __future__ import annotations

from flask import Blueprint
from flask import Response
from flask import current_app
from flask import request

from ..errors import Unprocessable
from ..jobs.blobs import pieces
from ..jobs.designs import Design
from ..jobs.designs import Designs
from ..jobs.designs import shared
from ..security import client_name
from ..security import owner
from .decoding import read_json
from .responses import respond
from .uploads import body_held

__all__ = ["designs"]

designs = Blueprint("designs", __name__)
MEDIA_TYPE = "application/octet-stream"


def _designs() -> Designs:
    """Return the designs of the owner of the request."""
    return Designs(current_app.extensions["jobs"].store, owner(), current_app.config["LIMITS"])


@designs.get("/api/v1/designs")
def show_all() -> Response:
    """List the designs, newest first."""
    return respond({"designs": [design._asdict() for design in _designs().all()]})


@designs.get("/api/v1/designs/<id>")
def show(id: str) -> Response:
    """Return the content of a design."""
    return _answer(*_designs().content(id))


@designs.put("/api/v1/designs/<id>")
def put(id: str) -> Response:
    """Store a design; the header If-Match holds the revision that it replaces."""
    length = request.content_length or 0
    with current_app.extensions["bodies"].held(length, client_name()):
        stored = _designs().put(id, request.args.get("name", ""), pieces(request.stream), _revision())
    return respond(stored._asdict(), headers={"ETag": f'"{stored.revision}"'})


@designs.delete("/api/v1/designs/<id>")
def delete(id: str) -> Response:
    """Delete a design and its links."""
    _designs().delete(id)
    return Response(status=204)


@designs.get("/api/v1/designs/<id>/links")
def show_links(id: str) -> Response:
    """List the links to a design, newest first."""
    return respond({"links": [link._asdict() for link in _designs().links(id)]})


@designs.post("/api/v1/designs/<id>/links")
def share(id: str) -> Response:
    """Create a link to a design."""
    with body_held() as body:
        value = read_json(body, current_app.config["LIMITS"]) if body else {}
    if not isinstance(value, dict) or not isinstance(value.get("mode"), str):
        # The design is looked for first, so that the answer says nothing about designs of others.
        _designs().get(id)
        raise Unprocessable("the request must be a JSON object with a 'mode'")
    link, token = _designs().share(id, value["mode"])
    return respond({**link._asdict(), "token": token}, 201)


@designs.delete("/api/v1/designs/<id>/links/<link>")
def revoke(id: str, link: str) -> Response:
    """Revoke a link."""
    _designs().revoke(id, link)
    return Response(status=204)


@designs.get("/api/v1/shared/<token>")
def show_shared(token: str) -> Response:
    """Return the content of the design of a link, to anybody who has it."""
    name, mode, content = shared(current_app.extensions["jobs"].store, token)
    answer = Response(content, mimetype=MEDIA_TYPE)
    answer.headers["CGC-Mode"] = mode
    return answer


def _answer(design: Design, content: bytes) -> Response:
    answer = Response(content, mimetype=MEDIA_TYPE)
    answer.headers["ETag"] = f'"{design.revision}"'
    return answer


def _revision() -> int:
    """Return the revision in the header If-Match, 0 without it."""
    text = request.headers.get("If-Match")
    if text is None:
        return 0
    number = text.strip().strip('"')
    if not (number.isascii() and number.isdecimal() and len(number) < 12):
        raise Unprocessable('the header If-Match must hold the revision of the design, such as "3"')
    return int(number)
