"""Under MPICH: free the solvers that tests leave behind, before communicators run out.

MPICH has 2048 communicators for each process, and DOLFINx takes two for every vector. A solver that
is left behind is never collected, since PETSc holds its callbacks where Python does not see them;
with them it keeps a whole problem.
"""

from __future__ import annotations

import functools
import gc
from collections.abc import Generator
from typing import Any

from mpi4py import MPI

import pytest

from castx.solvers.snes import NonlinearSolver

made: list[NonlinearSolver] = []


def are_scarce() -> bool:
    """Return whether the MPI in use has few communicators."""
    return MPI.get_vendor()[0] == "MPICH"


def pytest_configure() -> None:
    """Note every solver that is made."""
    construct = NonlinearSolver.__init__

    @functools.wraps(construct)
    def noted(self: NonlinearSolver, *arguments: Any, **options: Any) -> None:
        construct(self, *arguments, **options)
        made.append(self)

    NonlinearSolver.__init__ = noted  # type: ignore[method-assign]


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef[Any]) -> Generator[None, object, object]:
    """Keep what tests share."""
    before = len(made)
    result = yield
    if fixturedef.scope != "function":
        del made[before:]
    return result


@pytest.hookimpl(wrapper=True, trylast=True)
def pytest_runtest_teardown() -> Generator[None, object, object]:
    """Free what the test has made and left; collective, as tests are."""
    result = yield
    for solver in made:
        if solver._verdicts != MPI.COMM_NULL:
            solver.destroy()
    made.clear()
    gc.collect()
    return result
