"""The server of the page: its one address, its actions, and files in tabs of their own."""

from __future__ import annotations

import json
import logging
from collections.abc import Callable
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from castx.app.actions import Actions
from castx.app.guard import Application, Guard
from castx.app.page import page
from castx.app.session import Session
from castx.app.text.arguments import Asked
from castx.app.workplace import Workplace
from castx.errors import CaseError, ConvergenceError, MeshError, StorageError

log = logging.getLogger(__name__)
REFUSALS = (CaseError, MeshError, StorageError, ConvergenceError)
SANDBOXED = (
    "sandbox allow-scripts; default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; frame-ancestors 'none'"
)
"""A report may run its own scripts, with no origin: it reaches neither this server nor others."""


def application(workplace: Workplace, session: Session, port: int) -> tuple[Application, Actions]:
    """Return the guarded application of a page, and its actions.

    Args:
        workplace: the folder.
        session: of the user.
        port: of the server.
    """
    actions = Actions(workplace, session)

    async def front(request: Request) -> Response:
        text, policy = page()
        return HTMLResponse(text, headers={"content-security-policy": policy})

    async def show(request: Request) -> Response:
        name = session.shown(request.path_params["ticket"]) or ""
        try:
            path = workplace.path(name)
        except CaseError as error:
            return JSONResponse({"error": str(error)}, 400)
        if not path.is_file():
            return JSONResponse({"error": f"{name} is gone"}, 404)
        return FileResponse(path, headers={"content-security-policy": SANDBOXED})

    routes = [
        Route("/", front, methods=["GET"]),
        Route("/show/{ticket}", show, methods=["GET"]),
        *(Route(f"/api/{name}", answering(act), methods=["POST"])
          for name, act in actions.known.items()),
    ]  # fmt: skip
    return Guard(Starlette(routes=routes), session, port), actions


def answering(act: Callable[[Asked], dict[str, Any]]) -> Callable[[Request], Any]:
    """Return a handler that answers by an action, and refuses in words."""

    async def answer(request: Request) -> Response:
        try:
            asked = json.loads(await request.body())
        except (ValueError, RecursionError):
            return JSONResponse({"error": "the page has sent no JSON"}, 400)
        if not isinstance(asked, dict):
            return JSONResponse({"error": "the page has sent no table"}, 400)
        try:
            return JSONResponse(await run_in_threadpool(act, asked))
        except REFUSALS as error:
            return JSONResponse({"error": str(error)}, 400)
        except Exception:
            log.exception("the page has asked for something that castx failed at")
            return JSONResponse({"error": "an error inside castx; the terminal shows it"}, 500)

    return answer
