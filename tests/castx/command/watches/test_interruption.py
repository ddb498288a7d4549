"""A signal to one rank stops all of them at the next check, and handlers are put back."""

import os
import signal
from types import SimpleNamespace

import pytest

from castx.command.watches.interruption import Interruption
from castx.errors import Interrupted


@pytest.mark.ranks
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1])
def test_a_signal_on_one_rank_stops_all(comm, number):
    noted = []
    before = signal.getsignal(number)
    with Interruption(comm) as interruption:
        interruption.at_once = lambda: noted.append(True)
        interruption.check()
        if comm.rank == comm.size - 1:
            os.kill(os.getpid(), number)
            os.kill(os.getpid(), number)
        with pytest.raises(KeyboardInterrupt):
            interruption.check()
    assert len(noted) == (comm.rank == comm.size - 1)
    assert signal.getsignal(number) is before


@pytest.mark.serial
def test_asked_again_later_it_stops_at_once(comm, monkeypatch):
    clock = iter([0.0, 10.0, 10.5, 11.5])
    monkeypatch.setattr("castx.command.watches.interruption.time.monotonic", lambda: next(clock))
    with Interruption(comm), pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
        raise AssertionError("the third signal did not stop anything")


@pytest.mark.ranks
def test_the_time_limit_leaves_room_for_one_more_try(comm, monkeypatch):
    """Preparations of 9 s and tries of 1, 3 and 1 s: after 14 s another of 3 s passes 16.5 s."""
    clock = iter([10.0, 19.0, 20.0, 23.0, 24.0])
    fake = SimpleNamespace(monotonic=lambda: next(clock))
    monkeypatch.setattr("castx.command.watches.interruption.time", fake)
    with Interruption(comm, time_limit=16.5) as interruption:
        interruption.check()
        for _ in range(2):
            interruption.after_try()
        with pytest.raises(Interrupted, match=r"time limit of 16\.5 s leaves no time for a step"):
            interruption.after_try()


@pytest.mark.ranks
def test_one_try_is_made_however_short_the_limit(comm):
    with Interruption(comm, time_limit=1e-6) as interruption:
        interruption.check()
        with pytest.raises(Interrupted, match="time limit"):
            interruption.after_try()
