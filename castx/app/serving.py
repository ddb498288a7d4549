"""The start and the end of the page: its port, its address, its signals, the run under way."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import uvicorn

from castx.app.commands import Commands
from castx.app.server import application
from castx.app.session import Session
from castx.app.workplace import Workplace, claimed
from castx.errors import CaseError

ADDRESS = "127.0.0.1"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
MOST_CONNECTIONS = 64
Say = Callable[[str], None]


class QuietServer(uvicorn.Server):
    """A server that leaves signals to `ending`."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Catch none."""
        yield


def serve(folder: Path, port: int, browser: bool, say: Say) -> None:
    """Serve the page of a folder until a signal comes; the present folder becomes that one.

    Args:
        folder: with the case files.
        port: 0: any that is free.
        browser: whether to open one.
        say: gets the address and what goes on.

    Raises:
        CaseError: the folder is none or has a page already, or the port is taken.
    """
    workplace = Workplace(folder)
    with claimed(workplace.folder), listening(port) as listener:
        os.chdir(workplace.folder)  # results lie where the command line would put them
        session, port = Session(), listener.getsockname()[1]
        guarded, actions = application(workplace, session, port)
        config = uvicorn.Config(
            guarded, log_config=None, access_log=False, lifespan="off", server_header=False,
            limit_concurrency=MOST_CONNECTIONS, timeout_graceful_shutdown=2,
        )  # fmt: skip
        server = QuietServer(config)
        address = f"http://{ADDRESS}:{port}/?token={session.token}"
        say(f"castx app: {workplace.folder}")
        say(f"open this address in a browser of this computer, nobody else's:\n{address}")
        say("Ctrl-C ends it; a run under way stops after its step")
        if browser:
            webbrowser.open(address)
        with ending(server, actions.commands, say):
            asyncio.run(server.serve(sockets=[listener]))
            end(actions.commands, say)


@contextmanager
def listening(port: int) -> Iterator[socket.socket]:
    """Open a port of this computer alone.

    Raises:
        CaseError: it is taken.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((ADDRESS, port))
            listener.listen(MOST_CONNECTIONS)  # the address works from when it is printed
        except OSError as error:
            raise CaseError(
                f"--port {port}: {error.strerror}; leave it out and a free one is taken"
            ) from None
        yield listener


@contextmanager
def ending(server: uvicorn.Server, commands: Commands, say: Say) -> Iterator[None]:
    """End a server at the first signal, and at the second one the command that it waits for."""

    def note(number: int, frame: FrameType | None) -> None:
        if not server.should_exit:
            server.should_exit = True
        elif number == signal.SIGINT and commands.last is not None and not commands.last.ended:
            say("ended at once; the last checkpoint is on disk")
            commands.last.kill()

    before: dict[int, Any] = {number: signal.signal(number, note) for number in SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def end(commands: Commands, say: Say) -> None:
    """Stop the command under way, and wait for it."""
    last = commands.last
    if last is None or last.ended:
        return
    say(f"{last.text} stops after its step, its state is on disk then; Ctrl-C again: at once")
    last.stop()
    last.wait()
    say(f"{last.text} has ended with exit code {last.code}")
