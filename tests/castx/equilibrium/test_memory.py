"""Memory: a saved equilibrium goes on in another problem as it would have."""

from __future__ import annotations

import numpy as np
import pytest

from castx.stateful import part_of
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import everywhere, motion
from tests.small_contact import two_blocks


def arrays_of(made):
    """Return the saved arrays with the rows of this rank."""
    return {name: saved.values for name, saved in made.memory.saved().items()}


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_a_restored_problem_has_the_same_state(comm, method):
    made = two_blocks(comm, method)
    made.equilibrium.commit()
    other = two_blocks(comm, method, solved=False)
    other.memory.restore(arrays_of(made))
    other.equilibrium.rewind()
    np.testing.assert_array_equal(other.equilibrium.active.closed, made.equilibrium.active.closed)
    for name in made.bodies:
        wanted = everywhere(comm, motion(made, name)[:, :2])
        found = everywhere(comm, motion(other, name)[:, :2])
        np.testing.assert_allclose(found, wanted, atol=1e-14 * np.abs(wanted).max() + 1e-18)
    for equilibrium in (made.equilibrium, other.equilibrium):
        equilibrium.balance.begin(equilibrium.x, 0.0)
    for before, after in zip(made.pair_values(), other.pair_values(),
                             strict=True):  # fmt: skip
        np.testing.assert_allclose(after, before, atol=1e-9 * np.abs(before).max(initial=1e-9))


@pytest.mark.ranks
def test_names_of_the_arrays(comm):
    """They stand in checkpoints: other names would make old ones useless."""
    found = two_blocks(comm, "multipliers").memory.saved()
    assert set(part_of(found, "rows")) == {
        f"upper/base/{name}" for name in ("closed", "at_rest", "multipliers")
    }
    assert {"time", "motion/upper", "motion/base", "anchor/upper", "anchor/base"} <= set(found)


@pytest.mark.ranks
def test_a_new_stage_puts_springs_where_bodies_are(comm):
    made = two_blocks(comm)
    made.equilibrium.commit()
    size = made.layout.size_local
    made.memory.begin_stage(["upper"])
    origin = made.equilibrium.balance.supports.origin
    np.testing.assert_array_equal(origin[:size], made.equilibrium.x.array_r[:size])
    values = made.gaps.values(made.equilibrium.balance.assembly.unknowns)
    np.testing.assert_allclose(values, 0.0, atol=1e-18)
