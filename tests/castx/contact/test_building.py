"""Every registered method gets the contact that its unknowns ask for."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.condensed import CondensedContact
from castx.contact.methods.description import UnknownKind
from castx.contact.methods.registry import METHODS
from castx.contact.multipliers import MultiplierContact
from castx.contact.soft import SoftContact
from tests.contact_methods import BETWEEN_DEFORMABLE, FORCE_OF_GAP, sharp
from tests.small_contact import two_blocks

pytestmark = pytest.mark.serial

CLASSES = {
    UnknownKind.GAPS: CondensedContact,
    UnknownKind.TIED: CondensedContact,
    UnknownKind.MULTIPLIERS: MultiplierContact,
    UnknownKind.DISPLACEMENTS: SoftContact,
}


@pytest.mark.parametrize("method", BETWEEN_DEFORMABLE)
def test_class_of_the_contact(comm, method):
    contact = two_blocks(comm, method, solved=False).equilibrium.balance.contact
    assert type(contact.normal) is CLASSES[METHODS[method].unknowns]


@pytest.mark.parametrize("method", sharp(FORCE_OF_GAP))
def test_a_given_penalty_is_a_spring_of_each_pair(comm, method):
    """What the pairs add to the matrix is Gᵀ ε S G, whatever the bodies are made of."""
    made = two_blocks(comm, method, solved=False, settings={"penalty": 3e11})
    made.equilibrium.balance.begin(made.equilibrium.x, 0.0)
    balance = made.equilibrium.balance
    balance.residual(made.equilibrium.x, made.equilibrium.x.duplicate())
    deeper = balance.iterate.gaps - 1e-6
    changed = type(balance.iterate)(
        balance.iterate.x, balance.iterate.rows, deeper, balance.iterate.closed, 1.0
    )
    difference = balance.contact.normal.trial_forces(changed) - balance.trial_forces
    np.testing.assert_allclose(difference, 1e-6 * 3e11 * made.gaps.areas, rtol=1e-9)


def test_friction_goes_to_the_rows_that_have_some(comm):
    contact = two_blocks(comm, "penalty", friction=0.2).equilibrium.balance.contact
    assert set(contact.saved()) == {"friction_0"}
    contact = two_blocks(comm, "condensed", friction=0.2).equilibrium.balance.contact
    assert set(contact.saved()) == {"sticks", "sliding_0"}
