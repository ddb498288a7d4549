"""Which bodies fall without end, of masses in the plane that move along x and y."""

from __future__ import annotations

import numpy as np
import pytest

from castx.equilibrium.supports.falling import BodiesTogether, completed

pytestmark = pytest.mark.serial

X, Y = np.eye(2)
DOWN = -Y


def together(*weights, gaps=(), volumes=None):
    """Return masses of one weight for each body, joined by contact, with the gaps that change.

    Args:
        weights: of the masses along x and y.
        gaps: for each, the direction in which it grows as each mass moves.
        volumes: of the masses; None: one each.
    """
    count = len(weights)
    weight = np.array(weights)
    volume = np.ones(count) if volumes is None else np.array(volumes)
    return BodiesTogether(
        body=np.repeat(np.arange(count), 2),
        common=np.tile(np.eye(2), count),
        weight=weight,
        volume=volume,
        density=np.linalg.norm(weight, axis=1) / volume,
        gaps=np.array(gaps, dtype=float).reshape(-1, 2 * count),
    )


def gram(count, *rows):
    """Return the products of what the motions do to constraint rows."""
    given = np.array(rows, dtype=float).reshape(-1, 2 * count)
    return given.T @ given


def row(*directions):
    return np.concatenate(directions)


NONE = np.zeros(2)
BOTH = np.array([[1.0, 0, 1, 0], [0, 1.0, 0, 1]])
TWO = (5 * DOWN, 5 * DOWN)


def falling(bodies, constraints=()):
    """Return the free motions of each set of bodies that fall as one."""
    return [motions for motions, _ in bodies.falling(gram(len(bodies.volume), *constraints))]


def test_without_constraints_they_fall_in_all_directions():
    (found,) = falling(together(*TWO))
    np.testing.assert_allclose(np.abs(found), BOTH)


def test_what_joins_them_does_not_hold_them():
    (found,) = falling(together(*TWO), [row(X, -X), row(Y, -Y)])
    np.testing.assert_allclose(np.abs(found), BOTH)


def test_on_a_floor_they_do_not_fall_though_they_may_slide():
    assert falling(together(*TWO), [row(NONE, Y), row(Y, -Y)]) == []


def test_a_rounded_weight_along_the_floor_makes_nothing_fall():
    leaning = (np.array([5e-11, -5.0]), 5 * DOWN)
    assert falling(together(*leaning), [row(NONE, Y), row(Y, -Y)]) == []


def test_between_walls_they_fall_and_move_in_no_other_way():
    ((along,),) = falling(together((1e-12, -2.5), (0.0, -2.5)), [row(X, NONE), row(X, -X)])
    np.testing.assert_allclose(np.abs(along), [0, 1, 0, 1], atol=1e-14)


def test_without_weight_nothing_falls():
    assert falling(together(NONE, NONE)) == []
    assert falling(together(5 * DOWN, NONE), [row(Y, -Y)]) == []


def test_a_body_alone_falls():
    (found,) = falling(together(5 * DOWN))
    np.testing.assert_allclose(np.abs(found), np.eye(2))


def test_a_body_falls_off_one_that_is_held():
    """The first is held; the second hangs under it by nothing, and stands upon it else."""
    under = together(*TWO, gaps=[row(Y, -Y)])
    (second,) = falling(under, [row(X, NONE), row(Y, NONE)])
    np.testing.assert_allclose(np.abs(second), [[0, 0, 1, 0], [0, 0, 0, 1]], atol=1e-14)
    upon = together(*TWO, gaps=[row(-Y, Y)])
    assert falling(upon, [row(X, NONE), row(Y, NONE)]) == []


@pytest.mark.parametrize(("lean", "falls"), [(0.0, True), (1e-4, True), (1e-2, False)])
def test_beside_an_upright_wall_they_fall_without_end(lean, falls):
    """A gap to a body that has no motions, such as a rigid one; the wall leans below them."""
    bodies = together(*TWO, gaps=[row(X + lean * Y, NONE)])
    assert bool(falling(bodies, [row(X, -X), row(Y, -Y)])) == falls


def test_what_falls_too_is_no_obstacle():
    """The first is above the second, and nothing is below that."""
    (found,) = falling(together(*TWO, gaps=[row(Y, -Y)]))
    np.testing.assert_allclose(np.abs(found), BOTH)


def test_bodies_that_will_be_stopped_stop_those_upon_them():
    """A floor is below the second, the first above the second, and the third beside them."""
    bodies = together(*TWO, 5 * DOWN, gaps=[row(NONE, Y, NONE), row(Y, -Y, NONE)])
    (found,) = falling(bodies)
    np.testing.assert_allclose(np.abs(found), [[0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]])


def test_bodies_that_slide_in_different_directions_do_so_apart():
    """One slide leads to the right, the other one to the left, where a wall may stand."""
    slides = [row(X + Y, NONE), row(NONE, X - Y)]
    found = falling(together(*TWO), slides)
    np.testing.assert_allclose(
        np.abs(np.concatenate(found)), np.sqrt(0.5) * np.array([[1, 1, 0, 0], [0, 0, 1, 1]])
    )
    (first,) = falling(together(*TWO, gaps=[row(NONE, X)]), slides)
    np.testing.assert_allclose(np.abs(first), np.sqrt(0.5) * np.array([[1, 1, 0, 0]]))


def test_forces_are_spread_like_the_weight_of_those_that_fall():
    """Beside the mean, 16 N in 4 m³: so that each is held against its own weight."""
    bodies = together(12 * DOWN, 4 * DOWN, 7 * DOWN, volumes=[1.0, 3.0, 2.0])
    ((_, density),) = bodies.falling(gram(3, row(NONE, NONE, X), row(NONE, NONE, Y)))
    np.testing.assert_allclose(density, [3, 3, 1 / 3, 1 / 3, 1, 1])


def test_some_motions_are_completed_to_a_basis():
    free = np.linalg.qr(np.random.default_rng(1).normal(size=(4, 3)))[0].T
    first = np.array([[1.0, 2.0, 0.0]]) @ free
    found = completed(first, free)
    np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(found @ free.T @ free, found, atol=1e-14)
    np.testing.assert_allclose(np.abs(found[0]), np.abs(first[0]) / np.sqrt(5.0), atol=1e-14)
    assert completed(first[:0], free) is free
