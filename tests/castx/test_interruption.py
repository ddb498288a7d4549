"""A signal to one rank stops all of them at the next check, and handlers are put back."""

import os
import signal

import pytest

from castx.interruption import Interruption


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_on_one_rank_stops_all(comm, number):
    noted = []
    before = signal.getsignal(number)
    with Interruption(comm, lambda: noted.append(True)) as interruption:
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
    clock = iter([10.0, 10.5, 11.5])
    monkeypatch.setattr("castx.interruption.time.monotonic", lambda: next(clock))
    with Interruption(comm, lambda: None), pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
        raise AssertionError("the third signal did not stop anything")
