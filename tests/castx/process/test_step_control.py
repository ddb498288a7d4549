"""Step control with plain numbers: growth, cuts, landing on stops and on the end."""

import math

import pytest

from castx.coupling.change import StepChange, StepErrors
from castx.errors import ConvergenceError
from castx.process.step_control import (
    CUT,
    GROWTH,
    SAFETY,
    SHRINKAGE,
    SMALLEST_CUT,
    ErrorBounds,
    StepControl,
    StepSettings,
)

pytestmark = pytest.mark.serial

CAUSE = ConvergenceError("the heat problem did not converge")


def control(**changes) -> StepControl:
    settings = {
        "end": 100.0, "first": 1.0, "largest": 8.0, "smallest": 0.1, "temperature_change": 20.0,
    }  # fmt: skip
    return StepControl(StepSettings(**{**settings, **changes}))


def stops(every: float | None, end: float) -> tuple[float, ...]:
    """Return the multiples of a time before the end."""
    return () if every is None else tuple(n * every for n in range(1, math.ceil(end / every)))


def changed(temperature: float, solid_fraction: float = 0.0, skin: float = 0.0) -> StepChange:
    """Return the change of the fastest node [K], of the fastest body and of the fastest skin."""
    return StepChange(1, temperature, 1.0, solid_fraction, skin)


def run(steps: StepControl, change: float = 1.0, time: float = 0.0) -> list[float]:
    """Return the steps to the end of the run if every step changes the temperature alike."""
    taken = []
    while not steps.finished(time):
        taken.append(steps.propose(time))
        steps.accept(taken[-1], changed(change), easy=True)
        time += taken[-1]
    return taken


def next_after(steps: StepControl, change: float, easy: bool = True) -> float:
    step = steps.propose(0.0)
    steps.accept(step, changed(change), easy)
    return steps.propose(step) / step


def test_first_step():
    assert control(first=0.3).propose(0.0) == 0.3


def test_calm_steps_grow_by_the_bound():
    assert next_after(control(), change=1e-3) == pytest.approx(GROWTH)
    assert next_after(control(), change=0.0) == pytest.approx(GROWTH)


def test_violent_steps_shrink_by_the_bound():
    assert next_after(control(), change=1e4) == pytest.approx(SHRINKAGE)


def test_steps_aim_at_the_wanted_change():
    assert next_after(control(), change=16.0) == pytest.approx(SAFETY * 20.0 / 16.0)
    assert next_after(control(temperature_change=10.0), 16.0) == pytest.approx(SAFETY * 10 / 16)


def test_steps_aim_at_the_wanted_solid_fraction_where_no_temperature_changes():
    steps = control(solid_fraction_change=0.05)
    steps.accept(steps.propose(0.0), changed(0.0, 0.06), True)
    assert steps.propose(1.0) == pytest.approx(SAFETY * 0.05 / 0.06)
    steps.accept(steps.propose(1.0), changed(25.0, 0.06), True)
    assert steps.propose(2.0) == pytest.approx((SAFETY * 0.05 / 0.06) * SAFETY * 20.0 / 25.0)


def test_steps_aim_at_the_wanted_growth_of_a_skin():
    steps = control(skin_change=0.25)
    assert next_after(steps, 0.0) == pytest.approx(GROWTH)
    steps.accept(2.0, changed(0.0, 0.0, 0.4), True)
    assert steps.propose(4.0) == pytest.approx(2.0 * SAFETY * 0.25 / 0.4)


