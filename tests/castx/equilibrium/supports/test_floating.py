"""Bodies in contact that nothing holds keep their places, and do not weigh on each other."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from tests.contact_methods import AT_ONCE
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, motion, problem, pushed

SOLID = (70e9, 0.33)
LIGHT, HEAVY = -2.4e4, -7.7e4
"""Weights of aluminium and steel [N/m³]."""


def loose(comm, upper, base, *, held=(), model="plane-strain", method="condensed", loads=()):
    """Return two blocks on each other after a solve."""
    down = (0.0,) * (1 if model == "plane-strain" else 2)
    bodies = {
        "upper": body(elastic(*SOLID), body_force=(*down, upper), loads=loads),
        "base": body(elastic(*SOLID), body_force=(*down, base)),
    }
    mesh = blocks(comm, model, base=(0.04, 0.02), symmetry=False)
    made = problem(mesh, bodies, {"base": list(held)}, [Contact("upper", "base", method)])
    made.equilibrium.solve(0.0)
    return made


def largest_motion(comm, made):
    return max(np.abs(everywhere(comm, motion(made, name))).max() for name in made.bodies)


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
@pytest.mark.parametrize(("upper", "base"), [(LIGHT, HEAVY), (HEAVY, LIGHT)])
def test_a_casting_and_its_chill_float_where_they_are(comm, method, upper, base):
    """On springs for what may still fall onto something they fall by 23 and 73 mm.

    Each is held against its own weight, but for the nodes between them, which pairs hold: a twelfth
    of the upper one.
    """
    made = loose(comm, upper, base, method=method)
    weights = [upper * 0.02 * 0.03, base * 0.04 * 0.02]
    assert largest_motion(comm, made) < 1e-5
    supports = made.equilibrium.supports()
    for name, weight in zip(("upper", "base"), weights, strict=True):
        np.testing.assert_allclose(supports[name].force, [0.0, -weight], atol=1e-4 * abs(weight))
    pressed = comm.allreduce(np.abs(made.pair_values()[1]).sum())
    assert pressed < 0.1 * abs(weights[0])


@pytest.mark.parametrize(("model", "common", "sliding"), [("plane-strain", 3, 1), ("3d", 6, 3)])
def test_all_motions_of_both_as_one_are_held_firmly(comm, model, common, sliding):
    """So are turns about the middle of both; on each other they slide on weak springs."""
    made = loose(comm, LIGHT, HEAVY, model=model)
    assert largest_motion(comm, made) < 1e-8
    stiffness = made.equilibrium.balance.operator.support.stiffness
    assert len(stiffness) == common + sliding
    np.testing.assert_allclose(stiffness / stiffness[-1], [1e7] * common + [1.0] * sliding)


def test_they_still_press_on_each_other_where_a_load_asks_for_it(comm):
    made = loose(comm, LIGHT, HEAVY, loads=(pushed("top", 1e6),))
    pressed = comm.allreduce(made.pair_values()[1].sum())
    # The push is held like weight, by the share of the base in the mass and by what joins them.
    share = HEAVY * 0.04 * 0.02 / (HEAVY * 0.04 * 0.02 + LIGHT * 0.02 * 0.03)
    assert pressed == pytest.approx(1e6 * 0.02 * share, rel=0.03)


def test_on_a_floor_they_weigh_on_each_other(comm):
    made = loose(comm, LIGHT, HEAVY, held=[fixed("bottom")])
    pressed = comm.allreduce(made.pair_values()[1].sum())
    assert pressed == pytest.approx(-LIGHT * 0.02 * 0.03, rel=1e-8)


@pytest.mark.ranks
@pytest.mark.parametrize("method", [m for m in AT_ONCE if m != "exponential"])
@pytest.mark.parametrize("stands", ["rigid", "on a floor"])
def test_a_body_that_leaves_one_that_stands_floats_where_it_is(comm, method, stands):
    """Nothing is there for it to fall onto; on weak springs it would fall by 36 mm.

    Pairs of the method "exponential" push it off even where they are far.
    """
    held = [fixed("bottom"), fixed("bottom", "x")]
    bodies = {"upper": body(elastic(*SOLID), body_force=(0.0, -LIGHT))}
    if stands != "rigid":
        bodies["base"] = body(elastic(*SOLID), body_force=(0.0, HEAVY))
    mesh = blocks(comm, base=(0.04, 0.02), symmetry=False)
    conditions = {} if stands == "rigid" else {"base": held}
    made = problem(mesh, bodies, conditions, [Contact("upper", "base", method)])
    made.equilibrium.solve(0.0)
    assert np.abs(everywhere(comm, motion(made, "upper"))).max() < 1e-5
    force, weight = made.equilibrium.supports()["upper"].force, -LIGHT * 0.02 * 0.03
    pressed = comm.allreduce(np.abs(made.pair_values()[1]).sum())
    assert pressed < 1e-3 * weight
    np.testing.assert_allclose(force, [0.0, -weight - pressed], atol=1e-6 * weight)


def test_a_body_that_slides_off_floats_where_it_is(comm):
    """Its weight along the top of a rigid body is held, that towards it is not."""
    bodies = {"upper": body(elastic(*SOLID), body_force=(-LIGHT, LIGHT))}
    mesh = blocks(comm, base=(0.04, 0.02), symmetry=False)
    made = problem(mesh, bodies, {}, [Contact("upper", "base")])
    made.equilibrium.solve(0.0)
    assert np.abs(everywhere(comm, motion(made, "upper")[:, :2])).max() < 1e-5
    weight = -LIGHT * 0.02 * 0.03
    force = made.equilibrium.supports()["upper"].force
    np.testing.assert_allclose(force, [-weight, 0.0], atol=1e-6 * weight)
    assert comm.allreduce(made.pair_values()[1].sum()) == pytest.approx(weight, rel=1e-6)


def test_a_body_above_another_falls_onto_it(comm):
    """Weak springs let it, and its gap closes."""

    def gap(points):
        return np.full(len(points), 1e-4)

    bodies = {"upper": body(elastic(*SOLID), body_force=(0.0, LIGHT))}
    mesh = blocks(comm, base=(0.04, 0.02), symmetry=False)
    made = problem(mesh, bodies, {}, [Contact("upper", "base", initial_gap=gap)])
    made.equilibrium.solve(0.0)
    weight = -LIGHT * 0.02 * 0.03
    assert comm.allreduce(made.pair_values()[1].sum()) == pytest.approx(weight, rel=0.05)
