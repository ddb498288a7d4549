"""A page served inside the process of the tests, and requests to it over its real port."""

from __future__ import annotations

import asyncio
import http.client
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import uvicorn

from castx.app.server import application
from castx.app.serving import QuietServer, listening
from castx.app.session import Session
from castx.app.workplace import Workplace

WINDOW = "a window"


class Served:
    """A page with its token and its port."""

    def __init__(self, folder: Path, port: int) -> None:
        self.folder, self.port, self.session = folder, port, Session()
        self.application, self.actions = application(Workplace(folder), self.session, port)
        self.address = f"http://127.0.0.1:{port}/?token={self.session.token}"

    def request(
        self, method: str, path: str, headers: dict[str, str], body: bytes = b""
    ) -> tuple[int, dict[str, str], bytes]:
        """Return status, headers and body of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            found = {key.lower(): value for key, value in answer.getheaders()}
            return answer.status, found, answer.read()
        finally:
            connection.close()

    def headers(self, **other: str) -> dict[str, str]:
        """Return the headers of the page's own requests, with others in place of some."""
        own = {
            "Host": f"127.0.0.1:{self.port}", "Origin": f"http://127.0.0.1:{self.port}",
            "Authorization": f"Bearer {self.session.token}", "Castx-Window": WINDOW,
        }  # fmt: skip
        return own | {key.replace("_", "-"): value for key, value in other.items()}

    def ask(self, action: str, **asked: Any) -> tuple[int, Any]:
        """Ask as the page does, and return status and answer."""
        body = json.dumps(asked).encode()
        status, _, answer = self.request("POST", f"/api/{action}", self.headers(), body)
        return status, json.loads(answer)


@contextmanager
def served(folder: Path, claim: bool = True) -> Iterator[Served]:
    """Serve the page of a folder in a thread."""
    with listening(0) as listener:
        page = Served(folder, listener.getsockname()[1])
        config = uvicorn.Config(page.application, log_config=None, lifespan="off")
        server = QuietServer(config)
        thread = threading.Thread(
            target=lambda: asyncio.run(server.serve(sockets=[listener])), daemon=True
        )
        thread.start()
        while not server.started:
            time.sleep(0.01)
        if claim:
            assert page.ask("claim", window=WINDOW)[1]["claimed"]
        yield page
        server.should_exit = True
        thread.join(10)