@pytest.mark.parametrize("excess", [(41.0, 0.0), (0.0, 0.101), (0.0, 0.0, 0.501)])
def test_a_step_that_changes_far_too_much_is_cut(excess):
    wanted = {"solid_fraction_change": 0.05, "reject_above": 2.0, "skin_change": 0.25}
    steps = control(first=0.5, **wanted)
    assert not steps.exceeds(4.0, changed(39.0, 0.099, 0.499)) and steps.propose(0.0) == 0.5
    assert steps.is_too_much(4.0, changed(*excess)) and steps.propose(0.0) == 0.5
    assert not steps.is_too_much(4.0, changed(39.0))
    assert not steps.is_too_much(0.5, changed(*excess))
    assert not control(fixed=4.0, **wanted).is_too_much(4.0, changed(*excess))
    assert steps.exceeds(4.0, changed(*excess)) and steps.propose(0.0) == pytest.approx(CUT * 4.0)
    steps.accept(2.0, changed(1.0), easy=True)
    assert steps.propose(2.0) == pytest.approx(2.0), "it does not grow at once"
    assert not steps.exceeds(0.5, changed(*excess)), "the case itself says this step"
    steps.exceeds(0.6, changed(*excess))
    assert steps.propose(2.0) == 0.5, "never below the first one"
    assert not control(fixed=4.0, **wanted).exceeds(4.0, changed(*excess))
    assert not control(first=0.5, solid_fraction_change=0.05).exceeds(4.0, changed(*excess))


@pytest.mark.parametrize("excess", [0.0, 5e-7, 1e-6])
def test_a_first_step_that_lands_on_a_stop_is_not_taken_again_for_ever(excess):
    steps, tries = control(first=1.0, end=1.0 + excess, reject_above=2.0), 0
    while steps.exceeds(steps.propose(0.0), changed(1e6, 0.0)):
        tries += 1
        assert tries < 10
    assert steps.propose(0.0) == 1.0 + excess


def test_steps_below_the_first_one_are_kept():
    """They have failed before: a change that is too large does not make them smaller still."""
    steps = control(first=1.0, reject_above=2.0)
    steps.reject(steps.propose(0.0), CAUSE)
    assert not steps.exceeds(0.5, changed(1e6, 0.0)) and steps.propose(0.0) == 0.5


def test_hard_steps_do_not_grow():
    assert next_after(control(), change=1e-3, easy=False) == pytest.approx(1.0)
    assert next_after(control(), change=36.0, easy=False) == pytest.approx(0.5)


def test_size_stays_within_bounds():
    calm = run(control(end=200.0))
    assert max(calm) == 8.0
    steps = control()
    for _ in range(20):
        steps.accept(steps.propose(0.0), changed(1e6), easy=True)
    assert steps.propose(0.0) == pytest.approx(0.1)


@pytest.mark.parametrize("end", [7.0, 10.0, 100.0, 33.3])
@pytest.mark.parametrize("every", [None, 5.0, 3.0, 0.7])
def test_steps_land_on_stops_and_the_end(end, every):
    time, times, steps = 0.0, [], control(end=end, stops=stops(every, end))
    while not steps.finished(time):
        step = steps.propose(time)
        steps.accept(step, changed(1.0), easy=True)
        time += step
        times.append(time)
    assert times[-1] == pytest.approx(end, rel=1e-12)
    for stop in stops(every, end):
        assert min(abs(t - stop) for t in times) < 1e-9 * end


@pytest.mark.parametrize("every", [None, 5.0, 6.25])
def test_no_slivers(every):
    """Before a stop the rest is divided evenly: no step is below half the size it could have."""
    steps = control(end=50.0, stops=stops(every, 50.0), largest=3.0, first=3.0)
    time, size = 0.0, 3.0
    while not steps.finished(time):
        step = steps.propose(time)
        assert 0.5 * size - 1e-9 <= step <= size * (1 + 1e-5)
        steps.accept(step, changed(1.0), easy=True)
        time += step


def test_step_cut_by_a_stop_does_not_slow_the_next():
    steps = control(first=4.0, stops=(5.0, 10.0))
    assert steps.propose(0.0) == 2.5
    steps.accept(2.5, changed(1.0), easy=True)
    assert steps.propose(0.0) == pytest.approx(2.5)  # from 4 s still: the half of 5 s
    steps.accept(2.5, changed(1.0), easy=True)
    assert steps.propose(5.0) == pytest.approx(2.5)
    assert control(first=4.0, largest=4.0).propose(5.0) == 4.0


