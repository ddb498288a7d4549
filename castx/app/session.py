"""Who may use the page: whoever has its token, in one window at a time."""

from __future__ import annotations

import hmac
import secrets
import threading
import time
from collections.abc import Callable

ALIVE = 90.0
"""Time after its last word in which a window counts as open [s]; browsers let hidden ones speak
once a minute."""


class Session:
    """The token of this start, the window that works, and tickets for files it may show.

    Args:
        clock: seconds that only grow.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.token = secrets.token_urlsafe(32)
        self._clock = clock
        self._window = ""
        self._heard = 0.0
        self._tickets: dict[str, str] = {}
        self._lock = threading.Lock()

    def knows(self, token: str) -> bool:
        """Return whether a token is that of this start, in a time that does not tell how near."""
        return hmac.compare_digest(token.encode(), self.token.encode())

    def claim(self, window: str, force: bool = False) -> bool:
        """Let a window work, unless another one does; return whether it may.

        Args:
            window: what it calls itself.
            force: take the page away from the other one, which is refused from then on.
        """
        with self._lock:
            alive = self._window and self._clock() - self._heard < ALIVE
            if alive and self._window != window and not force:
                return False
            self._window, self._heard = window, self._clock()
            return True

    def works(self, window: str) -> bool:
        """Return whether a window is the one that works, and note that it lives."""
        with self._lock:
            if not window or window != self._window:
                return False
            self._heard = self._clock()
            return True

    def leave(self, window: str) -> None:
        """Let a window go that was closed."""
        with self._lock:
            if window == self._window:
                self._heard = -ALIVE + self._clock()

    def ticket(self, name: str) -> str:
        """Return the ticket with which a tab of its own may show a file."""
        with self._lock:
            for ticket, shown in self._tickets.items():
                if shown == name:
                    return ticket
            ticket = secrets.token_urlsafe(32)
            self._tickets[ticket] = name
            return ticket

    def shown(self, ticket: str) -> str | None:
        """Return the name of the file of a ticket; None: there is none."""
        with self._lock:
            return self._tickets.get(ticket)
