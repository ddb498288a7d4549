"""Equilibrium of blocks: resultants, and the accepted solution of another method."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    motion,
    places,
    problem,
    pulled,
    pushed,
)
from tests.small_contact import SOFT, STIFF, two_blocks


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_block_tilts_and_opens_at_one_side(comm, method):
    """Under a moment the pairs at one side open; the resultant of the others is the load."""
    mesh = blocks(comm, symmetry=False)
    loads = (pushed("top", 1e6), pulled("side", 2e5, 0.0))
    made = problem(
        mesh, {"upper": body(elastic(*SOFT), loads=loads), "base": body(elastic(*STIFF))},
        {"base": [fixed("bottom", "all")], "upper": [fixed("top", "x")]},
        [Contact("upper", "base", method)],
    )  # fmt: skip
    report = made.equilibrium.solve(0.0)
    forces = everywhere(comm, made.pair_values()[1])
    assert forces.sum() == pytest.approx(1e6 * 0.02, rel=1e-9)
    base = made.bodies["base"]
    bottom = np.abs(places(made, "base")[:, 1] + 0.02) < 1e-9
    reaction = everywhere(comm, base.residual().reshape(-1, base.block_size)[bottom, 1]).sum()
    assert reaction == pytest.approx(forces.sum(), rel=1e-10)
    assert report.contact_changes > 0
    assert 0 < np.count_nonzero(forces) < len(forces)


@pytest.mark.ranks
@pytest.mark.parametrize("second", AT_ONCE)
def test_a_method_starts_from_the_solution_of_another(comm, second):
    first, other = two_blocks(comm), two_blocks(comm, second, solved=False)
    first.equilibrium.commit()
    assert first.equilibrium.first is first.equilibrium and first.equilibrium.fallbacks == 0
    other.equilibrium.adopt(first.equilibrium)
    closed = everywhere(comm, first.equilibrium.active.closed)
    np.testing.assert_array_equal(everywhere(comm, other.equilibrium.active.closed), closed)
    for name in first.bodies:
        wanted = everywhere(comm, motion(first, name)[:, :2])
        found = everywhere(comm, motion(other, name)[:, :2])
        np.testing.assert_allclose(found, wanted, atol=1e-12 * np.abs(wanted).max())


def test_a_solution_is_kept_when_it_is_committed_and_lost_when_it_is_not(comm):
    made = two_blocks(comm, solved=False)
    made.equilibrium.solve(0.0)
    solution = made.equilibrium.x.array_r.copy()
    made.equilibrium.rewind()
    assert np.all(made.equilibrium.x.array_r == 0.0)
    made.equilibrium.solve(0.0)
    made.equilibrium.commit()
    made.equilibrium.rewind()
    np.testing.assert_allclose(made.equilibrium.x.array_r, solution, atol=1e-16)
