"""How far to go along a Newton step, on functions of one part and on vectors of all ranks."""

from __future__ import annotations

import math

from petsc4py import PETSc

import numpy as np
import pytest

from castx.solvers.line_search import critical_part, shorten_step
from castx.solvers.snes import NonlinearSolver
from tests.castx.solvers.distributed import gathered, vector


@pytest.mark.serial
@pytest.mark.parametrize("root", [0.9, 0.3, 1e-3])
def test_the_part_at_which_the_work_vanishes(root):
    part = critical_part(lambda s: s**3 - root**3, -(root**3), enough=0.0, precision=1e-10)
    assert part == pytest.approx(root, rel=1e-6)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("end", "shortens"), [(-0.2, False), (0.0, False), (0.4, False), (0.6, True)]
)
def test_a_full_step_that_overshoots_little_is_left_as_it_is(end, shortens):
    """The work -1 + (1 + end) s of a step changes its sign at s = 1/(1 + end)."""
    part = critical_part(lambda s: -1.0 + (1.0 + end) * s, -1.0, enough=0.5, precision=1e-8)
    assert (part is not None) == shortens
    if part is not None:
        assert part == pytest.approx(1.0 / (1.0 + end), rel=1e-6)


@pytest.mark.serial
@pytest.mark.parametrize("overflow", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_step_whose_forces_overflow_goes_too_far(overflow, sign):
    def work(part: float) -> float:
        return sign * (part - 0.3) if part < 0.4 else overflow

    part = critical_part(work, -0.3 * sign, enough=0.5, precision=1e-8)
    assert part == pytest.approx(0.3, rel=1e-6)


@pytest.mark.serial
@pytest.mark.parametrize("start", [math.nan, math.inf])
def test_no_step_is_shortened_whose_work_before_it_is_no_number(start):
    """The forces may overflow where gaps have closed and nothing else has moved yet."""
    part = critical_part(lambda s: s - 0.3, start, enough=0.5, precision=1e-8)
    assert part is None


@pytest.mark.serial
@pytest.mark.parametrize("size, taken", [(1e-15, None), (1e-7, 1e-7)])
def test_a_step_of_which_nothing_would_be_left_is_taken(size, taken):
    """At a kink, where the forces of a full step are far larger than those at its start."""
    part = critical_part(lambda s: size - s, size, enough=0.5, precision=1e-8)
    assert part == (taken if taken is None else pytest.approx(taken, rel=1e-2))


@pytest.mark.serial
def test_the_work_is_found_once_for_each_part():
    asked = []

    def work(part: float) -> float:
        asked.append(part)
        return math.atan(20 * (part - 0.05))

    critical_part(work, math.atan(-1.0), enough=0.0, precision=1e-6)
    assert len(asked) == len(set(asked)) and 0.0 not in asked


def gradient(snes, x, F):
    """Fill the gradient of Σ (cosh(3 x) - 1)/9 + x²/200."""
    F.array[:] = np.sinh(3 * x.array_r) / 3 + x.array_r / 100


def stiff_start(comm):
    """Return a solver in its second iteration, unknowns, and a step that goes far too far."""
    values = np.linspace(0.1, 0.4, 3 * comm.size)
    x, y = vector(comm, values), vector(comm, 10.0 * values)
    matrix = PETSc.Mat().createConstantDiagonal(x.getSizes(), 1.0, comm=comm)
    solver = NonlinearSolver(
        "a test", "castx_test_search_", gradient, lambda *_: None, vector=x.duplicate(),
        matrix=matrix, options={},
    )  # fmt: skip
    return solver, x, y


@pytest.mark.ranks
def test_forces_do_no_work_on_a_shortened_step(comm):
    """All components of y point at the minimum, ten times as far away as they should."""
    solver, x, y = stiff_start(comm)
    whole = gathered(comm, y)
    now = x.duplicate()
    gradient(solver.snes, x, now)
    solver.snes.setIterationNumber(1)
    none = np.zeros(x.getLocalSize(), dtype=bool)
    assert shorten_step(gradient, x, y, solver.snes, now, none)
    parts = gathered(comm, y) / whole
    np.testing.assert_allclose(parts, parts[0], rtol=1e-14)
    assert parts[0] == pytest.approx(0.1, rel=0.02)
    solver.destroy()


def test_the_first_step_is_taken_in_full(comm):
    solver, x, y = stiff_start(comm)
    whole = gathered(comm, y)
    now = x.duplicate()
    gradient(solver.snes, x, now)
    none = np.zeros(x.getLocalSize(), dtype=bool)
    assert not shorten_step(gradient, x, y, solver.snes, now, none)
    np.testing.assert_array_equal(gathered(comm, y), whole)
    solver.destroy()


@pytest.mark.ranks
def test_what_goes_at_once_has_no_say_in_how_far_the_rest_goes(comm):
    """The force of a pair that opened falls to zero, though the others overshoot tenfold."""
    solver, x, y = stiff_start(comm)
    whole = gathered(comm, y)
    at_once, calls = np.zeros(x.getLocalSize(), dtype=bool), []
    at_once[0] = comm.rank == 0
    x.array[at_once], y.array[at_once] = 5.0, 5.0

    def with_row(snes, u, F):
        calls.append(u)  # ranks that assemble need each other
        gradient(snes, u, F)
        F.array[at_once] = 1e3 * u.array_r[at_once]

    now = x.duplicate()
    with_row(solver.snes, x, now)
    solver.snes.setIterationNumber(1)
    assert shorten_step(with_row, x, y, solver.snes, now, at_once)
    assert len(set(comm.allgather(len(calls)))) == 1
    parts = gathered(comm, y) / whole
    assert gathered(comm, y)[0] == 5.0
    np.testing.assert_allclose(parts[1:], parts[1], rtol=1e-14)
    assert parts[1] == pytest.approx(0.1, rel=0.02)
    solver.destroy()
