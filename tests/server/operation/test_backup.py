"""Backup and restore: a running store is copied whole, and put back without loss."""

from __future__ import annotations

import threading
import time

import pytest

from compas_cgc.cli import main
from compas_cgc.errors import FileError
from compas_cgc.server.jobs.backup import backup_store
from compas_cgc.server.jobs.backup import restore_store
from compas_cgc.server.jobs.store import Job
from compas_cgc.server.jobs.store import Store

LARGE = 300_000


def job(id):
    return Job(id, "queued", time.time(), None, None, 0, "client", "digest", "", {}, None, None)


def content(id):
    return id.encode() * LARGE


def test_backup_of_a_store_in_use_holds_every_job_and_file(tmp_path):
    own = Store(tmp_path / "jobs.sqlite")
    over = threading.Event()

    def work():
        for k in range(10_000):
            if over.is_set():
                return
            own.add(job(f"new-{k}"), "json", {}, content(f"new-{k}"))
            own.finish(f"new-{k}", "succeeded", "done", {}, content(f"result-{k}"))
            if k >= 3:
                own.delete(f"new-{k - 3}")

    own.add(job("waiting"), "json", {}, content("waiting"))
    thread = threading.Thread(target=work)
    thread.start()
    try:
        for k in range(5):
            time.sleep(0.2)
            assert backup_store(tmp_path / "jobs.sqlite", tmp_path / f"backup-{k}") >= 1
    finally:
        over.set()
        thread.join()
        own.close()
    for k in range(5):
        copy = Store(tmp_path / f"backup-{k}" / "jobs.sqlite")
        assert copy.body("waiting") == content("waiting")
        for one in copy.all():
            number = one.id.partition("-")[2]
            if one.state == "succeeded":
                assert copy.result(one.id) == content(f"result-{number}")
            else:
                assert copy.body(one.id) == content(one.id)
        copy.close()


def test_restore_puts_the_jobs_back_and_renames_the_present_ones(tmp_path, capsys):
    path = tmp_path / "state" / "jobs.sqlite"
    own = Store(path)
    own.add(job("first"), "json", {}, content("first"))
    own.close()
    assert main(["backup", str(tmp_path / "backup"), "--store", str(path)]) == 0
    assert "copied 1 job from" in capsys.readouterr().out
    own = Store(path)
    own.delete("first")
    own.add(job("second"), "json", {}, content("second"))
    with pytest.raises(FileError, match="another server is using it.*stop the server first"):
        restore_store(tmp_path / "backup", path)
    own.close()
    assert main(["restore", str(tmp_path / "backup"), "--store", str(path)]) == 0
    own = Store(path)
    assert [one.id for one in own.all()] == ["first"] and own.body("first") == content("first")
    own.close()
    aside = next(path.parent.glob("jobs.sqlite.replaced-*[0-9]"))
    before = Store(aside)
    assert before.body("second") == content("second")
    before.close()


def test_backup_and_restore_refuse_what_they_cannot_do(tmp_path):
    with pytest.raises(FileError, match="there is no store"):
        backup_store(tmp_path / "jobs.sqlite", tmp_path / "backup")
    (tmp_path / "jobs.sqlite").write_bytes(b"no database" * 1000)
    with pytest.raises(FileError, match="cannot be copied"):
        backup_store(tmp_path / "jobs.sqlite", tmp_path / "backup")
    assert not (tmp_path / "backup").exists() and not list(tmp_path.glob(".backup*")), "nothing is left"
    with pytest.raises(FileError, match="is not a backup"):
        restore_store(tmp_path / "backup", tmp_path / "other.sqlite")
    own = Store(tmp_path / "good.sqlite")
    own.close()
    (tmp_path / "backup").mkdir()
    with pytest.raises(FileError, match="backup exists; give the name of a new folder"):
        backup_store(tmp_path / "good.sqlite", tmp_path / "backup")
    (tmp_path / "backup" / "jobs.sqlite-files").mkdir()
    (tmp_path / "backup" / "jobs.sqlite").write_bytes(b"no database" * 1000)
    with pytest.raises(FileError, match="cannot be restored"):
        restore_store(tmp_path / "backup", tmp_path / "good.sqlite")
    Store(tmp_path / "good.sqlite").close()