def test_rejected_step_is_cut():
    steps = control()
    step = steps.propose(0.0)
    steps.reject(step, CAUSE)
    assert steps.propose(0.0) == pytest.approx(CUT * step)


def test_step_after_a_cut_does_not_grow_at_once():
    steps = control()
    steps.reject(steps.propose(0.0), CAUSE)
    step = steps.propose(0.0)
    steps.accept(step, changed(1e-3), easy=True)
    assert steps.propose(step) == pytest.approx(step)
    steps.accept(step, changed(1e-3), easy=True)
    assert steps.propose(2 * step) == pytest.approx(GROWTH * step)


def test_cuts_end_at_the_smallest_step():
    steps, tried = control(), []
    with pytest.raises(ConvergenceError, match=r"smallest step of 0\.1 s.*heat problem") as caught:
        for _ in range(50):
            tried.append(steps.propose(0.0))
            steps.reject(tried[-1], CAUSE)
    assert caught.value.__cause__ is CAUSE
    assert tried == pytest.approx([1.0, 0.5, 0.25, 0.125, 0.1])


def test_fixed_steps():
    assert run(control(end=1.0, fixed=0.1), change=1e5) == pytest.approx([0.1] * 10)
    assert run(control(end=1.0, fixed=0.3), change=1e5) == pytest.approx([0.3] * 3 + [0.1])


def test_fixed_steps_are_cut_and_recover():
    steps = control(end=100.0, fixed=4.0)
    steps.reject(steps.propose(0.0), CAUSE)
    assert steps.propose(0.0) == pytest.approx(2.0)
    steps.accept(2.0, changed(1.0), easy=True)
    assert steps.propose(2.0) == pytest.approx(3.0)
    steps.accept(3.0, changed(1.0), easy=True)
    assert steps.propose(5.0) == pytest.approx(4.0)


@pytest.mark.parametrize("fixed", [None, 0.6])
def test_steps_land_on_stops(fixed):
    steps = control(end=10.0, stops=(3.3, 7.0), fixed=fixed)
    time, seen = 0.0, []
    while not steps.finished(time):
        step = steps.propose(time)
        steps.accept(step, changed(1.0), easy=True)
        time = steps.landed(time + step)
        seen.append(time)
    assert {3.3, 7.0, 10.0} <= set(seen)


def test_times_that_miss_a_stop_by_round_off_are_the_stop():
    steps = control(end=10.0, stops=(3.3, 7.0))
    assert [steps.landed(t) for t in (3.3 + 1e-12, 3.3 - 1e-12, 7.0, 9.999999999999)] == [
        3.3, 3.3, 7.0, 10.0,
    ]  # fmt: skip
    assert steps.landed(3.31) == 3.31
    assert steps.propose(3.3) == 1.0


def test_a_restart_begins_with_the_first_step_but_never_with_a_larger_one():
    steps = control()
    for _ in range(6):
        steps.accept(steps.propose(0.0), changed(1.0), easy=True)
    assert steps.propose(0.0) == 8.0
    steps.restart()
    assert steps.propose(0.0) == 1.0
    steps.reject(1.0, CAUSE)
    steps.restart()
    assert steps.propose(0.0) == 0.5
    constant = control(fixed=3.0)
    constant.restart()
    assert constant.propose(0.0) == 3.0


def erring(temperature: float = 0.0, gap: float = 0.0, strain: float = 0.0, substeps: int = 1):
    """Return the change of a step that has errors alone."""
    errors = StepErrors(temperature, gap, strain, substeps=substeps)
    return StepChange(1, 0.0, 0.0, errors=errors)


BOUNDS = ErrorBounds(temperature=2.0, gap=1e-6, strain=1e-5)


