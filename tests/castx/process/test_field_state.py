"""What fields read from bodies and interfaces: against each other, and against other states."""

from mpi4py import MPI

import numpy as np
import pytest

from castx.errors import CaseError
from castx.process.field_state import FieldState, PairsState
from tests.castx.process.test_stages import FLOWING
from tests.coupled_cases import cylinder, final_state, merged, ring, states

SHORT = {"time": {"end": 4.0, "fixed_step": 2.0}}
INTERFACE = "casting/core"


@pytest.fixture(scope="module")
def run():
    return final_state(MPI.COMM_WORLD, ring(SHORT))


def flowing():
    """Return a solid ring that yields while it shrinks onto its core, in steps of 1 s."""
    steps = {"time": {"end": 3.0, "fixed_step": 1.0}}
    data = merged(ring(steps), {"materials": {"aluminium": FLOWING}})
    data["bodies"][0] |= {"temperature": 600.0, "law": "thermo-elasto-viscoplastic"}
    return data


def body(state, name="casting"):
    return FieldState(state.problem, name, "a field")


def test_arrays_have_the_places_of_the_body(run):
    for name, part in run.mesh.bodies.items():
        nodes, cells = len(part.parent_vertices), len(part.nodes.dofmap.list)
        state = body(run, name)
        for field in ("temperature", "enthalpy", "solid_fraction"):
            assert state.heat(field).shape == (nodes,)
        assert state.pressure().shape == (nodes,)
        assert state.displacement().shape == (nodes, 2)
        assert state.stress().shape == (cells, 6) and state.plastic_strain().shape == (cells,)
        points = state.point_stress().reshape(cells, -1, 6)
        assert points.mean(axis=1) == pytest.approx(state.stress(), rel=0.05, abs=2e6)


def test_enthalpy_follows_from_the_temperature(run):
    """Of the steel core, whose heat capacity is constant: H = ρ c T."""
    state = body(run, "core")
    assert state.heat("enthalpy") == pytest.approx(7800.0 * 460.0 * state.heat("temperature"))


@pytest.mark.ranks
def test_pairs_have_resistance_gap_and_pressure(run):
    """R = 1/h, with the law of the case; a pair either stands open or presses."""
    pairs = PairsState(run.problem, INTERFACE)
    gap, pressure = pairs.gap(), pairs.contact_pressure()
    assert gap.shape == pressure.shape == run.pairs[INTERFACE].areas.shape
    assert not ((gap > 1e-9) & (pressure > 1.0)).any()
    relative = np.maximum(pressure / 5e8, 0.0)
    h = np.minimum(1500.0, 0.05 / np.maximum(gap, 1e-12))
    h += relative * np.maximum(relative, 1e-6) ** -0.05 / 2e-4
    assert 1.0 / pairs.resistance() == pytest.approx(h, rel=1e-9)


@pytest.mark.ranks
def test_pairs_that_press_are_not_pulled(run):
    pairs = PairsState(run.problem, INTERFACE)
    assert pairs.wall_suction().shape == pairs.gap().shape and not pairs.wall_suction().any()


@pytest.mark.ranks
def test_plastic_strain_increments_add_up(comm):
    """Between two states stands the increment of the later one; before the first step none."""
    before, flowed = None, 0.0
    for state in states(comm, flowing()):
        seen = body(state)
        now, increment = seen.plastic_strain().copy(), seen.plastic_strain_increment()
        gained = np.zeros_like(now) if before is None else now - before
        assert increment == pytest.approx(gained, abs=1e-15)
        assert seen.step_size == pytest.approx(1.0)
        before, flowed = now, float(now.max(initial=0.0))
    assert comm.allreduce(flowed, op=MPI.MAX) > 1e-4


def test_the_step_size_is_that_of_the_last_step(run):
    assert body(run).step_size == pytest.approx(2.0)


def test_what_a_place_does_not_have_is_refused(run):
    pairs, casting = PairsState(run.problem, INTERFACE), body(run)
    for read in (casting.gap, casting.contact_pressure, casting.resistance, pairs.stress,
                 pairs.pressure, pairs.displacement, pairs.plastic_strain_increment):  # fmt: skip
        with pytest.raises(CaseError, match="declare another place"):
            read()
    with pytest.raises(CaseError, match="declare another place"):
        pairs.heat("temperature")
    with pytest.raises(CaseError, match="no step size"):
        _ = pairs.step_size


@pytest.mark.ranks
def test_runs_without_mechanics_name_the_field_and_the_body(comm):
    state = final_state(comm, merged(cylinder(SHORT), {"coupling": {"scheme": "thermal"}}))
    with pytest.raises(CaseError, match="a field of 'mould': this run has no mechanics"):
        body(state, "mould").stress()
