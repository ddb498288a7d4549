"""A run that cannot go on says which problem, body and place failed, and what usually helps."""

import numpy as np
import pytest

from castx.errors import ConvergenceError
from castx.heat.body import ThermalBody
from castx.mechanics.displacement import DisplacementFormulation
from castx.solvers.diagnosis import CIRCLING, COUPLING, HEAT, MECHANICS, FailedTry, diagnosis
from tests.castx.checkpoint.test_file import casting
from tests.coupled_cases import cylinder, merged, states

SHORT = {"time": {"end": 2.0, "first_step": 0.2, "smallest_step": 0.1}}


def failure_of(comm, data, problem):
    with pytest.raises(ConvergenceError) as failure:
        list(states(comm, data))
    assert failure.value.problem == problem
    return str(failure.value)


@pytest.mark.serial
def test_the_words_of_a_diagnosis():
    tries = [FailedTry(0.8 / 2**k, ConvergenceError("x", HEAT)) for k in range(9)]
    tries.append(FailedTry(1e-3, ConvergenceError("x", COUPLING)))
    text = diagnosis(12.5, tries)
    assert "t = 12.5 s" in text
    assert "steps of 0.8, 0.4, …, 0.00313, 0.001 s" in text
    assert "the heat problem 9×, the interfaces 1×" in text
    assert "coupling.passes" in text and "time.smallest_step" in text


@pytest.mark.serial
@pytest.mark.parametrize("problem", ["", HEAT, MECHANICS, COUPLING, CIRCLING])
def test_there_is_advice_for_every_problem(problem):
    text = diagnosis(0.0, [FailedTry(0.1, ConvergenceError("x", problem))])
    assert text.count("\n- ") >= 1


def test_heat_that_does_not_converge(comm):
    data = cylinder(SHORT, {"solver": {"heat": {"snes_max_it": 1}}})
    data["bodies"][0]["temperature"] = 661.0  # freezes in the first step, which takes iterations
    text = failure_of(comm, data, HEAT)
    assert "smallest step of 0.1 s" in text and "the heat problem did not converge" in text
    assert "W in body 'casting' at (0.03" in text
    assert "tried from there: steps of 0.2, 0.1 s; what failed: the heat problem 2×" in text


def test_mechanics_that_does_not_converge(comm):
    data = merged(
        casting("thermo-elasto-viscoplastic"), {"solver": {"mechanics": {"snes_max_it": 1}}}
    )
    # Steps in which a skin yields: what is still liquid takes one iteration.
    data = merged(
        data, {"time": {"end": 20.0, "first_step": 5.0, "largest_step": 5.0, "smallest_step": 2.5}}
    )
    text = failure_of(comm, data, MECHANICS)
    assert "the mechanical equilibrium did not converge" in text
    assert "N in body 'casting' (" in text and "snes_max_it = 100" in text


def test_interfaces_that_do_not_agree(comm):
    data = cylinder(SHORT, {"coupling": {"passes": 1, "tolerance": 1e-12}})
    data["interfaces"][0]["heat"]["gas_conductivity"] = 0.005
    assert "coupling.passes" in failure_of(comm, data, COUPLING)


def test_a_residual_that_is_not_a_number_is_named(comm, monkeypatch):
    present = DisplacementFormulation.residual

    def spoilt(self):
        """Spoil the residual of the mould, the one body in its displacement alone."""
        rows, unknowns = present(self), self._unknowns
        points = unknowns.mesh.points[: unknowns.owned // unknowns.block_size]
        near = np.linalg.norm(points - [0.055, 0.06], axis=1) < 1e-9
        rows.reshape(-1, unknowns.block_size)[near, 0] = np.nan
        return rows

    monkeypatch.setattr(DisplacementFormulation, "residual", spoilt)
    text = failure_of(comm, cylinder(SHORT), MECHANICS)
    assert "a residual is not a number in body 'mould' (forces) at (0.055, 0.06) m" in text


def test_a_solver_that_breaks_down_counts_as_not_converged(comm, monkeypatch):
    """Conduction that is not a number makes a matrix that cannot be factorised."""
    slope = ThermalBody.conduction_slope
    monkeypatch.setattr(
        ThermalBody, "conduction_slope", lambda self, given: slope(self, given) * np.nan
    )
    data = merged(cylinder(SHORT), {"coupling": {"scheme": "thermal"}})
    assert "the heat problem" in failure_of(comm, data, HEAT)
