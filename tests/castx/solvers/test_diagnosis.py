"""A run that cannot go on says which problem, body and place failed, and what usually helps."""

import numpy as np
import pytest
from dolfinx import fem

from castx.errors import ConvergenceError
from castx.heat.body import ThermalBody
from castx.mechanics.body import BodyMechanics
from castx.solvers.diagnosis import COUPLING, HEAT, MECHANICS, FailedTry, diagnosis
from castx.solvers.finite import require_finite
from castx.solvers.worst_place import Part, worst_place
from tests.castx.checkpoint.test_file import casting
from tests.castx.fakes import cylinder_mesh
from tests.coupled_cases import cylinder, merged, states

SHORT = {"time": {"end": 2.0, "first_step": 0.2, "smallest_step": 0.1}}


def failure_of(comm, data, problem):
    with pytest.raises(ConvergenceError) as failure:
        list(states(comm, data))
    assert failure.value.problem == problem
    return str(failure.value)


def test_the_words_of_a_diagnosis():
    tries = [FailedTry(0.8 / 2**k, ConvergenceError("x", HEAT)) for k in range(9)]
    tries.append(FailedTry(1e-3, ConvergenceError("x", COUPLING)))
    text = diagnosis(12.5, tries)
    assert "t = 12.5 s" in text
    assert "steps of 0.8, 0.4, …, 0.00313, 0.001 s" in text
    assert "the heat problem 9×, the interfaces 1×" in text
    assert "coupling.passes" in text and "time.smallest_step" in text


@pytest.mark.parametrize("problem", ["", HEAT, MECHANICS, COUPLING])
def test_there_is_advice_for_every_problem(problem):
    text = diagnosis(0.0, [FailedTry(0.1, ConvergenceError("x", problem))])
    assert text.count("\n- ") >= 1


def test_heat_that_does_not_converge(comm):
    text = failure_of(comm, cylinder(SHORT, {"solver": {"heat": {"snes_max_it": 1}}}), HEAT)
    assert "smallest step of 0.1 s" in text and "the heat problem did not converge" in text
    assert "W in body 'casting' at (0.03" in text
    assert "tried from there: steps of 0.2, 0.1 s; what failed: the heat problem 2×" in text


def test_mechanics_that_does_not_converge(comm):
    data = merged(casting("thermo-elasto-viscoplastic"), SHORT)
    data = merged(data, {"solver": {"mechanics": {"snes_max_it": 1}}})
    text = failure_of(comm, data, MECHANICS)
    assert "the mechanical equilibrium did not converge" in text
    assert "N in body 'casting' (" in text and "snes_max_it = 100" in text


def test_interfaces_that_do_not_agree(comm):
    data = cylinder(SHORT, {"coupling": {"passes": 1, "tolerance": 1e-12}})
    data["interfaces"][0]["heat"]["gas_conductivity"] = 0.005
    assert "coupling.passes" in failure_of(comm, data, COUPLING)


def test_a_residual_that_is_not_a_number_is_named(comm, monkeypatch):
    present = BodyMechanics.present_residual

    def spoilt(self):
        rows = present(self)
        if self.name == "mould":
            near = np.linalg.norm(self.mesh.points[: self.owned_nodes] - [0.055, 0.06], axis=1)
            rows.reshape(-1, self.block_size)[near < 1e-9, 0] = np.nan
        return rows

    monkeypatch.setattr(BodyMechanics, "present_residual", spoilt)
    text = failure_of(comm, cylinder(SHORT), MECHANICS)
    assert "a residual is not a number in body 'mould' (forces) at (0.055, 0.06) m" in text


def test_a_state_that_is_not_a_number_is_named_on_all_ranks(comm):
    mesh = cylinder_mesh(comm)
    fields = {name: fem.Function(body.nodes) for name, body in mesh.bodies.items()}
    require_finite(comm, {"temperature": fields})
    points = mesh.bodies["mould"].points
    fields["mould"].x.array[np.linalg.norm(points - [0.03, 0.04], axis=1) < 1e-9] = np.inf
    wrong = r"temperature of body 'mould' is not a finite number at \(0\.03, 0\.04\) m"
    with pytest.raises(ConvergenceError, match=wrong):
        require_finite(comm, {"temperature": fields})


def test_a_solver_that_breaks_down_counts_as_not_converged(comm, monkeypatch):
    """Conduction that is not a number makes a matrix that cannot be factorised."""
    slope = ThermalBody.conduction_slope
    monkeypatch.setattr(
        ThermalBody, "conduction_slope", lambda self, given: slope(self, given) * np.nan
    )
    data = merged(cylinder(SHORT), {"coupling": {"scheme": "thermal"}})
    assert "the heat problem" in failure_of(comm, data, HEAT)


def test_the_worst_place_is_the_same_on_all_ranks(comm):
    values = np.array([1.0, 2.0 + comm.rank])
    points = np.array([[0.0, 0.0], [1.0, float(comm.rank)]])
    text = worst_place(comm, [Part("body 'a'", values, points)], "W")
    last = comm.size - 1
    assert text == f"largest residual {2.0 + last:.3e} W in body 'a' at (1, {last}) m"
    values[0] = np.nan if comm.rank == last else 0.0
    text = worst_place(comm, [Part("body 'a'", values, points)], "W")
    assert text == "a residual is not a number in body 'a' at (0, 0) m"
    assert worst_place(comm, [], "W") == ""
