"""Designs on the server: revisions, owners, and links as the only exception to ownership."""

from __future__ import annotations

import logging
from concurrent.futures import ThreadPoolExecutor

import pytest

from compas_cgc.server import create_app
from compas_cgc.server.jobs.backup import backup_store
from compas_cgc.server.jobs.backup import restore_store
from compas_cgc.server.jobs.designs import Designs
from compas_cgc.server.jobs.store import Store
from compas_cgc.server.keys import read_keys
from compas_cgc.server.limits import Limits

from .test_owners import BEN
from .test_owners import FILE
from .test_owners import ID
from .test_owners import pairs

ANNA = {"RhinoComputeKey": "the-key-of-anna"}
BEN = {"RhinoComputeKey": BEN}
LARGE = bytes(range(256)) * 1000  # in a file of its own
AT = f"/api/v1/designs/{ID}"


@pytest.fixture
def app(tmp_path):
    (path := tmp_path / "keys.toml").write_text(FILE)
    app = create_app(tmp_path / "jobs.sqlite", key=read_keys(path), executor=ThreadPoolExecutor(1))
    yield app
    app.extensions["jobs"].close()


@pytest.fixture
def client(app):
    return app.test_client()


def test_a_design_is_replaced_by_who_knows_its_revision_alone(client):
    first = client.put(f"{AT}?name=Hall", data=b"one", headers=ANNA)
    assert first.json["revision"] == 1 and first.headers["ETag"] == '"1"'
    assert client.put(AT, data=b"again", headers=ANNA).status_code == 409, "a second tab does not know of the first"
    assert client.put(AT, data=LARGE, headers={**ANNA, "If-Match": '"1"'}).json["revision"] == 2
    assert client.put(AT, data=b"late", headers={**ANNA, "If-Match": '"1"'}).status_code == 409
    found = client.get(AT, headers=ANNA)
    assert found.data == LARGE and found.headers["ETag"] == '"2"'
    listed = client.get("/api/v1/designs", headers=ANNA).json["designs"]
    assert [(own["id"], own["revision"], own["bytes"]) for own in listed] == [(ID, 2, len(LARGE))]
    assert client.delete(AT, headers=ANNA).status_code == 204
    assert client.get(AT, headers=ANNA).status_code == 404
    assert client.put(AT, data=b"x", headers={**ANNA, "If-Match": '"2"'}).status_code == 404


@pytest.mark.parametrize(
    "id, data, headers, status",
    [("short", b"x", {}, 422), (ID, b"", {}, 422), (ID, b"x", {"If-Match": "W/x"}, 422), ("anna:roof-2026", b"x", {}, 422)],
)
def test_what_is_no_design_is_refused(client, id, data, headers, status):
    answer = client.put(f"/api/v1/designs/{id}", data=data, headers={**ANNA, **headers})
    assert answer.status_code == status and answer.json["message"]


def test_a_foreign_key_finds_no_design_at_any_address(app, client):
    client.put(AT, data=b"secret", headers=ANNA)
    link = client.post(f"{AT}/links", json={"mode": "view"}, headers=ANNA).json["id"]
    addresses = [(method, path.replace("0123456789abcdef", link)) for method, path in pairs(app) if path.startswith(AT)]
    assert len(addresses) == 6
    for method, path in addresses:
        # Without a revision, this would be a design of the same id of the other owner.
        headers = {**BEN, "If-Match": '"1"'} if method == "put" else BEN
        answer = client.open(path, method=method.upper(), data=b"{}", headers=headers)
        assert answer.status_code == 404 and b"secret" not in answer.data, (method, path)
    assert client.get("/api/v1/designs", headers=BEN).json["designs"] == []
    assert client.get(AT, headers=ANNA).data == b"secret" and len(client.get(f"{AT}/links", headers=ANNA).json["links"]) == 1


def test_a_link_shows_the_newest_revision_to_anybody_until_it_is_revoked(client, caplog):
    client.put(AT, data=b"one", headers=ANNA)
    links = [client.post(f"{AT}/links", json={"mode": mode}, headers=ANNA).json for mode in ("copy", "view")]
    assert len({link["token"] for link in links}) == 2 and all(len(link["token"]) == 22 for link in links)
    client.put(AT, data=LARGE, headers={**ANNA, "If-Match": '"1"'})
    with caplog.at_level(logging.INFO, "compas_cgc.server.requests"):
        for link in links:
            found = client.get(f"/api/v1/shared/{link['token']}")
            assert found.status_code == 200 and found.data == LARGE and found.headers["CGC-Mode"] == link["mode"]
    assert links[0]["token"] not in caplog.text and "/api/v1/shared/<token>" in caplog.text
    shown = client.get(f"{AT}/links", headers=ANNA)
    assert len(shown.json["links"]) == 2 and links[0]["token"] not in shown.text
    assert client.delete(f"{AT}/links/{links[0]['id']}", headers=ANNA).status_code == 204
    assert [client.get(f"/api/v1/shared/{link['token']}").status_code for link in links] == [404, 200]
    assert client.put(f"/api/v1/shared/{links[1]['token']}", data=b"x").status_code == 401, "a link gives nothing but the content"
    assert client.delete(AT, headers=ANNA).status_code == 204
    assert client.get(f"/api/v1/shared/{links[1]['token']}").status_code == 404
    assert client.post(f"{AT}/links", json={"mode": "edit"}, headers=ANNA).status_code == 404


def test_a_mode_that_does_not_exist_is_refused(client):
    client.put(AT, data=b"one", headers=ANNA)
    assert client.post(f"{AT}/links", json={"mode": "edit"}, headers=ANNA).status_code == 422
    assert client.post(f"{AT}/links", data=b"[]", headers=ANNA).status_code == 422


def test_designs_survive_a_restart_and_a_backup(tmp_path):
    path = tmp_path / "jobs.sqlite"
    store = Store(path)
    own = Designs(store, "anna", Limits())
    own.put(ID, "Hall", [LARGE], 0)
    own.put(ID, "Hall", [LARGE, b"end"], 1)
    token = own.share(ID, "copy")[1]
    assert store.owner_bytes("anna") == len(LARGE) + 3 and len(list((tmp_path / "jobs.sqlite-files").iterdir())) == 1
    store.close()
    store = Store(path)
    assert Designs(store, "anna", Limits()).content(ID)[1] == LARGE + b"end"
    backup_store(path, tmp_path / "backup")
    Designs(store, "anna", Limits()).delete(ID)
    assert not list((tmp_path / "jobs.sqlite-files").iterdir())
    store.close()
    restore_store(tmp_path / "backup", path)
    app = create_app(path, executor=ThreadPoolExecutor(1))
    assert app.test_client().get(f"/api/v1/shared/{token}").data == LARGE + b"end"
    app.extensions["jobs"].close()


def test_the_bytes_of_an_owner_are_limited(tmp_path):
    client = create_app(tmp_path / "jobs.sqlite", executor=ThreadPoolExecutor(1), limits=Limits(owner_bytes=2 * len(LARGE))).test_client()
    assert [client.put(f"/api/v1/designs/design-{k}", data=LARGE).status_code for k in range(3)] == [200, 200, 507]
    client.application.extensions["jobs"].close()
