"""Supports at work: springs about their origin, and forces on the bodies."""

from __future__ import annotations

import numpy as np
import pytest

from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem, pulled
from tests.small_contact import SOFT

PULL = 3e4


def hanging(comm, **settings):
    """Return a block without contact that is pulled sideways."""
    bodies = {"upper": body(elastic(*SOFT), loads=(pulled("top", PULL, 0.0),)),
              "base": body(elastic(*SOFT))}  # fmt: skip
    mesh = blocks(comm, symmetry=False, size=0.01)
    made = problem(mesh, bodies, {"base": [fixed("bottom", "all")]}, **settings)
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.ranks
def test_springs_bear_the_load_of_a_body_that_nothing_holds(comm):
    made = hanging(comm)
    supports = made.equilibrium.supports()
    np.testing.assert_allclose(supports["upper"].force, [-PULL * 0.02, 0.0], atol=1e-6)
    np.testing.assert_allclose(supports["base"].force, 0.0, atol=1e-6)
    # Against the moment of the pull about the centre, 15 mm below it.
    assert supports["upper"].moment[0] == pytest.approx(PULL * 0.02 * 0.015, rel=1e-6)


@pytest.mark.ranks
def test_springs_are_without_force_at_their_origin(comm):
    made = hanging(comm)
    acting, x = made.equilibrium.balance.supports, made.equilibrium.x
    assert acting.springs is not None and len(acting.springs.motions) == 3
    acting.origin[:] = x.array_r
    forces = acting.spring_forces(x.array_r)
    assert forces is not None and np.all(forces == 0.0)
    rows = np.zeros(made.layout.size_local)
    assert acting.norm(x.array_r, rows) == 0.0


def test_rewound_springs_are_those_of_the_accepted_state(comm):
    made = hanging(comm)
    acting, x = made.equilibrium.balance.supports, made.equilibrium.x
    made.equilibrium.commit()
    accepted = acting.springs
    acting.find_springs(np.ones(x.getLocalSize(), dtype=bool), None)
    assert acting.springs is None
    acting.rewind(x.array_r)
    assert acting.springs is accepted
    acting.adopt()
    acting.rewind(x.array_r)
    assert acting.springs is None


def test_what_is_fixed_gets_no_springs(comm):
    made = hanging(comm)
    acting = made.equilibrium.balance.supports
    assert acting.motions is not None and len(acting.motions) == 6
    constrained = made.equilibrium.balance.operator.constrained
    acting.find_springs(constrained, np.eye(6))
    assert acting.springs is None
    assert everywhere(comm, constrained).any()


def test_what_comes_onto_springs_stays_where_it_was_and_what_hangs_does_not_fall(comm):
    """The loaded block keeps its place on the springs, however many steps are accepted."""
    made = hanging(comm)
    acting, x = made.equilibrium.balance.supports, made.equilibrium.x
    place = x.array_r.copy()
    for _ in range(3):
        made.equilibrium.commit()
        made.equilibrium.solve(0.0)
        np.testing.assert_allclose(x.array_r, place, atol=1e-9 * np.abs(place).max(initial=1.0))
    acting.springs = None
    acting.commit(x.array_r)
    np.testing.assert_array_equal(acting.origin, x.array_r)
