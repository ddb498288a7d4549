"""Every contact method in a whole coupled run, through the keys of a case."""

from __future__ import annotations

import numpy as np
import pytest

from tests.coupled_cases import cylinder, final_state, nodal, paired

pytestmark = pytest.mark.serial

SHORT = {"time": {"end": 3.0, "first_step": 0.1, "largest_step": 1.0}}


def run(comm, *changes, **contact):
    data = cylinder(SHORT, *changes)
    data["interfaces"][0]["contact"] = contact
    return final_state(comm, data)


@pytest.fixture(scope="module")
def expected():
    from mpi4py import MPI

    return run(MPI.COMM_WORLD, method="condensed")


@pytest.mark.parametrize(
    ("contact", "kelvin", "share"),
    [
        ({"method": "multipliers"}, 1e-2, 1e-3),
        ({"method": "augmented-lagrangian"}, 0.1, 1e-2),
        ({"method": "augmented-lagrangian", "augmentation": "iteration"}, 0.1, 1e-2),
        ({"method": "penalty"}, 1.0, 0.05),
        ({"method": "penalty", "penalty": "1e15 Pa/m"}, 0.1, 0.01),
    ],
)
def test_methods_give_the_same_temperatures_and_gaps(comm, expected, contact, kelvin, share):
    state = run(comm, **contact)
    for body in ("casting", "mould"):
        difference = nodal(state, body, "temperature") - nodal(expected, body, "temperature")
        assert np.abs(difference).max() < kelvin
    gap, exact = (paired(s, "casting/mould", "gap") for s in (state, expected))
    assert exact.max() > 1e-5
    np.testing.assert_allclose(gap, exact, atol=share * exact.max())


def test_a_rigid_mould_neither_moves_nor_bears_stress(comm, expected):
    """It does not grow: the gap is smaller than with an elastic one by what that grows."""
    data = cylinder(SHORT, method="rigid")
    del data["materials"]["steel"]["expansion"], data["materials"]["steel"]["young_modulus"]
    data["bodies"][1]["law"] = "rigid"
    state = final_state(comm, data)
    assert not nodal(state, "mould", "displacement").any()
    assert not state.cellwise("mould", "stress").any()
    assert not state.cellwise("mould", "von_mises").any()
    assert not state.cellwise("mould", "plastic_strain").any()
    assert not state.nodal("mould", "pressure").any()
    gap, elastic = (paired(s, "casting/mould", "gap") for s in (state, expected))
    assert 0.0 < gap.mean() < 0.5 * elastic.mean()
    assert state.totals["energy_error"] < 1e-6
