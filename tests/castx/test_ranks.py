"""What the first rank does for all, one exit code, and no rank left waiting for a failed one."""

import pytest

from castx import ranks
from castx.errors import CaseError, MeshError


@pytest.mark.ranks
def test_all_ranks_end_with_the_largest_code(comm):
    verdicts = comm.Dup()
    assert ranks.common_code(verdicts, comm.rank) == comm.size - 1
    assert ranks.common_code(verdicts, 0) == 0
    verdicts.Free()


@pytest.mark.ranks
def test_ranks_that_have_all_failed_go_on_together(comm, capsys):
    verdicts = comm.Dup()
    ranks.end_unless_all_failed(verdicts, "no convergence")
    verdicts.Free()
    assert capsys.readouterr().err == ""


class Aborted(Exception):
    """Stands for the end of all processes."""


class Lonely:
    """A communicator whose other rank never comes."""

    size, rank = 2, 1

    def __init__(self, tests: int) -> None:
        self.tests = tests

    def Ibarrier(self):
        return self

    def Test(self):
        self.tests -= 1
        return self.tests < 0

    def allreduce(self, code, _):
        return max(code, 3)

    def Abort(self, code):
        raise Aborted(code)


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(ranks, "GRACE", 0.02)
    monkeypatch.setattr(ranks, "PAUSE", 0.001)


@pytest.mark.serial
def test_a_rank_that_failed_alone_ends_the_others(impatient, capsys):
    with pytest.raises(Aborted) as end:
        ranks.end_unless_all_failed(Lonely(10**9), "division by zero")
    assert end.value.args == (ranks.BUG,)
    text = "castx: rank 1 has failed alone and ends the others: division by zero\n"
    assert capsys.readouterr().err == text
    with pytest.raises(Aborted) as end:
        ranks.common_code(Lonely(10**9), 2)
    assert end.value.args == (2,)


@pytest.mark.serial
def test_a_rank_that_has_not_failed_waits_for_as_long_as_it_takes(impatient):
    """Fifty pauses are longer than the patience with a rank that has failed."""
    assert ranks.common_code(Lonely(50), 0) == 3


@pytest.mark.ranks
@pytest.mark.parametrize("kind", [CaseError, MeshError])
def test_what_the_first_rank_refuses_is_raised_on_all(comm, kind):
    calls = []

    def refuse():
        calls.append(comm.rank)
        raise kind("no")

    with pytest.raises(kind, match="no"):
        ranks.on_first_rank(comm, refuse)
    assert comm.allgather(calls) == [[0], *[[]] * (comm.size - 1)]


@pytest.mark.ranks
def test_what_the_first_rank_does_is_done_once(comm):
    calls = []
    ranks.on_first_rank(comm, lambda: calls.append(comm.rank))
    assert comm.allreduce(len(calls)) == 1


@pytest.mark.ranks
def test_what_the_first_rank_finds_is_known_to_all(comm):
    assert ranks.on_first_rank(comm, lambda: [comm.rank, comm.size]) == [0, comm.size]
