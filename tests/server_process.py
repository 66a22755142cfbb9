"""A real server in a process of its own."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from contextlib import contextmanager

from compas_cgc.client import Client


class Running:
    """A server process and a client of it."""

    def __init__(self, process, url, key):
        self.process, self.url, self.key = process, url, key
        self.client = Client(url, key, retries=2)


@contextmanager
def running_server(store, key=None, workers=2, port=0):
    command = [sys.executable, "-m", "compas_cgc", "serve", "--port", str(port), "--workers", str(workers), "--store", str(store)]
    command += ["--key", key] if key else []
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said, url = [], None
    try:
        for line in process.stdout:
            said.append(line)
            found = re.search(r"is at (http://\S+)", line)
            url = found.group(1) if found else url
            if line.startswith("ready"):
                break
        assert url, "".join(said)
        # Nobody reads on, and a full pipe would stop the server.
        threading.Thread(target=process.stdout.read, daemon=True).start()
        yield Running(process, url, key)
    finally:
        process.terminate()
        try:
            process.wait(10)
        finally:
            process.kill()
