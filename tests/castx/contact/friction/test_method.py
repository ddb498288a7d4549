"""What friction offers, for every method that has some: memory, and forces on both sides."""

from __future__ import annotations

import numpy as np
import pytest

from tests.contact_methods import WITH_FRICTION
from tests.elastic_bodies import everywhere
from tests.small_contact import two_blocks, waves


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_a_rewound_step_has_the_friction_of_the_accepted_one(comm, method):
    made = two_blocks(comm, method, friction=0.2)
    made.equilibrium.commit()
    balance, x = made.equilibrium.balance, made.equilibrium.x
    balance.begin(x, 0.0)
    f = x.duplicate()
    balance.residual(x, f)
    before = f.array_r.copy()
    saved = {name: array.copy() for name, array in balance.contact.saved().items()}
    x.array[:] += 1e-6 * waves(x)
    balance.residual(x, f)
    made.equilibrium.rewind()
    balance.begin(x, 0.0)
    balance.residual(x, f)
    scale = max(1.0, float(np.abs(before).max(initial=0.0)))
    np.testing.assert_allclose(f.array_r, before, atol=1e-12 * scale)
    for name, array in balance.contact.saved().items():
        np.testing.assert_array_equal(array, saved[name])


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_no_pair_bears_more_than_friction_can(comm, method):
    """Of a block that is pushed over: open pairs bear nothing, closed ones at most μ f."""
    made = two_blocks(comm, method, friction=0.2)
    along = made.equilibrium.balance.along_surface(made.equilibrium.x)
    assert along is not None
    size = everywhere(comm, np.linalg.norm(along, axis=1))
    normal = everywhere(comm, made.pair_values()[1])
    assert size.max() > 0.0
    assert np.all(size <= 0.2 * normal * (1 + 1e-6) + 1e-9 * normal.max())


def test_without_friction_there_is_none(comm):
    made = two_blocks(comm)
    assert made.equilibrium.balance.along_surface(made.equilibrium.x) is None
