"""A client that a generator makes of the description: results and errors are typed objects, not dicts."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ...support.server_process import PATIENCE
from ...support.server_process import running_server
from ...support.shapes import grid

FOLDERS = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
TOOL = shutil.which("openapi-python-client", path=FOLDERS)
SCRIPT = """
import json, sys, time
from made import Client
from made.api.default import get_job, get_result, health, list_jobs, submit_job, version
from made.models import GetResultFormat, Health, Job, JobList, Packed, Problem, Request, RequestSupportsType0, Result, Submitted, Version

url, asked = json.loads(sys.stdin.read())
client = Client(base_url=url)
assert isinstance(health.sync(client=client), Health) and isinstance(version.sync(client=client), Version)
sent = submit_job.sync(client=client, body=Request.from_dict(asked))
assert isinstance(sent, Submitted)
while (job := get_job.sync(sent.id, client=client, wait=5.0)).state.value in ("queued", "running"):
    assert isinstance(job, Job)
assert job.state.value == "succeeded" and job.progress == 1.0 and job.position is None, job
found = get_result.sync(sent.id, client=client)
assert isinstance(found, Result) and found.status.value == "converged" and found.report.verdict.word.value == "fair"
assert len(found.vertices) == len(asked["vertices"]) and found.report.regions[0].target == asked["targets"]
packed = get_result.sync(sent.id, client=client, format_=GetResultFormat.PACKED)
assert isinstance(packed, Result) and isinstance(packed.vertices, Packed) and packed.vertices.shape == [len(found.vertices), 3]
wrong = submit_job.sync(client=client, body=Request.from_dict({**asked, "targets": [1.0]}))
assert isinstance(wrong, Problem) and "'targets' has 1 numbers" in wrong.message and wrong.errors == [wrong.message]
gone = get_result.sync("no-such-job", client=client)
assert isinstance(gone, Problem) and "there is no job" in gone.message
listed = list_jobs.sync(client=client, limit=1)
assert isinstance(listed, JobList) and listed.total == 1 and isinstance(listed.jobs[0], Job)
print(json.dumps(found.vertices))
"""


@pytest.mark.nightly
@pytest.mark.skipif(TOOL is None, reason="openapi-python-client is not there to make a client: pip install openapi-python-client")
def test_a_generated_client_solves_polls_and_reads_result_and_error_as_typed_objects(tmp_path):
    vertices, faces = grid(6, 6.0)
    asked = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.01}
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server:
        (tmp_path / "openapi.json").write_bytes(server.ask("GET", "/openapi.json")[2])
        command = [TOOL, "generate", "--path", "openapi.json", "--output-path", "made", "--meta", "none"]
        said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
        assert said.returncode == 0 and "Problem" not in said.stdout, said.stdout
        # What the generator needs stands beside it, perhaps in an environment of its own.
        python = Path(TOOL).parent / ("python.exe" if sys.platform == "win32" else "python")
        run = {"input": json.dumps([server.url, asked]), "cwd": tmp_path, "capture_output": True, "text": True, "timeout": PATIENCE}
        done = subprocess.run([str(python), "-c", SCRIPT], **run)
        assert done.returncode == 0, done.stderr
        id = server.client.jobs()[0]["id"]
        assert json.loads(done.stdout) == server.client.result(id)["vertices"], "and nothing is lost on the way"
