"""The token of a page, its one window, its tickets."""

import pytest

from castx.app.session import ALIVE, Session

pytestmark = pytest.mark.serial


class Clock:
    now = 1000.0

    def __call__(self):
        return self.now


def test_tokens_are_of_this_start_alone():
    first, second = Session(), Session()
    assert first.knows(first.token) and not first.knows(second.token)
    assert not first.knows("") and not first.knows(first.token[:-1]) and not first.knows("é")
    assert len(first.token) >= 43  # 256 bits


def test_one_window_works_until_it_is_silent_closed_or_another_one_takes_over():
    clock = Clock()
    session = Session(clock)
    assert not session.works("") and not session.works("a")
    assert session.claim("a") and session.works("a")
    assert not session.claim("b") and not session.works("b")
    assert session.claim("b", force=True) and not session.works("a")
    clock.now += ALIVE - 1.0
    assert session.works("b")
    clock.now += ALIVE - 1.0
    assert not session.claim("a")
    clock.now += 2.0
    assert session.claim("a")
    session.leave("b")
    assert not session.claim("b")
    session.leave("a")
    assert session.works("a")  # a window that was loaded anew
    session.leave("a")
    assert session.claim("b")


def test_a_ticket_is_of_one_file():
    session = Session()
    ticket = session.ticket("a/report.html")
    assert (
        session.shown(ticket) == "a/report.html" == session.shown(session.ticket("a/report.html"))
    )
    assert session.shown("") is None and session.shown("a/report.html") is None
    assert session.ticket("b/report.html") != ticket
