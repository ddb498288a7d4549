import numpy as np
import pytest

from castx.errors import ConvergenceError
from castx.proof.verification.verdict import verified
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

pytestmark = pytest.mark.serial

LINE = np.linspace(0.0, 1.0, 5)
LEVELS = (Resolution(0.4), Resolution(0.2), Resolution(0.1))


def made(order=2.0, tolerance=0.02, refined="size", fails_below=0.0):
    """Return a verification whose error is the size to a power."""

    def run(level, comm):
        if level.size < fails_below:
            raise ConvergenceError("no solution")
        error = level.size**order
        curve = Curve("c", LINE, LINE + error, LINE, LINE)
        answer = Answer.relative("y", 1.0 + error, 1.0, "m", tolerance)
        return Outcome((answer,), error, Comparison("x", "y", (curve,)))

    return Verification("V98", "made up", "y = x", "here", run, LEVELS, LEVELS[:2], refined, "y")


def test_an_error_within_tolerance_that_falls_is_met(comm):
    verdict = verified(made(), comm)
    assert verdict.met and verdict.order == pytest.approx(2.0)
    assert [run.order for run in verdict.runs] == [None, *(pytest.approx(2.0),) * 2]
    assert verdict.seconds >= 0.0
    assert verdict.worst is not None and verdict.worst.error == pytest.approx(0.01)


def test_a_missed_tolerance_is_missed(comm):
    verdict = verified(made(tolerance=0.009), comm)
    assert verdict.falls and not verdict.met


def test_an_error_that_falls_too_slowly_is_missed(comm):
    verdict = verified(made(order=0.5, tolerance=1.0), comm)
    assert not verdict.falls and not verdict.met
    assert verified(made(order=0.5, tolerance=1.0, refined="nothing"), comm).met


def test_a_short_check_allows_more_in_proportion(comm):
    verdict = verified(made(tolerance=0.0199), comm, quick=True)  # the error is 0.04
    assert len(verdict.runs) == 2 and verdict.allowance == pytest.approx(2.0)
    assert not verdict.met
    assert verified(made(tolerance=0.0201), comm, quick=True).met


def test_a_run_that_does_not_converge_is_missed_and_ends_nothing(comm):
    verdict = verified(made(fails_below=0.15), comm)
    assert len(verdict.runs) == 2 and verdict.failure == "no solution" and not verdict.met
    none = verified(made(fails_below=1.0), comm)
    assert none.runs == () and none.worst is None and none.order is None and not none.met
