"""Convergence: each body by its own forces, and where a residual is largest."""

from __future__ import annotations

import numpy as np

from castx.equilibrium.convergence import ForceConvergence, worst_row
from tests.small_contact import two_blocks


def test_each_body_is_measured_by_its_own_forces(comm):
    made = two_blocks(comm)
    balance = made.equilibrium.balance
    limits = ForceConvergence(balance.assembly, balance.contact.layout, 1e-3)
    limits.begin()
    limits.update(made.equilibrium.x, np.zeros(made.equilibrium.x.getLocalSize()))
    forces = balance.assembly.force_scales()
    found = [limits.weakest, limits.smallest]
    np.testing.assert_allclose(found, [forces.min(), 1e-3 * forces.min()])
    f = made.equilibrium.x.duplicate()
    count = made.layout.size_global
    for b, force in enumerate(forces):
        part = made.layout.local_slice(b)
        own = comm.allreduce(part.stop - part.start)
        assert own < count
        for share, met in ((0.99e-3, True), (1.01e-3, False)):
            f.set(0.0)
            f.array[part] = share * force / np.sqrt(own)
            assert limits.is_met(f) == met


def test_rounding_of_what_cancels_is_no_residual(comm):
    """Terms of a row that are 10¹⁴ times the forces leave more than the tolerance."""
    made = two_blocks(comm)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    limits = ForceConvergence(balance.assembly, balance.contact.layout, 1e-12)
    limits.begin()
    limits.update(x, np.zeros(x.getLocalSize()))
    strict = limits.smallest
    limits.update(x, np.full(x.getLocalSize(), 1e22))
    assert limits.smallest > 10 * strict
    # What acts at the start of a solution counts to its end.
    loose = limits.smallest
    limits.update(x, np.full(x.getLocalSize(), 1e20))
    assert limits.smallest >= 0.9 * strict
    limits.begin()
    limits.update(x, np.zeros(x.getLocalSize()))
    assert limits.smallest == strict < loose


def test_the_worst_row_has_a_body_and_a_place(comm):
    made = two_blocks(comm)
    balance = made.equilibrium.balance
    f = made.equilibrium.x.duplicate()
    own = made.layout.local_slice(1)
    if comm.rank == comm.size - 1:
        f.array[own.start] = 7.0
    text = worst_row(balance.assembly, balance.gaps, balance.contact.layout, f)
    assert "body 'base' (forces)" in text and "7" in text
    assert len(set(comm.allgather(text))) == 1


def test_rows_of_multipliers_belong_to_their_interface(comm):
    made = two_blocks(comm, "multipliers")
    balance = made.equilibrium.balance
    f = made.equilibrium.x.duplicate()
    if len(made.gaps.local):
        f.array[-1] = 7.0
    text = worst_row(balance.assembly, balance.gaps, balance.contact.layout, f)
    assert "interface 'upper/base'" in text
