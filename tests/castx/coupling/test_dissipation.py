"""Plastic work becomes heat: an insulated bar is stretched far beyond its yield stress."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.coupling.dissipation import Dissipation
from tests import coupled_cases
from tests.coupled_cases import merged

YIELD, STRAIN, HEAT = 100e6, 0.02, 3e6
METAL = {
    "density": 3000.0, "heat_capacity": 1000.0, "conductivity": 200.0,
    "young_modulus": 70e9, "poisson_ratio": 0.3, "expansion": 0.0, "yield_stress": YIELD,
}  # fmt: skip


def bar(*changes: dict[str, Any]) -> dict[str, Any]:
    """Return a bar that is free sideways and stretched by 2 % in 10 s."""
    data = {
        "geometry": {"generator": "slab", "model": "plane-stress",
                     "length": 0.02, "width": 0.01, "size": 0.005},
        "materials": {"metal": METAL},
        "bodies": [{"name": "casting", "material": "metal", "temperature": 20.0,
                    "law": "thermo-elasto-plastic"}],
        "boundaries": [
            {"on": "casting/wall", "displacement": {"x": 0.0}},
            {"on": "casting/bottom", "displacement": {"y": 0.0}},
            {"on": "casting/far", "displacement": {"x": [[0.0, 0.0], [10.0, 0.02 * STRAIN]]}},
        ],
        "time": {"end": 10.0, "fixed_step": 0.5},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-10, "heat_tolerance": 1e-10},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


def plastic_work(before: float = 0.0) -> float:
    """Return the work per volume of a perfectly plastic bar [J/m³]."""
    return YIELD * (STRAIN - YIELD / 70e9 - before)


@pytest.mark.ranks
@pytest.mark.parametrize("fraction", [0.9, 0.4])
@pytest.mark.parametrize("scheme", ["iterated", "staggered"])
def test_the_bar_heats_by_its_plastic_work(comm, scheme, fraction):
    metal = {"materials": {"metal": {"dissipation": fraction}}, "coupling": {"scheme": scheme}}
    state = coupled_cases.final_state(comm, bar(metal))
    # A staggered step feels the work of the step before: that of the last one is still to come.
    expected = fraction * plastic_work(STRAIN / 20 if scheme == "staggered" else 0.0)
    change = state.nodal("casting", "temperature") - 20.0
    np.testing.assert_allclose(change, expected / HEAT, rtol=1e-3)
    volume = 0.02 * 0.01
    assert state.totals["casting.dissipation"] == pytest.approx(expected * volume, rel=1e-3)
    assert state.totals["casting.power.dissipation"] == pytest.approx(
        fraction * YIELD * STRAIN / 10.0 * volume, rel=1e-3
    )
    assert state.totals["energy_error"] < 1e-6


@pytest.mark.ranks
@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
def test_a_round_bar_heats_evenly_up_to_its_axis(comm, formulation):
    """Stretched along its axis, and next to no conduction that would even out what is not."""
    data = bar({"materials": {"metal": {"dissipation": 0.9, "conductivity": 1e-3}}})
    data["geometry"]["model"] = "axisymmetric"
    data["bodies"][0]["formulation"] = formulation
    data["boundaries"] = [
        {"on": "casting/bottom", "displacement": {"z": 0.0}},
        {"on": "casting/top", "displacement": {"z": [[0.0, 0.0], [10.0, 0.01 * STRAIN]]}},
    ]
    state = coupled_cases.final_state(comm, data)
    change = state.nodal("casting", "temperature") - 20.0
    np.testing.assert_allclose(change, 0.9 * plastic_work() / HEAT, rtol=1e-3)


@pytest.mark.ranks
@pytest.mark.parametrize(
    "change",
    [
        {"materials": {"metal": {"dissipation": 0.0}}},
        {"coupling": {"scheme": "one-way"}},
        {"bodies": [{"name": "casting", "material": "metal", "temperature": 20.0}]},
    ],
)
def test_no_heat_without_dissipation(comm, change):
    state = coupled_cases.final_state(comm, bar(change))
    np.testing.assert_allclose(state.nodal("casting", "temperature"), 20.0, atol=1e-9)


def test_viscous_flow_dissipates_its_whole_stress(comm):
    """The rate of work is σ ε̇ with σ = σ_Y + 3 η ε̇."""
    viscous = {
        "materials": {"metal": {"law": "bingham", "viscosity": 1e9, "dissipation": 1.0}},
        "bodies": [{"name": "casting", "material": "metal", "temperature": 20.0,
                    "law": "thermo-elasto-viscoplastic"}],
        "time": {"end": 10.0, "fixed_step": 0.1},
    }  # fmt: skip
    state = coupled_cases.final_state(comm, bar(viscous))
    rate = STRAIN / 10.0
    power = (YIELD + 3e9 * rate) * rate * 0.02 * 0.01
    assert state.totals["casting.power.dissipation"] == pytest.approx(power, rel=1e-3)


@pytest.mark.serial
def test_rewind_restores_the_dissipated_power(comm):
    """A step after a rewind is that of a problem that never tried another."""
    made = [coupled_cases.simulation(MPI.COMM_SELF, bar()) for _ in range(2)]
    for simulation in made:
        for time in (0.0, 0.5, 1.0):
            simulation.problem.advance(time, 0.5, 1)
            simulation.problem.commit()
    made[0].problem.advance(1.5, 5.0, 1)
    made[0].problem.rewind()
    for simulation in made:
        simulation.problem.advance(1.5, 0.5, 1)
        simulation.problem.commit()
    one, other = (s.problem.heat.totals()["casting.dissipation"] for s in made)
    assert one == pytest.approx(other, rel=1e-12)


@pytest.mark.ranks
def test_the_change_of_the_power_is_that_of_all_ranks(comm):
    """Ranks have 0, 1, 2, ... nodes, at each of which 2 W of 4 W become heat."""
    body = SimpleNamespace(dissipated_fraction=0.5, owned_nodes=comm.rank)
    body.nodal_plastic_power = lambda: np.full(comm.rank, 4.0)
    nodes = comm.size * (comm.size - 1) // 2
    dissipation = Dissipation(comm, {"casting": body})
    assert [dissipation.update(), dissipation.update()] == [2.0 * nodes, 0.0]


@pytest.mark.serial
def test_only_accepted_powers_are_kept():
    """A step that is taken back leaves those of the last one, and a checkpoint has no others."""
    body = SimpleNamespace(dissipated_fraction=0.5, owned_nodes=2)
    body.mesh = SimpleNamespace(node_numbering=None)
    dissipation = Dissipation(MPI.COMM_SELF, {"casting": body})
    body.nodal_plastic_power = lambda: np.array([2.0, 4.0])
    assert dissipation.update() == 3.0
    dissipation.commit()
    body.nodal_plastic_power = lambda: np.array([8.0, 4.0])
    assert dissipation.update() == 3.0
    saved = {name: each.values for name, each in dissipation.saved().items()}
    np.testing.assert_array_equal(saved["casting"], [1.0, 2.0])
    dissipation.rewind()
    np.testing.assert_array_equal(dissipation.powers["casting"], [1.0, 2.0])
    other = Dissipation(MPI.COMM_SELF, {"casting": body})
    other.restore(saved)
    np.testing.assert_array_equal(other.powers["casting"], [1.0, 2.0])


@pytest.mark.serial
def test_a_run_that_stands_still_goes_on(comm):
    """Round-off in the plastic work is no change of a step in which no heat moves at all."""
    pulled = [{"on": "casting/wall", "displacement": {"x": 0.0}},
              {"on": "casting/bottom", "displacement": {"y": 0.0}},
              {"on": "casting/far", "displacement": {"x": [[0.0, 0.0], [1.0, 0.02 * STRAIN]]},
               "heat": {"type": "convection", "coefficient": 1e5, "ambient": 20.0}}]  # fmt: skip
    time = {"fixed_step": None, "end": 1e4, "first_step": 0.5, "largest_step": 1e3}
    data = bar({"time": time, "boundaries": pulled})
    del data["time"]["fixed_step"]
    states = list(coupled_cases.states(comm, data))
    assert sum(state.counters.cutbacks for state in states) == 0
    assert states[-1].time == pytest.approx(1e4)
