"""Passes of a step: when they agree, go round, or are given up."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from castx.coupling.agreement import ROUNDED
from castx.coupling.passes import HOPELESS, SETTLED, Passes
from castx.coupling.relaxation import ROUND
from castx.solvers.diagnosis import CIRCLING, COUPLING

pytestmark = pytest.mark.serial

THERMAL: Any = SimpleNamespace(
    largest_of_solid_fraction=lambda: 0.4, largest_of_mean_solid_fraction=lambda: 0.1
)


def after(*changes: float, tolerance: float = 1e-3, at_rest: bool = False) -> Passes:
    passes = Passes(tolerance, lambda change: False)
    for change in changes:
        passes.add(change, at_rest)
    return passes


def test_they_agree_within_the_tolerance():
    assert after(0.5, 0.99e-3).agree and not after(0.5, 1.01e-3).agree


def test_rounding_is_agreement_once_no_force_moves_or_passes_go_round():
    last, tight = 0.9 * ROUNDED, {"tolerance": 1e-12}
    assert not after(0.5, last, **tight).agree
    assert after(0.5, last, at_rest=True, **tight).agree
    stuck = after(*[last] * 2 * ROUND, **tight)
    assert stuck.go_round and stuck.agree
    assert not after(*[2.0 * ROUNDED] * 2 * ROUND, at_rest=True, **tight).agree


def test_changes_count_passes_and_those_that_say_how_hard_it_was():
    found = after(0.5, 2.0 * SETTLED, 0.5 * SETTLED, 0.1 * SETTLED).changed(3.0, THERMAL, 0.2)
    assert (found.passes, found.settled) == (4, 3)
    assert (found.temperature, found.solid_fraction, found.mean_solid_fraction) == (3.0, 0.4, 0.1)
    assert found.skin == 0.2 and found.agreed


def test_a_step_is_given_up_after_passes_one_after_the_other_that_change_too_much():
    verdicts = iter([*[True] * (HOPELESS - 1), False, *[True] * HOPELESS])
    passes = Passes(1e-3, lambda change: next(verdicts))
    passes.add(0.5, at_rest=False)
    change = passes.changed(3.0, THERMAL, 0.2)
    for _ in range(2 * HOPELESS - 1):
        assert passes.given_up(change) is None
    given_up = passes.given_up(change)
    assert given_up is not None and not given_up.agreed and given_up.skin == change.skin


def test_a_failure_says_whether_more_passes_would_help():
    few, stuck = after(0.5, 0.2).failure(), after(*[0.3] * 2 * ROUND).failure()
    assert few.problem == COUPLING and "in 2 passes (coupling.passes)" in str(few)
    assert "0.2 of their values" in str(few)
    assert stuck.problem == CIRCLING and "coupling.passes" not in str(stuck)
    assert f"in {2 * ROUND} passes" in str(stuck) and "0.3 of their values" in str(stuck)
