"""Changes of the pairs between iterations: closing, opening, better multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.methods.registry import METHODS
from castx.equilibrium.pair_changes import PairChanges
from castx.equilibrium.supports.first_contact import OVERLAP
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table
from tests.contact_methods import AT_ONCE, EXACT
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    gaps,
    generated,
    heat,
    motion,
    problem,
)  # fmt: skip
from tests.small_contact import SOFT, STIFF, two_blocks


@dataclass(frozen=True)
class SimpleIterate:
    """The rows of an iterate."""

    rows: float


def vector() -> Any:
    """Return what takes the calls on a PETSc vector."""
    other = SimpleNamespace(waxpy=lambda *_: None, array_r=0.0, destroy=lambda: None)
    return SimpleNamespace(duplicate=lambda: other)


def pushed_down(made, by):
    """Return the unknowns of the solution with the upper block lower by some metres."""
    x, u = made.equilibrium.x.copy(), np.zeros(made.layout.size_local)
    u[made.layout.local_slice(0)].reshape(-1, 3)[:, 1] = -by
    x.array[: len(u)] += made.equilibrium.balance.transform.unknowns(u)
    return x


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_a_solution_keeps_its_pairs(comm, method):
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f, closed = x.duplicate(), balance.active.closed.copy()
    balance.residual(x, f)
    before = f.array_r.copy()
    assert not PairChanges(balance).update_pairs(x, f)
    np.testing.assert_array_equal(f.array_r, before)
    np.testing.assert_array_equal(balance.active.closed, closed)


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_pores_that_have_just_changed_ask_for_another_iterate(comm, monkeypatch, method):
    """Their rows are so weak that the balance of a pore far from its pressure counts as met."""
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f = x.duplicate()
    balance.residual(x, f)
    # On the last rank alone.
    last = comm.rank == comm.size - 1
    body = balance.assembly.bodies[0].formulation
    monkeypatch.setattr(type(body), "pores_changed", property(lambda self: last))
    assert PairChanges(balance).update_pairs(x, f)
    monkeypatch.undo()
    assert not PairChanges(balance).update_pairs(x, f)


@pytest.mark.parametrize("method", AT_ONCE)
def test_pairs_that_penetrate_close_and_the_residual_follows(comm, method):
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f, closed = x.duplicate(), everywhere(comm, balance.active.closed)
    assert {True, False} == set(closed)
    down = pushed_down(made, 1e-3)
    balance.residual(down, f)
    assert PairChanges(balance).update_pairs(down, f)
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
    improved = PairChanges(balance).improve_multipliers(down, f, balanced=True)
    assert improved == METHODS[method].updates_multipliers


@pytest.mark.parametrize("method", EXACT)
def test_a_linear_system_foretells_the_forces_at_the_end_of_a_step(comm, method):
    """They are those of the pairs there, since these bodies are linear."""
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    f, end = x.duplicate(), pushed_down(made, 1e-5)
    balance.residual(x, f)
    y = x.copy()
    y.axpy(-1.0, end)
    changes = PairChanges(balance)
    changes.foretell(x, y, balance.foretold_rows(y))
    balance.residual(end, f)
    closed = balance.active.closed
    there = everywhere(comm, balance.trial_forces[closed])
    np.testing.assert_allclose(
        everywhere(comm, changes.foretold[closed]), there, atol=1e-9 * np.abs(there).max()
    )


@pytest.mark.ranks
@pytest.mark.parametrize("contact", [{"friction": 0.3}, {"method": "penalty"}], ids=str)
def test_friction_and_soft_pairs_open_by_forces_of_their_own(comm, contact):
    made = two_blocks(comm, **contact)
    x, changes = made.equilibrium.x, PairChanges(made.equilibrium.balance)
    changes.foretell(x, x.copy(), np.zeros(x.local_size))
    assert changes.foretold is None


@pytest.mark.parametrize("method", EXACT)
def test_a_step_of_metal_that_flows_ends_where_open_pairs_overlap(comm, method, monkeypatch):
    """The upper block is pushed down by 1 mm; elastic ones go all the way, as sets that return."""
    made = two_blocks(comm, method)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    assert {True, False} == set(everywhere(comm, balance.active.closed))
    down, changes = pushed_down(made, 1e-3), PairChanges(balance)
    whole = x.copy()
    whole.axpy(-1.0, down)
    assert not changes.shorten_overlap(x, whole.copy())

    step, kind = whole.copy(), type(balance.assembly)
    monkeypatch.setattr(kind, "is_linear", False)
    monkeypatch.setattr(kind, "flows_by_rate", True)
    assert changes.shorten_overlap(x, step)
    end = x.copy()
    end.axpy(-1.0, step)
    f, is_open = x.duplicate(), ~balance.active.closed
    balance.residual(end, f)
    lowest = min(everywhere(comm, balance.iterate.gaps[is_open]))
    assert lowest == pytest.approx(
        -OVERLAP * min(b.length for b in balance.assembly.bodies), rel=1e-6
    )

    monkeypatch.setattr(kind, "flows_by_rate", False)
    assert not changes.shorten_overlap(x, whole.copy())
    monkeypatch.setattr(kind, "flows_by_rate", True)
    monkeypatch.setattr(type(balance.active), "cycles", True)
    assert not changes.shorten_overlap(x, whole.copy())


@pytest.mark.serial
@pytest.mark.parametrize(
    ("residual", "rounding", "noise"), [(1.0, 0.0, 0.5), (1e-6, 0.0, 1e-4), (1e-6, 2e-3, 2e-3)]
)
def test_noise_is_a_tenth_of_what_balances_and_a_hundred_residuals(residual, rounding, noise):
    """The smaller of both, so that exact solutions see far smaller forces, but not rounding."""
    thresholds = []

    def judge(forces, threshold, settled):
        thresholds.append(threshold)
        return False

    def update_friction(iterate, forces, threshold, settled):
        thresholds.append(threshold)
        return False

    none = np.zeros(2, dtype=bool)
    balance: Any = SimpleNamespace(
        active=SimpleNamespace(
            update=judge, closed=none, held=none, largest_pull=lambda forces: 0.0
        ),
        assembly=SimpleNamespace(
            improve_pressures=lambda: False, unknowns=None, flows_by_rate=True, pores_changed=False
        ),
        contact=SimpleNamespace(
            update_friction=update_friction, has_friction=False, hold=lambda held: None
        ),
        convergence=SimpleNamespace(
            smallest=5.0, weakest=1e3, rounding=rounding, is_met=lambda f: False
        ),
        supports=SimpleNamespace(change=lambda closed, all_quiet: False), is_linear=True,
        is_evaluated_at=lambda x: True, present=lambda x: x, trial_forces=np.zeros(2),
        felt=lambda forces: forces,
    )  # fmt: skip
    f: Any = SimpleNamespace(norm=lambda: residual)
    x: Any = None
    assert not PairChanges(balance).update_pairs(x, f)
    assert thresholds == pytest.approx([noise, noise], rel=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("residual", "forces"), [(10.0, [0.0, -40.0]), (1.01, [0.0, -40.0]), (0.99, [-1.5, -2.0])]
)
def test_the_first_that_liquid_holds_lets_go_in_equilibrium_alone(residual, forces):
    """Of two pairs that the linear system sees pulled the free one opens at once.

    The other one lets go by what liquid feels, once the residual is half of the largest pull
    beyond its limit, 2 N. From then on forces are foretold for both, as liquid feels them, until
    another solve begins.
    """
    judged: list[float] = []

    def judge(forces, threshold, settled):
        judged[:] = forces
        return False

    held = np.array([True, False])
    closed, trial = np.ones(2, dtype=bool), np.array([-1.0, -2.0])
    balance: Any = SimpleNamespace(
        active=SimpleNamespace(
            update=judge, closed=closed, held=held, one_by_one=False,
            largest_pull=lambda forces: 2.0,
        ),
        assembly=SimpleNamespace(
            improve_pressures=lambda: False, flows_by_rate=True, unknowns=None
        ),
        contact=SimpleNamespace(
            update_friction=lambda *_: False, has_friction=False, hold=lambda held: None,
            unknowns=None,
            normal=SimpleNamespace(
                follows_set=False, trial_forces=lambda iterate: np.array([-30.0, -40.0])
            ),
        ),
        convergence=SimpleNamespace(
            smallest=0.1, weakest=1e3, rounding=0.0, is_met=lambda f: False
        ),
        supports=SimpleNamespace(change=lambda closed, all_quiet: True), is_linear=False,
        is_evaluated_at=lambda x: True, iterate=SimpleIterate(0.0),
        present=lambda x: SimpleIterate(0.0), trial_forces=trial, sum_up_again=lambda x, f: None,
        felt=lambda forces: np.where(held, forces - 0.5, forces),
    )  # fmt: skip
    x: Any = vector()
    changes = PairChanges(balance)
    changes.foretell(x, x, np.zeros(2))
    assert changes.foretold is not None
    f: Any = SimpleNamespace(norm=lambda: residual)
    assert changes.update_pairs(x, f)
    assert judged == pytest.approx(forces)

    settled, far = residual < 1.0, SimpleNamespace(norm=lambda: 10.0)
    assert changes.update_pairs(x, far)
    assert judged == pytest.approx([-30.5 if settled else 0.0, -40.0])
    changes.begin()
    changes.foretell(x, x, np.zeros(2))
    assert changes.update_pairs(x, far)
    assert judged == pytest.approx([0.0, -40.0])


@pytest.mark.parametrize("method", EXACT)
def test_a_wall_pushes_a_body_and_draws_none_along(comm, method):
    """Without weight, touching pairs bear nothing: the body stays where it was left."""
    way = Table.from_points([(0, 0.0), (1, 2e-5), (2, 0.0), (3, -1e-5), (4, 3e-5)])
    held = {"x": Table.constant(0.0), "y": way}
    base = [SurfaceDisplacement("bottom", axis, table) for axis, table in held.items()]
    mesh = blocks(comm, symmetry=False, size=0.01)
    bodies = {"upper": body(elastic(*SOFT)), "base": body(elastic(*STIFF))}
    made = problem(mesh, bodies, {"base": base}, [Contact("upper", "base", method)])
    for time, height in ((0.0, 0.0), (1.0, 2e-5), (2.0, 2e-5), (3.0, 2e-5), (4.0, 3e-5)):
        made.equilibrium.solve(time)
        made.equilibrium.commit()
        moved = everywhere(comm, motion(made, "upper"))
        np.testing.assert_allclose(moved[:, 1], height, atol=1e-11)
        np.testing.assert_allclose(moved[:, 0], 0.0, atol=1e-11)
        open_by = height - way(time)
        np.testing.assert_allclose(everywhere(comm, gaps(comm, made)), open_by, atol=1e-11)
        assert made.equilibrium.active.frozen_pairs() == 0


@pytest.mark.ranks
@pytest.mark.parametrize("method", EXACT)
def test_a_body_that_is_pressed_hard_stops_at_a_wall_where_its_pairs_close(comm, method):
    """Clamped between floor and lid, a weight of 0.1 N moves it sideways.

    Pairs do not change by a part of 1e-12 of the force that another one carries. The motion ended
    where the first pair of the wall had a smaller force than that, and no iteration went on.
    """
    mesh = generated(
        comm, "plane-strain", "box_in_mould", ["casting", "mould"],
        box=[0.04, 0.02], wall=0.01, size=0.02, lid=True,
    )  # fmt: skip
    contact = Contact(
        "casting", "mould", method,
        initial_gap=lambda points: np.where(np.abs(points[:, 0]) > 0.019, 1e-4, 0.0),
    )  # fmt: skip
    weight = 0.1 / (0.04 * 0.02)
    metal = body(elastic(*SOFT, expansion=2e-5), body_force=(weight, 0.0))
    made = problem(mesh, {"casting": metal}, {}, [contact], tolerance=1e-9)
    heat(made, 120.0)
    report = made.equilibrium.solve(0.0)
    assert report.iterations < 5
    forces = everywhere(comm, made.pair_values()[1])
    assert forces.max() > 1e5
    assert forces[forces < 1.0].sum() == pytest.approx(0.1, rel=1e-5)
