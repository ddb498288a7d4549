"""Jacobian of the heat balance: the derivative of its residual."""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.balance import HeatBalance
from castx.heat.newton import jacobian
from castx.transfer.registry import gap_heat_laws
from tests.castx.heat.heat_cases import (
    LAWS,
    SERIES,
    SURROUNDINGS,
    balance_under_law,
    cylinder,
    open_pairs,
    residual_at,
)
from tests.castx.transfer.law_samples import CONDUCTING, varying
from tests.heat_conditions import surface_heat

SAMPLES = LAWS | {name: (varying(gap_heat_laws()[name]), None) for name in CONDUCTING}


def assert_derivative(balance: HeatBalance, columns: int) -> None:
    """Compare the product of the Jacobian and a direction with differences of the residual."""
    layout, unknowns = balance.layout, balance.unknowns
    start = balance.begin(unknowns.enthalpies(), unknowns.enthalpies(), 3.0, 1.0)
    direction, product, x = (layout.create_vector() for _ in range(3))
    direction.array[:] = 1e3 * np.cos(np.arange(len(start)) + layout.comm.rank)
    direction.array[unknowns.fixed] = 0.0
    x.array[:] = start + direction.array_r
    jacobian(balance, None, x, None, None)
    balance.jacobian.matrix.mult(direction, product)
    found = balance.solid_columns(x)
    assert len(found) == columns
    for u, v in found:
        assert abs(v.dot(direction)) > 0.0 < u.norm()
        product.axpy(v.dot(direction), u)
    plus, minus = (residual_at(balance, x.array_r + s * direction.array_r) for s in (1.0, -1.0))
    assert product.norm() > 0.0
    difference = product.duplicate()
    difference.array[:] = 0.5 * (plus - minus) - product.array_r
    # Nodes that pass a kink of the curves between the two states would spoil the difference.
    assert difference.norm() < 1e-5 * product.norm()


@pytest.mark.parametrize("name", SAMPLES)
def test_jacobian_is_the_derivative_of_the_residual(comm, name):
    """With the columns of U and V where the solid fraction of the casting acts on every pair."""
    mesh = cylinder(comm, size=8e-3)
    balance = balance_under_law(mesh, *SAMPLES[name])
    balance.exchanges.set_states([open_pairs(mesh)], 0.7)
    assert_derivative(balance, columns=int(name == "solid-fraction"))


@pytest.mark.ranks
@pytest.mark.parametrize("kind", ["perfect", "none"])
def test_prescribed_and_joined_nodes_have_their_derivatives(comm, kind):
    chilled = surface_heat("mould/outside", "temperature", value=90.0)
    mesh = cylinder(comm, size=8e-3)
    balance = balance_under_law(mesh, SERIES, None, [SURROUNDINGS[2], chilled], kind)
    assert_derivative(balance, columns=0)
    assert comm.allreduce(len(balance.unknowns.fixed)) > 0


@pytest.mark.ranks
def test_rows_without_a_balance_are_diagonal(comm):
    """Fixed unknowns have one entry of the size of a storage term, and keep the pattern."""
    chilled = surface_heat("mould/outside", "temperature", value=90.0)
    balance = balance_under_law(cylinder(comm, size=8e-3), SERIES, None, [chilled], "perfect")
    unknowns, matrix = balance.unknowns, balance.jacobian.matrix
    x = balance.layout.create_vector()
    x.array[:] = balance.begin(unknowns.enthalpies(), unknowns.enthalpies(), 3.0, 0.5)
    jacobian(balance, None, x, None, None)
    first = matrix.getOwnershipRange()[0]
    volume = comm.allreduce(unknowns.volumes.sum()) / balance.layout.size_global
    for row in unknowns.fixed + first:
        columns, values = matrix.getRow(row)
        assert dict(zip(columns[values != 0.0], values[values != 0.0], strict=True)) == {
            row: pytest.approx(volume / 0.5)
        }


def test_the_state_of_the_last_residual_serves_the_jacobian(comm, monkeypatch):
    """Until the unknowns or the step change."""
    mesh = cylinder(comm, size=8e-3)
    balance = balance_under_law(mesh, SERIES)
    x = balance.layout.create_vector()
    calls, update = [], balance.exchanges.update_faces
    monkeypatch.setattr(
        balance.exchanges, "update_faces", lambda *given: (calls.append(1), update(*given))
    )

    def matrix(part: float, fresh: bool) -> tuple[float, int]:
        """Return the norm of the Jacobian and how often the surfaces were updated for it."""
        balance.exchanges.set_states([open_pairs(mesh)], part)
        begun = balance.begin(balance.previous, balance.previous, 3.0, 1.0)
        x.array[:] = begun + (0.0 if fresh else 1e3)
        if not fresh:
            residual_at(balance, begun)
        residual_at(balance, x.array_r)
        before = len(calls)
        jacobian(balance, None, x, None, None)
        balance.solid_columns(x)
        return balance.jacobian.matrix.norm(), len(calls) - before

    first, updates = matrix(0.3, fresh=True)
    assert updates == 0
    other, updates = matrix(0.9, fresh=True)
    assert updates == 0 and other != first
    moved, updates = matrix(0.9, fresh=False)
    assert updates == 0 and moved != other
    x.array[:] = balance.begin(balance.previous, balance.previous, 3.0, 1.0)
    jacobian(balance, None, x, None, None)
    assert balance.jacobian.matrix.norm() == pytest.approx(other, rel=1e-12)
    x.array[:] += 1e3
    jacobian(balance, None, x, None, None)
    assert balance.jacobian.matrix.norm() == pytest.approx(moved, rel=1e-12)
