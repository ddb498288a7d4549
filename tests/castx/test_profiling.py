"""Cost of the parts of a run against a clock, and against operations that are counted by hand."""

from __future__ import annotations

import time

from petsc4py import PETSc

import numpy as np
import pytest

from castx.profiling import Profile, RunPart, booked_as

SHORT, LONG = 0.02, 0.06
SIZE, SCALINGS = 100_000, 500
FLOPS = SIZE * SCALINGS
"""Of one call, so many that the six digits of PETSc's log tell them after the tests before."""
ROUNDING = 0.05
"""Share of a time or a number of operations that may lie beyond these digits."""


@booked_as(RunPart.SET_UP)
def inner():
    time.sleep(SHORT)


@booked_as(RunPart.SOLVE)
def outer(vector, fail=False):
    time.sleep(LONG)
    inner()
    for _ in range(SCALINGS):
        vector.scale(-1.0)
    if fail:
        raise ValueError("on the way")
    return "done"


@pytest.fixture
def vector(comm):
    made = PETSc.Vec().createMPI((SIZE, PETSc.DECIDE), comm=comm)
    made.set(1.0)
    yield made
    made.destroy()


@pytest.mark.ranks
def test_each_part_has_its_own_time_without_what_begins_inside(comm, vector):
    profile, begin = Profile(comm), time.perf_counter()
    assert outer(vector) == "done"
    with pytest.raises(ValueError, match="on the way"):
        outer(vector, fail=True)
    passed = time.perf_counter() - begin
    costs = profile.costs()
    solve, set_up = costs[RunPart.SOLVE], costs[RunPart.SET_UP]
    assert (1.0 - ROUNDING) * 2 * LONG <= solve.mean_time <= solve.time
    assert (1.0 - ROUNDING) * 2 * SHORT <= set_up.mean_time <= set_up.time
    both = solve.mean_time + set_up.mean_time
    assert both <= (1.0 + ROUNDING) * comm.allreduce(passed) / comm.size
    assert costs[RunPart.SOLVE].flops == pytest.approx(2 * FLOPS * comm.size, rel=ROUNDING)
    assert costs[RunPart.HEAT].time == costs[RunPart.HEAT].flops == 0.0


@pytest.mark.ranks
def test_a_profile_counts_from_its_beginning(comm, vector):
    Profile(comm)
    outer(vector)
    later = Profile(comm)
    assert later.costs()[RunPart.SOLVE].flops == 0.0
    outer(vector)
    assert later.costs()[RunPart.SOLVE].flops == pytest.approx(FLOPS * comm.size, rel=ROUNDING)


@booked_as(RunPart.CONTACT)
def exchange(vector, scatter, received, times):
    for _ in range(times):
        scatter.scatter(vector, received)
        vector.dot(vector)


@pytest.mark.ranks
def test_messages_and_sums_between_ranks(comm, vector):
    """Each rank takes the first entries of the next one: one message."""
    first, _ = vector.getOwnershipRange()
    numbers, times = 1000, 50
    wanted = (first + SIZE) % vector.size + np.arange(numbers, dtype=PETSc.IntType)
    entries = PETSc.IS().createGeneral(wanted, comm=comm)
    received = PETSc.Vec().createSeq(numbers)
    scatter = PETSc.Scatter().create(vector, entries, received, None)
    profile = Profile(comm)
    exchange(vector, scatter, received, times)
    cost = profile.costs()[RunPart.CONTACT]
    several = comm.size > 1
    messages = times * comm.size if several else 0
    assert cost.messages == pytest.approx(messages, rel=ROUNDING)
    assert cost.sent == pytest.approx(8 * numbers * messages, rel=ROUNDING)
    assert cost.reductions == pytest.approx(times if several else 0, rel=ROUNDING)
    for item in (entries, received, scatter):
        item.destroy()
