"""The mechanical problem of described bodies: which are rigid, which pairs there are."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.errors import CaseError
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem
from tests.small_contact import SOFT, two_blocks


def test_bodies_without_a_description_are_rigid(comm):
    made = problem(
        blocks(comm), {"upper": body(elastic(*SOFT))}, {"upper": [fixed("top")]},
        [Contact("upper", "base", "rigid")],
    )  # fmt: skip
    assert list(made.bodies) == ["upper"] and list(made.rigid) == ["base"]
    np.testing.assert_array_equal(made.rigid["base"].displacement(1.0), [0.0, 0.0])


def test_states_of_the_pairs_of_each_interface(comm):
    """Forces of the primary on the secondary nodes add up to the load on the upper block."""
    made = two_blocks(comm)
    [state] = made.contact_states()
    gap, force = made.pair_values()
    np.testing.assert_array_equal(state.gap, gap)
    np.testing.assert_allclose(state.pressure, force / made.pairs[0].areas, rtol=1e-12)
    np.testing.assert_array_equal(state.closed, made.equilibrium.active.closed)
    assert everywhere(comm, state.force)[:, 1].sum() == pytest.approx(1e6 * 0.02, rel=1e-9)


def test_refuses_two_rigid_bodies(comm):
    with pytest.raises(CaseError, match="interface base/upper: the secondary body 'base' is rig"):
        problem(
            blocks(comm), {"upper": body(elastic(*SOFT))}, {}, [Contact("base", "upper")]
        )
