"""Balance of momentum: its derivative for every method, and what is committed or rewound."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.mechanics.description import SurfaceLoad
from castx.tables import Table
from tests.contact_methods import AT_ONCE, TWO_BODIES
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem, pushed
from tests.partitions import PARTITION, on_the_last
from tests.small_contact import SOFT, STIFF, two_blocks, waves

pytestmark = pytest.mark.sampled


@pytest.mark.ranks
@pytest.mark.parametrize("method", TWO_BODIES)
def test_jacobian_against_differences_of_the_residual(comm, method):
    """OSGS, held rows, closed pairs, springs and multipliers included."""
    mesh = blocks(comm, symmetry=False, size=0.01)
    loads = (pushed("top", 1e6),)
    bodies = {"upper": body(elastic(*SOFT), loads=loads), "base": body(elastic(*STIFF))}
    held = {"base": [fixed("bottom", "all")]}
    made = problem(mesh, bodies, held, [Contact("upper", "base", method)])
    made.equilibrium.solve(0.0)
    equilibrium = made.equilibrium
    x = equilibrium.x.duplicate()
    first = int(comm.exscan(x.getLocalSize()) or 0)
    direction = x.duplicate()
    direction.array[:] = 1e-8 * np.sin(1.0 + 0.7 * (first + np.arange(x.getLocalSize())))
    results = []
    for sign in (1.0, -1.0):
        equilibrium.x.copy(x)
        x.axpy(sign, direction)
        f = x.duplicate()
        equilibrium.balance.residual(x, f)
        results.append(f.array_r.copy())
    product = x.duplicate()
    equilibrium.balance.operator.mult(None, direction, product)
    difference = (results[0] - results[1]) / 2
    scale = comm.allreduce(np.abs(difference).max(initial=0.0), op=max)
    np.testing.assert_allclose(difference, product.array_r, atol=1e-6 * scale)


@pytest.mark.parametrize("method", AT_ONCE)
def test_rows_of_constrained_unknowns_are_their_distances(comm, method):
    """A prescribed displacement that is missed by δ has the row stiffness · δ."""
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f = x.duplicate()
    missed = x.copy()
    for item in balance.transform.prescribed:
        missed.array[item.local] += 1e-6
    balance.residual(missed, f)
    rows = np.concatenate([f.array_r[item.local] for item in balance.transform.prescribed])
    np.testing.assert_allclose(rows, balance.stiffness * 1e-6, rtol=1e-9)
    local = np.concatenate([item.local for item in balance.transform.prescribed])
    assert np.all(balance.operator.constrained[local])


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_frozen_unknowns_have_no_residual(comm, method):
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    moved, f = x.copy(), x.duplicate()
    moved.array[:] += 1e-6 * waves(x)
    balance.frozen[::2] = True
    balance.residual(moved, f)
    assert np.all(f.array_r[::2] == 0.0)
    assert np.abs(everywhere(comm, f.array_r[1::2].copy())).max() > 1.0


def test_a_residual_that_nobody_judges_is_the_same_and_measures_no_forces(comm):
    made = two_blocks(comm, "condensed")
    balance, x = made.equilibrium.balance, made.equilibrium.x
    far, f, judged = x.copy(), x.duplicate(), x.duplicate()
    far.array[:] += 1e-4 * waves(x)
    balance.residual(x, f)
    near = balance.convergence.weakest
    balance.residual(far, f, judged=False)
    assert balance.convergence.weakest == near
    balance.residual(far, judged)
    np.testing.assert_array_equal(f.array_r, judged.array_r)
    assert balance.convergence.weakest > 2.0 * near


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_rewound_state_has_the_residual_of_the_accepted_one(comm, method):
    made = two_blocks(comm, method)
    made.equilibrium.commit()
    balance, x = made.equilibrium.balance, made.equilibrium.x
    accepted, f = x.array_r.copy(), x.duplicate()
    balance.residual(x, f)
    before, closed = f.array_r.copy(), balance.active.closed.copy()
    x.array[:] += 1e-5 * waves(x)
    balance.active.closed = ~closed
    made.equilibrium.rewind()
    np.testing.assert_array_equal(x.array_r, accepted)
    balance.residual(x, f)
    np.testing.assert_array_equal(f.array_r, before)
    np.testing.assert_array_equal(balance.active.closed, closed)


def test_a_rewound_state_has_the_loads_of_the_accepted_one(comm):
    """It balances what pressed on it at the end of the last accepted step."""
    rising = SurfaceLoad("top", pressure=Table.from_points([[0.0, 0.0], [4.0, 4e6]]))
    bodies = {"upper": body(elastic(*SOFT), loads=(rising,)), "base": body(elastic(*STIFF))}
    held = {"base": [fixed("bottom", "all")]}
    made = problem(blocks(comm, size=0.01), bodies, held, [Contact("upper", "base", "condensed")])
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f = x.duplicate()

    def unbalanced() -> float:
        balance.residual(x, f)
        return float(f.norm())

    made.equilibrium.solve(1.0)
    made.equilibrium.commit()
    accepted = unbalanced()
    made.equilibrium.solve(3.0)
    made.equilibrium.rewind()
    assert unbalanced() == pytest.approx(accepted, abs=1e-6 * 1e6 * 0.01)


@pytest.mark.ranks
def test_all_ranks_constrain_with_the_stiffness_of_the_stiffest_row(comm, monkeypatch):
    expected = two_blocks(MPI.COMM_SELF).equilibrium.balance.stiffness
    monkeypatch.setattr(PARTITION, on_the_last)
    assert two_blocks(comm).equilibrium.balance.stiffness == pytest.approx(expected, rel=1e-9)


@pytest.mark.ranks
def test_where_it_is_evaluated(comm):
    made = two_blocks(comm)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    balance.residual(x, x.duplicate())
    assert balance.is_evaluated_at(x)
    moved = x.copy()
    if comm.rank == comm.size - 1:
        moved.array[0] += 1e-9
    assert not balance.is_evaluated_at(moved)


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_forces_beyond_foretold_ones_are_the_gradient_of_an_energy(comm, method):
    """Rows of constrained unknowns are those of A y before a step y of linear bodies, zero behind.

    How far the unknowns are from their place does not matter.
    """
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    bodies = slice(balance.assembly.layout.size_local)
    end, f, y, change = x.copy(), x.duplicate(), x.copy(), x.duplicate()
    end.array[bodies] += 1e-7 * waves(x)[bodies]
    y.axpy(-1.0, end)
    balance.residual(x, f)
    foretold = balance.foretold_rows(y)
    balance.take_off(foretold, f)
    balance.operator.free_product(y, change)
    constrained = balance.operator.constrained.copy()
    constrained[bodies.stop :] = False
    np.testing.assert_allclose(f.array_r[constrained], change.array_r[constrained], rtol=1e-9)
    balance.residual(end, f)
    balance.take_off(foretold, f)
    scale = comm.allreduce(np.abs(change.array_r).max(initial=0.0), op=MPI.MAX)
    np.testing.assert_allclose(f.array_r[constrained], 0.0, atol=1e-9 * scale)