@pytest.mark.parametrize("name, allowed", [("temperature", 2.0), ("gap", 1e-6), ("strain", 1e-5)])
def test_steps_aim_at_the_tolerance_of_each_error(name, allowed):
    steps = control(tolerance=BOUNDS)
    steps.accept(1.0, erring(**{name: 1.2 * allowed}), easy=True)
    assert steps.propose(0.0) == pytest.approx(SAFETY / 1.2)
    free = control(tolerance=ErrorBounds())
    free.accept(1.0, erring(**{name: 1.2 * allowed}), easy=True)
    assert free.propose(0.0) == pytest.approx(GROWTH)


@pytest.mark.parametrize("name, allowed", [("temperature", 2.0), ("gap", 1e-6), ("strain", 1e-5)])
def test_a_step_with_errors_far_beyond_the_tolerance_is_cut(name, allowed):
    """Errors fall with the step, and below the first one as well, but not below the smallest."""
    bound = {"tolerance": BOUNDS, "reject_above": 2.0}
    assert not control(**bound).exceeds(4.0, erring(**{name: 1.99 * allowed}))
    cuts = (2.1, SAFETY / 2.1), (1.5, 1.0), (4.0, SAFETY / 4.0), (1e3, SMALLEST_CUT)
    for excess, share in cuts:
        steps = control(**bound)
        assert steps.exceeds(4.0, erring(**{name: excess * allowed})) == (share < 1)
        assert steps.propose(0.0) == pytest.approx(4.0 * share if share < 1 else 1.0)
    steps = control(**bound)
    assert steps.exceeds(0.5, erring(**{name: 1e3 * allowed})) and steps.propose(0.0) == 0.1
    assert not steps.exceeds(0.1, erring(**{name: 100 * allowed}))


def test_what_changes_at_once_is_accepted():
    """Its error does not fall with the step: no step is small enough for it."""
    bound = {"tolerance": BOUNDS, "reject_above": 2.0}
    steps = control(**bound)
    assert steps.exceeds(4.0, erring(gap=8e-6))
    assert not steps.exceeds(1.0, erring(gap=7e-6))
    steps.accept(1.0, erring(gap=7e-6), easy=True)
    assert steps.propose(0.0) == pytest.approx(SHRINKAGE)
    assert steps.exceeds(4.0, erring(gap=8e-6)), "an accepted step ends the comparison"
    assert steps.exceeds(1.0, erring(gap=3e-6)), "it does fall with the step"


def test_heat_steps_divide_the_error_of_temperatures():
    """With ten of them inside, a step whose single one errs by 2 K may be ten times as long."""
    bounds = ErrorBounds(temperature=2.0, substeps=10)
    steps = control(tolerance=bounds, reject_above=2.0)
    assert not steps.exceeds(1.0, erring(temperature=2.0, substeps=1))
    steps.accept(1.0, erring(temperature=2.0, substeps=1), easy=True)
    assert steps.propose(0.0) == pytest.approx(GROWTH)
    steps = control(tolerance=bounds)
    steps.accept(1.0, erring(temperature=2.0, substeps=10), easy=True)
    assert steps.propose(0.0) == pytest.approx(SAFETY)


def test_a_restored_control_knows_what_was_rejected():
    bound = {"tolerance": BOUNDS, "reject_above": 2.0}
    steps, other = control(**bound), control(**bound)
    steps.exceeds(4.0, erring(gap=8e-6))
    other.restore({name: item.values for name, item in steps.saved().items()})
    assert other.propose(0.0) == steps.propose(0.0)
    assert not other.exceeds(1.0, erring(gap=7e-6))


def test_fixed_steps_have_no_tolerance():
    steps = control(fixed=4.0, tolerance=BOUNDS, reject_above=1.0)
    assert not steps.exceeds(4.0, erring(gap=1.0))
    steps.accept(4.0, erring(gap=1.0), easy=True)
    assert steps.propose(0.0) == 4.0
