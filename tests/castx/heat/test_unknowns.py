"""Enthalpies of the nodes: what they store, and how a step begins."""

from __future__ import annotations

import numpy as np
import pytest

from tests.castx.heat.heat_cases import SERIES, balance_under_law, cylinder


@pytest.mark.ranks
def test_nodes_store_their_volume_times_their_enthalpy(comm):
    unknowns = balance_under_law(cylinder(comm, size=8e-3), SERIES, 0.4).unknowns
    enthalpies = unknowns.enthalpies() + 1e6
    np.testing.assert_allclose(unknowns.stored(enthalpies), unknowns.volumes * enthalpies)
    unknowns.set_enthalpies(enthalpies)
    held = sum(body.stored_heat() for body in unknowns.bodies)
    assert comm.allreduce(held) == pytest.approx(
        comm.allreduce(float(unknowns.volumes @ enthalpies)), rel=1e-12
    )
    np.testing.assert_allclose(unknowns.enthalpies(), enthalpies, rtol=1e-12)


@pytest.mark.serial
def test_a_step_begins_with_what_is_known(comm):
    unknowns = balance_under_law(cylinder(comm, size=8e-3), SERIES, 0.4).unknowns
    guess = unknowns.enthalpies()
    found = unknowns.first_guess(guess, 1.0)
    free = ~unknowns.prescribed
    np.testing.assert_array_equal(found[free], guess[free])
