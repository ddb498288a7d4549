"""Balance of all nodes: sums that must hold, groups, prescribed temperatures."""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.balance import HeatBalance
from tests.castx.heat.heat_cases import (
    SERIES,
    SURROUNDINGS,
    balance_under_law,
    cylinder,
    open_pairs,
    residual_at,
)
from tests.heat_conditions import surface_heat

STEP = 0.5


def begun(mesh, surfaces=SURROUNDINGS, kind="law", **changes) -> tuple[HeatBalance, np.ndarray]:
    """Return a balance within a step from a colder state, and its first guess."""
    balance = balance_under_law(mesh, SERIES, 0.4, surfaces, kind, **changes)
    balance.exchanges.set_states([open_pairs(mesh)], 0.5)
    end = balance.unknowns.enthalpies()
    return balance, balance.begin(end - 1e6, end, 2.0, STEP)


def test_the_residuals_add_up_to_stored_minus_received_heat(comm):
    """Conduction and exchange cancel in the sum over all nodes."""
    balance, x = begun(cylinder(comm, size=8e-3))
    dissipated = np.full(balance.bodies[0].owned, 3.0)
    balance.set_dissipation({"casting": dissipated})
    total = comm.allreduce(residual_at(balance, x).sum())
    stored = comm.allreduce(balance.unknowns.volumes.sum()) * 1e6 / STEP
    flows = sum(comm.allgather(balance.flows()))
    source, dissipation = flows[:2].sum(), flows[2:4].sum()
    assert source == pytest.approx(2e5 * np.pi * 0.03**2 * 0.06)
    assert dissipation == pytest.approx(3.0 * comm.allreduce(len(dissipated)))
    outside = flows[4:7].sum()
    assert total == pytest.approx(stored - source - dissipation - outside, rel=1e-9)
    casting = balance.layout.local_slice(0)
    own = comm.allreduce(residual_at(balance, x)[casting].sum())
    through = flows[7:].sum()
    part = comm.allreduce(balance.bodies[0].volumes.sum()) * 1e6 / STEP
    assert own == pytest.approx(part - source - dissipation - flows[6] + through, rel=1e-9)


@pytest.mark.ranks
def test_sums_are_those_of_the_absolute_values(comm):
    balance, x = begun(cylinder(comm, size=8e-3))
    balance.residual.array[:] = residual_at(balance, x)
    sums = balance.sums()
    assert sums.residual == pytest.approx(comm.allreduce(np.abs(balance.residual.array_r).sum()))
    assert sums.moved >= comm.allreduce(balance.unknowns.volumes.sum()) * 1e6 / STEP
    assert 0.0 < sums.rounding < 1e-9 * sums.moved


def test_joined_nodes_solve_the_sum_of_their_balances(comm):
    """The residuals of perfect contact are those without contact, added up at the first nodes."""
    mesh = cylinder(comm, size=8e-3)
    joined, x = begun(mesh, kind="perfect")
    found = residual_at(joined, x)
    alone = balance_under_law(mesh, SERIES, None, kind="none")
    groups = joined.unknowns.groups
    alone.begin(joined.previous, joined.unknowns.enthalpies(), 2.0, STEP)
    apart = residual_at(alone, joined.unknowns.enthalpies())
    free = np.ones(len(found), dtype=bool)
    free[groups.idle] = free[groups.firsts] = False
    np.testing.assert_allclose(found[free], apart[free], rtol=1e-9, atol=1e-9)
    assert not found[groups.idle].any()
    sums = [comm.allreduce(values[~free].sum()) for values in (found, apart)]
    assert sums[0] == pytest.approx(sums[1], rel=1e-9)
    fed, through = joined.unknowns.reactions(joined.residual)
    assert len(fed) == 0 and len(through) == 1


@pytest.mark.ranks
def test_a_change_on_one_rank_changes_the_state_of_all(comm):
    """The Jacobian is that of x though nothing has changed on the other ranks."""
    mesh = cylinder(comm, size=8e-3)
    balance, x = begun(mesh)
    changed = balance.residual.duplicate()
    changed.array[:] = x + (1e6 if comm.rank == 0 else 0.0)
    balance.evaluate(changed)
    balance.assemble_jacobian(changed)
    expected = balance.jacobian.matrix.copy()
    changed.array[:] = x
    balance.evaluate(changed)
    changed.array[:] = x + (1e6 if comm.rank == 0 else 0.0)
    balance.assemble_jacobian(changed)
    expected.axpy(-1.0, balance.jacobian.matrix)
    assert expected.norm() <= 1e-12 * balance.jacobian.matrix.norm()


@pytest.mark.ranks
def test_prescribed_nodes_have_their_temperature_and_no_residual(comm):
    conditions = [surface_heat("mould/outside", "temperature", value=[[0.0, 80.0], [4.0, 120.0]]),
                  surface_heat("mould/top", "temperature", value=300.0)]  # fmt: skip
    mesh = cylinder(comm, size=8e-3)
    balance, x = begun(mesh, conditions)
    found = residual_at(balance, x)
    mould, unknowns = balance.bodies[1], balance.unknowns
    surfaces = [mould.mesh.surface_nodes(name) for name in ("outside", "top")]
    outside, top = (nodes[nodes < mould.owned] for nodes in surfaces)
    T = mould.owned_temperature
    assert T[outside] == pytest.approx(100.0)  # at 2 s, the first condition where both meet
    only = np.setdiff1d(top, outside)
    assert T[only] == pytest.approx(300.0)
    start = unknowns.start_of(mould)
    fixed = np.union1d(outside, top) + start
    np.testing.assert_array_equal(np.sort(unknowns.fixed), fixed)
    assert unknowns.prescribed[fixed].all() and not found[fixed].any()


def test_equalising_joined_nodes_keeps_the_heat(comm):
    mesh = cylinder(comm, size=8e-3)
    unknowns = balance_under_law(mesh, SERIES, None, kind="perfect").unknowns
    before = unknowns.enthalpies()
    through = unknowns.equalise()
    after = unknowns.enthalpies()
    gained = unknowns.volumes * (after - before)
    assert comm.allreduce(np.abs(gained).sum()) > 1e3
    assert abs(comm.allreduce(gained.sum())) < 1e-9 * comm.allreduce(np.abs(gained).sum())
    mould = comm.allreduce(gained[unknowns.parts[1]].sum())
    assert comm.allreduce(through.sum()) == pytest.approx(mould, rel=1e-9)
    np.testing.assert_allclose(unknowns.equalise(), 0.0, atol=1e-6 * abs(mould))
