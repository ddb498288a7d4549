"""Changes of the pairs between iterations: closing, opening, better multipliers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from castx.contact.methods.registry import METHODS
from castx.equilibrium.pair_changes import PairChanges
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import everywhere
from tests.small_contact import two_blocks


def pushed_down(made, by):
    """Return the unknowns of the solution with the upper block lower by some metres."""
    x, u = made.equilibrium.x.copy(), np.zeros(made.layout.size_local)
    u[made.layout.local_slice(0)].reshape(-1, 3)[:, 1] = -by
    x.array[: len(u)] += made.equilibrium.balance.transform.unknowns(u)
    return x


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_solution_keeps_its_pairs(comm, method):
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f, closed = x.duplicate(), balance.active.closed.copy()
    balance.residual(x, f)
    before = f.array_r.copy()
    assert not PairChanges(balance).change_set(x, f)
    np.testing.assert_array_equal(f.array_r, before)
    np.testing.assert_array_equal(balance.active.closed, closed)


@pytest.mark.parametrize("method", AT_ONCE)
def test_pairs_that_penetrate_close_and_the_residual_follows(comm, method):
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f, closed = x.duplicate(), everywhere(comm, balance.active.closed)
    assert {True, False} == set(closed)
    down = pushed_down(made, 1e-3)
    balance.residual(down, f)
    assert PairChanges(balance).change_set(down, f)
    assert everywhere(comm, balance.active.closed).all()
    found = f.array_r.copy()
    balance.residual(down, f)
    np.testing.assert_allclose(found, f.array_r, atol=1e-9 * np.abs(found).max(initial=1.0))


@pytest.mark.parametrize("method", AT_ONCE)
def test_only_multipliers_that_are_no_unknowns_improve(comm, method):
    made = two_blocks(comm, method)
    balance, f = made.equilibrium.balance, made.equilibrium.x.duplicate()
    balance.begin(made.equilibrium.x, 0.0)
    down = pushed_down(made, 1e-6)
    balance.residual(down, f)
    improved = PairChanges(balance).augment(down, f, balanced=True)
    assert improved == METHODS[method].updates_multipliers


@pytest.mark.serial
@pytest.mark.parametrize(
    ("residual", "rounding", "noise"), [(1.0, 0.0, 0.05), (1e-6, 0.0, 1e-4), (1e-6, 2e-3, 2e-3)]
)
def test_noise_is_a_hundredth_of_what_balances_and_a_hundred_residuals(residual, rounding, noise):
    """The smaller of both, so that exact solutions see far smaller forces, but not rounding."""
    thresholds = []

    def judge(forces, threshold, settled):
        thresholds.append(threshold)
        return False

    def slide(iterate, forces, threshold, settled):
        thresholds.append(threshold)
        return False

    balance: Any = SimpleNamespace(
        active=SimpleNamespace(update=judge, closed=np.zeros(2, dtype=bool)),
        assembly=SimpleNamespace(improve_pressures=lambda: False, unknowns=None),
        contact=SimpleNamespace(slide=slide, has_friction=False),
        convergence=SimpleNamespace(smallest=5.0, weakest=1e3, rounding=rounding),
        supports=SimpleNamespace(change=lambda closed, all_quiet: False), is_linear=True,
        is_evaluated_at=lambda x: True, present=lambda x: x, trial_forces=np.zeros(2),
    )  # fmt: skip
    f: Any = SimpleNamespace(norm=lambda: residual)
    x: Any = None
    assert not PairChanges(balance).change_set(x, f)
    assert thresholds == pytest.approx([noise, noise], rel=1e-12)
