"""One coupled step: schemes, passes, failure and rewind, on problems with known answers."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.coupling.change import StepErrors
from castx.coupling.step import CoupledProblem
from castx.errors import ConvergenceError
from castx.heat.problem import HeatReport
from castx.heat.step_error import HeatError
from castx.proof.foreign.cases import contact_box
from castx.solvers.counters import StepCounters
from castx.transfer.pair_state import PairState
from tests import coupled_cases
from tests.coupled_cases import TIGHT, cylinder, merged, ring

FIXED = {"time": {"end": 2.0, "fixed_step": 1.0}}


class FakeHeat:
    """Two facing points: the temperature falls by 0.1/R at the end in a step of 1 s."""

    def __init__(self, law) -> None:
        self.law = law
        self.temperature = {"casting": fake_function(1.0)}
        self.enthalpy = self.temperature
        self.solid_fraction = {"casting": fake_function(0.0)}
        self.committed, self.fails = 1.0, False
        self.given: list[list[Any]] = []

    def advance(self, time, step, pairs=(), substeps=1, dissipation=None, factors=()) -> HeatReport:
        self.given.append(
            [
                (self.resistance(start), factor * self.resistance(end))
                for (start, end), factor in zip(pairs, factors, strict=True)
            ]
        )
        if self.fails:
            raise ConvergenceError("the heat problem did not converge")
        fall = step * 0.1 / self.given[-1][0][1][0]
        self.temperature["casting"].x.array[:] = self.committed - fall
        return HeatReport(2, 2, abs(fall))

    def step_error(self, pairs, factors) -> HeatError:
        self.asked = pairs, factors
        return HeatError(made=3.0, uniform=2.0, substeps=4)

    def between(self, name) -> list[str]:
        return [f"passed by {name}"]

    def resistance(self, state) -> np.ndarray:
        return self.law(state.gap, state.pressure)

    def coefficients(self, pairs) -> list[np.ndarray]:
        return [1.0 / self.resistance(state) for state in pairs]

    def commit(self) -> None:
        self.committed = float(self.temperature["casting"].x.array[0])

    def rewind(self) -> None:
        self.temperature["casting"].x.array[:] = self.committed

    def totals(self) -> dict[str, float]:
        return {}

    def destroy(self) -> None:
        pass


def fake_function(value: float) -> SimpleNamespace:
    return SimpleNamespace(x=SimpleNamespace(array=np.full(1, value)))


class FakeMechanics:
    """A casting whose gap opens by `slope` per kelvin that it has lost."""

    def __init__(self, slope: float) -> None:
        self.slope, self.state = slope, 1.0
        self.bodies = {"casting": self}
        self.formulation = SimpleNamespace(wall_melt=None)
        self.solution = fake_function(0.0)
        self.equilibrium = self.present = self
        self.commits = self.rewinds = 0
        self.active = SimpleNamespace(frozen_pairs=lambda: 3)
        self.fallbacks = 2
        self.finished: list[float] = []
        self.dissipated_fraction = 0.0
        self.is_compressible = False
        self.rounding, self.began_balanced = 0.0, False
        self.passed: list[Sequence[str]] = []

    def update_state(self, temperature, solid_fraction, step, between=()) -> None:
        self.state = float(temperature[0])
        self.passed.append(between)

    def largest_flow(self) -> float:
        return 4e-4

    def skin_growth(self) -> float:
        return 0.3

    def solve(self, time) -> SimpleNamespace:
        self.rounding *= -1.0
        return SimpleNamespace(balanced=False, began_balanced=self.began_balanced)

    def finish(self, time) -> None:
        self.finished.append(time)

    def contact_states(self):
        gap, none = np.array([self.slope * (1.0 - self.state) + self.rounding]), np.zeros(1)
        return [PairState(gap, none, np.zeros(1, dtype=bool), np.zeros((1, 2)), none)]

    def commit(self) -> None:
        self.commits += 1

    def rewind(self) -> None:
        self.rewinds += 1

    def destroy(self) -> None:
        pass


def fake_problem(scheme="iterated", slope=1.0, tolerance=1e-10, passes=40, law=None):
    """Return a problem with R = 1 + gap (or another law) and the gap after a time, see below."""
    interface = SimpleNamespace(
        name="casting/mould", contact=0, clearance=0.0,
        pairs=SimpleNamespace(area_vectors=np.ones((1, 2)), areas=np.ones(1), gap=np.zeros(1)),
    )  # fmt: skip
    heat = FakeHeat(law or (lambda gap, pressure: 1.0 + gap))
    mechanics = FakeMechanics(slope)
    problem = CoupledProblem(
        MPI.COMM_SELF, heat, mechanics, [interface], {"casting": np.ones(1)}, scheme, tolerance,
        passes, StepCounters(),
    )  # fmt: skip
    return problem, heat, mechanics


def self_consistent(step: float, slope: float, before: float = 0.0) -> float:
    """Return the gap g = before + slope 0.1 step / (1 + g)."""
    b = 1.0 - before
    return 0.5 * (-b + np.sqrt(b * b + 4 * (before + 0.1 * slope * step)))


def test_a_pair_that_ends_to_conduct_has_not_settled():
    """Open it conducts nothing, and so cools nothing that would open it: there is no solution."""
    problem, _, _ = fake_problem(law=lambda gap, pressure: np.where(gap > 0.05, np.inf, 1.0))
    with pytest.raises(ConvergenceError, match="change by inf of their values"):
        problem.advance(0.0, 2.0, 1)


@pytest.mark.parametrize("slope", [1.0, 10.0, 100.0])
def test_iterated_gap_is_self_consistent(slope):
    """Also where the plain iteration diverges: its factor is −slope 0.1 / (1 + g)²."""
    problem, heat, mechanics = fake_problem(slope=slope)
    passes = problem.advance(0.0, 2.0, 1).passes
    gap = self_consistent(2.0, slope)
    assert problem.states[0].gap == pytest.approx([gap], rel=1e-9)
    assert heat.given[-1][0][1] == pytest.approx([1.0 + gap], rel=1e-9)
    assert passes == len(heat.given) < 15
    counters = problem.counters
    assert passes == counters.passes == counters.unbalanced
    assert mechanics.finished == [2.0] * passes
    assert (counters.frozen_pairs, counters.fallbacks) == (3, 2)


def test_counters_add_up_over_tries_but_for_those_of_the_accepted_one():
    problem, heat, _ = fake_problem()
    heat.fails = True
    with pytest.raises(ConvergenceError):
        problem.advance(0.0, 2.0, 1)
    problem.rewind()
    heat.fails = False
    passes = problem.advance(0.0, 1.0, 1).passes
    assert problem.counters.passes == 1 + passes
    assert problem.counters.unbalanced == passes


def test_a_step_that_will_be_taken_again_is_given_up_after_three_passes():
    """It takes six to agree. Passes in which it does not change too much begin the count anew."""
    problem, heat, _ = fake_problem()
    whole = problem.advance(0.0, 2.0, 1)
    assert whole.agreed and whole.passes > 5
    problem.rewind()
    heat.given.clear()
    verdicts = iter([True, False, True, True, True])
    found = problem.advance(0.0, 2.0, 1, lambda change: next(verdicts))
    assert not found.agreed and found.passes == len(heat.given) == 5
    problem.rewind()
    assert problem.advance(0.0, 2.0, 1, lambda change: change.passes > 1).passes == 4


def test_first_guess_extrapolates_the_gap():
    problem, heat, _ = fake_problem(law=lambda gap, pressure: np.ones(1), passes=1)
    problem.advance(0.0, 1.0, 1)
    problem.commit()
    grown = problem.states[0].gap.copy()
    heat.law = lambda gap, pressure: 1.0 + gap
    with pytest.raises(ConvergenceError):
        problem.advance(1.0, 3.0, 1)
    assert heat.given[-1][0][1] == pytest.approx(1.0 + grown + 3.0 * grown)


def test_law_without_feedback_takes_one_pass():
    problem, heat, _ = fake_problem(law=lambda gap, pressure: np.full(1, 2.0))
    assert problem.advance(0.0, 1.0, 1).passes == 1
    assert len(heat.given) == 1


def test_no_heat_takes_one_pass():
    problem, _, mechanics = fake_problem(law=lambda gap, pressure: np.full(1, np.inf))
    assert problem.advance(0.0, 1.0, 1).passes == 1
    assert mechanics.state == 1.0


def test_mechanics_learns_what_heat_has_passed_in_each_pass_of_a_step():
    problem, _, mechanics = fake_problem("iterated")
    passes = problem.advance(0.0, 1.0, 4).passes
    assert mechanics.passed == [(), *[["passed by casting"]] * passes]
    problem.rewind()
    assert mechanics.passed[-1] == ()
    mechanics.is_compressible = True
    problem.advance(0.0, 1.0, 4)
    assert mechanics.passed[-1] == (), "what never melts needs no more than its end"


def test_staggered_uses_the_gap_of_the_last_step():
    problem, heat, _ = fake_problem("staggered")
    assert problem.advance(0.0, 1.0, 1).passes == 1
    assert heat.given[-1][0] == (1.0, 1.0)
    problem.commit()
    gap = problem.states[0].gap[0]
    assert gap == pytest.approx(0.1)
    problem.advance(1.0, 1.0, 1)
    assert heat.given[-1][0] == pytest.approx((1.0 + gap, 1.0 + gap))


def test_one_way_never_looks_at_the_gap():
    problem, heat, _ = fake_problem("one-way")
    for time in range(3):
        assert problem.advance(float(time), 1.0, 1).passes == 1
        problem.commit()
    assert problem.states[0].gap == pytest.approx([0.3])
    assert all(given[0] == (1.0, 1.0) for given in heat.given)


def test_errors_of_a_step_are_those_of_the_heat_and_half_of_what_moves():
    """Heat is asked with the states of the pairs of its last pass."""
    problem, heat, _ = fake_problem("staggered")
    problem.advance(0.0, 1.0, 4)
    found = problem.step_errors()
    assert found == StepErrors(2.0, 0.5 * problem.states[0].gap[0], 2e-4, made=3.0, substeps=4)
    assert found.gap == pytest.approx(0.05)
    [(start, end)], [factor] = heat.asked
    assert (start.gap, end.gap, factor) == (0.0, 0.0, 1.0)
    problem.commit()
    problem.advance(1.0, 1.0, 1)
    second = problem.step_errors()
    assert second.gap == pytest.approx(0.5 * (problem.states[0].gap[0] - 0.1))
    problem.mechanics = None
    assert problem.step_errors().strain == 0.0


def test_too_many_passes():
    """R that jumps to and fro has no fixed point."""
    problem, _, _ = fake_problem(
        passes=6, law=lambda gap, pressure: np.where(gap > 0.05, 0.5 + 10 * gap, 9.0 - gap)
    )
    with pytest.raises(ConvergenceError, match=r"6 passes \(coupling\.passes\)"):
        for step in (1.0, 2.0, 4.0, 8.0):
            problem.advance(0.0, step, 1)


@pytest.mark.parametrize(("began_balanced", "most"), [(True, 10), (False, 14)])
def test_passes_end_at_the_rounding_of_gaps(began_balanced, most):
    """A gap that is rounded to and fro by 2 nm has settled, at once where no force moves."""
    problem, heat, mechanics = fake_problem()
    mechanics.rounding, mechanics.began_balanced = 2e-9, began_balanced
    problem.advance(0.0, 1.0, 1)
    assert len(heat.given) < most


@pytest.mark.parametrize("began_balanced", [True, False])
def test_what_goes_round_beyond_rounding_does_not_agree(began_balanced):
    """A gap that moves by 0.2 µm, a tenth of a millionth of the resistance, has not settled."""
    problem, _, mechanics = fake_problem()
    mechanics.rounding, mechanics.began_balanced = 2e-7, began_balanced
    with pytest.raises(ConvergenceError, match="no longer came closer"):
        problem.advance(0.0, 1.0, 1)


def test_passes_near_rounding_do_not_count_for_the_next_step():
    """A tolerance of 1e-12 takes more passes than one of 1e-6, and the step is as hard."""
    found = []
    for tolerance in (1e-6, 1e-12):
        problem, _, _ = fake_problem(tolerance=tolerance, slope=10.0)
        found.append(problem.advance(0.0, 1.0, 1))
    assert found[0].passes < found[1].passes
    assert found[0].settled == found[0].passes == found[1].settled


def test_history_waits_for_commit():
    problem, heat, mechanics = fake_problem()
    problem.advance(0.0, 1.0, 1)
    assert mechanics.commits == 0
    assert heat.committed == 1.0
    problem.rewind()
    assert mechanics.rewinds == 2  # it stands for its only body too
    assert problem.states[0].gap == pytest.approx([0.0], abs=0.0)
    assert mechanics.state == 1.0  # the bodies see the committed temperatures again
    problem.advance(0.0, 2.0, 1)
    problem.commit()
    assert mechanics.commits == 1
    assert heat.committed == pytest.approx(1.0 - self_consistent(2.0, 1.0))


def test_second_step_starts_from_the_first():
    problem, heat, _ = fake_problem()
    gap = 0.0
    for time in range(2):
        problem.advance(float(time), 1.0, 1)
        start = heat.given[-1][0][0]
        assert start == pytest.approx([1.0 + gap], rel=1e-9)
        problem.commit()
        gap = self_consistent(1.0, 1.0, gap)
        assert problem.states[0].gap == pytest.approx([gap], rel=1e-8)


def everything(problem) -> dict[str, np.ndarray]:
    """Return copies of all that a state shows of a problem."""
    found = {}
    for name in problem.heat.temperature:
        found[f"T {name}"] = problem.heat.temperature[name].x.array.copy()
        found[f"H {name}"] = problem.heat.enthalpy[name].x.array.copy()
        found[f"f {name}"] = problem.heat.solid_fraction[name].x.array.copy()
        body = problem.mechanics.bodies[name]
        found[f"u {name}"] = body.solution.x.array.copy()
        found[f"s {name}"] = body.stress()
    for state in problem.states:
        found |= {key: getattr(state, key).copy() for key in ("gap", "pressure", "closed")}
    found["support"] = np.array([problem.mechanics.equilibrium.shown.support_force()])
    found["energy"] = np.array(list(problem.heat.totals().values()))
    return found


@pytest.mark.parametrize("case", [cylinder, ring])
@pytest.mark.parametrize("failure", ["passes", "heat", "mechanics"])
def test_failed_step_leaves_no_trace(comm, case, failure):
    """After a rewind the state is the same to the last bit, and so is the step that follows.

    On several ranks MUMPS adds in the order in which messages arrive, and a failed equilibrium has
    its factors made anew: there the step that follows is the same to round-off.
    """
    data = merged(case(TIGHT), {"coupling": {"passes": 60}})
    spoilt, clean = (coupled_cases.simulation(comm, data).problem for _ in range(2))
    for problem in (spoilt, clean):
        problem.advance(0.0, 0.5, 2)
        problem.commit()
    before = everything(spoilt)
    with pytest.raises(ConvergenceError):
        if failure == "passes":
            spoilt._most_passes, kept = 1, spoilt._most_passes
            spoilt.advance(0.5, 20.0, 1)
        elif failure == "heat":
            spoilt.heat._solver.snes.max_it = 1
            spoilt.advance(0.5, 20.0, 1)
        else:
            snes = spoilt.mechanics.equilibrium._procedure._solver.snes
            snes.max_it, kept = 0, snes.max_it
            spoilt.advance(0.5, 20.0, 1)
    spoilt.rewind()
    after = everything(spoilt)
    for name, value in before.items():
        assert np.array_equal(value, after[name]), name
    if failure == "passes":
        spoilt._most_passes = kept
    elif failure == "heat":
        spoilt.heat._solver.snes.max_it = 50
    else:
        snes.max_it = kept
    for problem in (spoilt, clean):
        problem.advance(0.5, 0.5, 2)
        problem.commit()
    one, other = everything(spoilt), everything(clean)
    for name, value in one.items():
        if comm.size == 1 and failure != "mechanics":
            assert np.array_equal(value, other[name]), name
        else:
            size = comm.allreduce(float(np.abs(value).max(initial=0.0)), op=MPI.MAX)
            assert value == pytest.approx(other[name], rel=0, abs=1e-8 * size), name


@pytest.mark.ranks
def test_a_failed_step_leaves_the_liquid_that_was_trapped(comm):
    """The last of its passes keep the pool of their third one, which half of the freezing left."""
    liquid = {"liquid": {"viscosity": 1e3, "coherency": 0.5}, "solidification_shrinkage": 0.05}
    shut = [
        {"on": on, "displacement": {"normal": 0.0}}
        for on in ("casting/base", "casting/top", "mould/base")
    ]
    poured = {"materials": {"aluminium": liquid}, "boundaries": shut}
    problem = coupled_cases.simulation(comm, cylinder(TIGHT, poured)).problem
    content = problem.mechanics.bodies["casting"].formulation._pockets.content
    for time in (0.0, 0.5, 1.0):
        problem.advance(time, 0.5, 2)
        problem.commit()
    (accepted,) = content.pockets
    problem._most_passes = 5
    with pytest.raises(ConvergenceError, match="in 5 passes"):
        problem.advance(1.5, 8.0, 1)
    assert content.pockets < 0.7 * accepted
    problem.rewind()
    assert content.pockets == pytest.approx(accepted, rel=1e-12)


def run(comm, scheme: str):
    data = merged(cylinder(FIXED), {"coupling": {"scheme": scheme}})
    data["interfaces"][0]["heat"]["gas_conductivity"] = 0.01  # a gap of 4 µm is felt
    return coupled_cases.final_state(comm, data)


def test_schemes_of_a_case_differ_as_described(comm):
    found = {s: run(comm, s) for s in ("thermal", "one-way", "staggered", "iterated")}
    heat = {s: state.totals["casting/mould.heat"] for s, state in found.items()}
    gap = {s: comm.allreduce(state.paired("casting/mould", "gap").max(initial=0.0), op=MPI.MAX)
           for s, state in found.items()}  # fmt: skip
    assert heat["thermal"] == pytest.approx(heat["one-way"], rel=1e-12)
    assert gap["thermal"] == 0.0
    assert gap["one-way"] > 1.05 * gap["iterated"] > 5e-6
    assert heat["iterated"] < 0.98 * heat["staggered"]
    assert heat["staggered"] < 0.98 * heat["one-way"]
    assert found["thermal"].counters.mechanics_iterations == 0
    assert found["one-way"].counters.passes == found["staggered"].counters.passes == 1


def test_mechanical_scheme_follows_the_given_temperatures(comm):
    """Both bodies uniform: the gap is that of free expansion, linear in temperature."""
    history = [[0.0, 670.0], [2.0, 570.0]]
    data = merged(cylinder(FIXED), {"coupling": {"scheme": "mechanical"}})
    data["bodies"][0] |= {"temperature": 670.0, "temperature_history": history}
    state = coupled_cases.final_state(comm, data)
    T = coupled_cases.nodal(state, "casting", "temperature")
    assert T == pytest.approx(570.0)
    side = coupled_cases.paired(state, "casting/mould", "gap")
    assert side == pytest.approx(0.03 * 2.4e-5 * 90.0, rel=1e-3)  # stress-free at 660 °C
    assert "energy_error" not in state.totals


@pytest.mark.parametrize("tolerance", [0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8])
def test_passes_end_once_the_resistance_changes_by_no_more_than_the_tolerance(tolerance):
    """Not earlier, and not later: the pass before still changed it by more."""
    problem, heat, _ = fake_problem(slope=10.0, tolerance=tolerance)
    problem.advance(0.0, 2.0, 1)
    tried = [given[0][1][0] for given in heat.given]
    # The gap that follows from a resistance, as the two fakes have it.
    found = [1.0 + 10.0 * 0.2 / resistance for resistance in tried]
    changes = [abs(new - old) / new for new, old in zip(found, tried, strict=True)]
    assert changes[-1] <= tolerance
    assert min(changes[:-1], default=np.inf) > tolerance


@pytest.mark.ranks
def test_the_initial_state_is_an_equilibrium_to_which_a_failed_step_returns(comm):
    """Halves 10 K below their temperature without stress: 2 L (1 + ν) α 10 K apart."""
    made = coupled_cases.simulation(comm, contact_box.case(288.0, 308.0, 10.0, 5.0, 0.01))
    problem = made.problem
    problem.settle()
    before = everything(problem)
    np.testing.assert_allclose(before["gap"], contact_box.GAP, rtol=1e-9)
    problem.advance(0.0, 5.0, 1)
    moved = not np.array_equal(everything(problem)["s casting"], before["s casting"])
    assert comm.allreduce(moved, op=MPI.LOR)  # a rank may have no cell of the casting
    problem.rewind()
    after = everything(problem)
    for name, value in before.items():
        np.testing.assert_allclose(after[name], value, rtol=1e-12, atol=1e-18, err_msg=name)
    made.destroy()


def test_what_is_free_of_stress_or_may_be_liquid_is_left_to_the_first_step(comm):
    warm = {"materials": {"steel": {"stress_free": 20.0}}}
    poured = {"materials": {"aluminium": {"liquid": {"viscosity": 1e3, "coherency": 0.5}}}}
    for change in ({}, merged(warm, poured)):
        problem = coupled_cases.simulation(comm, cylinder(change)).problem
        problem.settle()
        assert problem.counters.mechanics_iterations == 0
        assert not np.abs(everything(problem)["u casting"]).any()


def test_an_initial_state_without_equilibrium_is_left_to_the_first_step(comm):
    made = coupled_cases.simulation(comm, contact_box.case(288.0, 308.0, 10.0, 5.0, 0.01))
    snes = made.problem.mechanics.equilibrium._procedure._solver.snes
    snes.max_it, kept = 0, snes.max_it
    made.problem.settle()
    assert not np.abs(everything(made.problem)["u casting"]).any()
    snes.max_it = kept
    made.problem.settle()
    np.testing.assert_allclose(everything(made.problem)["gap"], contact_box.GAP, rtol=1e-9)
