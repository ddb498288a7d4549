"""What is refused before anything is answered: foreign names, origins and users, large bodies.

A page of somebody else in the same browser can send requests to this server, and by a name of its
own that leads to 127.0.0.1 (DNS rebinding) even read the answers. The name in `Host` and the
`Origin` tell; the token, which never is a cookie, has only who started the server.
"""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from typing import Any
from urllib.parse import parse_qs

from castx.app.session import Session

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

LARGEST_BODY = 6_000_000
"""Bytes of a request: a case file as JSON."""
WINDOW, CLAIM = b"castx-window", "/api/claim"
HEADERS = {
    "cache-control": "no-store",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
}


class Guard:
    """Hands on to an application what its one user asks, and refuses everything else.

    Args:
        application: that answers.
        session: token and window of the user.
        port: of the server.
    """

    def __init__(self, application: Application, session: Session, port: int) -> None:
        self._application = application
        self._session = session
        self._hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, as ASGI has it."""
        if scope["type"] == "lifespan":
            await self._application(scope, receive, send)
            return
        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
            return
        headers = {bytes(key).lower(): bytes(value) for key, value in scope["headers"]}
        refusal = self.refusal(scope["method"], scope["path"], scope["query_string"], headers)
        if refusal is not None:
            await refuse(send, *refusal)
            return
        body = await whole_body(receive)
        if body is None:
            await refuse(send, 413, f"more than {LARGEST_BODY} bytes")
            return
        await self._application(scope, replayed(body, receive), with_headers(send))

    def refusal(
        self, method: str, path: str, query: bytes, headers: Mapping[bytes, bytes]
    ) -> tuple[int, str] | None:
        """Return why a request is refused, status and words; None: it is not."""
        host = headers.get(b"host", b"").decode("latin-1")
        if host not in self._hosts:
            return 421, "this server answers to 127.0.0.1 only"
        origin = headers.get(b"origin")
        if method not in ("GET", "POST"):
            return 405, "GET and POST only"
        if origin is None and method == "POST":
            return 403, "a request that changes something has to name its origin"
        if origin is not None and origin.decode("latin-1") != f"http://{host}":
            return 403, "a request of another page"
        if headers.get(b"sec-fetch-site", b"same-origin") != b"same-origin" and path != "/":
            return 403, "a request of another page"
        size = headers.get(b"content-length", b"0")
        if not size.isdigit() or int(size) > LARGEST_BODY:
            return 413, f"more than {LARGEST_BODY} bytes"
        return self._stranger(path, query, headers)

    def _stranger(
        self, path: str, query: bytes, headers: Mapping[bytes, bytes]
    ) -> tuple[int, str] | None:
        """Return why somebody may not ask this; None: he may."""
        if path.startswith("/show/"):
            known = self._session.shown(path.removeprefix("/show/")) is not None
            return None if known else (403, "this address is of an earlier start; open it anew")
        if path == "/":
            token = parse_qs(query.decode("latin-1")).get("token", [""])[0]
        else:
            token = headers.get(b"authorization", b"").decode("latin-1").removeprefix("Bearer ")
        if not self._session.knows(token):
            return 403, "open the address that castx app has printed; it is another one each time"
        window = headers.get(WINDOW, b"").decode("latin-1")
        if path not in ("/", CLAIM) and not self._session.works(window):
            return 409, "the page is used in another window"
        return None


async def whole_body(receive: Receive) -> bytes | None:
    """Return the body of a request; None: it is too large."""
    body = b""
    while True:
        message = await receive()
        if message["type"] != "http.request":
            return body
        body += message.get("body", b"")
        if len(body) > LARGEST_BODY:
            return None
        if not message.get("more_body", False):
            return body


def replayed(body: bytes, receive: Receive) -> Receive:
    """Return a source of a body that was read already, and of later messages."""
    given = False

    async def again() -> Message:
        nonlocal given
        if given:
            return await receive()
        given = True
        return {"type": "http.request", "body": body, "more_body": False}

    return again


def with_headers(send: Send) -> Send:
    """Return a sender that adds the headers of all answers."""

    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            own = {bytes(key).lower() for key, _ in message["headers"]}
            more = [(k.encode(), v.encode()) for k, v in HEADERS.items() if k.encode() not in own]
            message = {**message, "headers": [*message["headers"], *more]}
        await send(message)

    return sent


async def refuse(send: Send, status: int, why: str) -> None:
    """Send a refusal."""
    body = json.dumps({"error": why}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", b"%d" % len(body)),
               (b"connection", b"close")]  # fmt: skip
    start = {"type": "http.response.start", "status": status, "headers": headers}
    await with_headers(send)(start)
    await send({"type": "http.response.body", "body": body})
