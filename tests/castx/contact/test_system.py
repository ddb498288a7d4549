"""Contact of all interfaces by every method: action is reaction, complementarity, memory."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.methods.description import UnknownKind
from castx.contact.methods.registry import METHODS
from tests.contact_methods import AT_ONCE, EXACT, WITH_FRICTION, sharp
from tests.elastic_bodies import (
    body,
    elastic,
    everywhere,
    gaps,
    generated,
    heat,
    motion,
    pressures,
    problem,
)
from tests.small_contact import two_blocks

pytestmark = pytest.mark.sampled

SOFT, STIFF = (7e9, 0.33), (70e9, 0.3)


def ring(comm, method: str, overlap: float = -2e-5, **law):
    """Return a hot ring on a core, of which a part has come off."""
    mesh = generated(
        comm, "plane-strain", "core_in_ring", ["core", "casting"],
        core_radius=0.03, outer_radius=0.05, size=0.004,
    )  # fmt: skip
    bodies = {
        "core": body(elastic(*STIFF, 1e-5), **law),
        "casting": body(elastic(*SOFT, 2e-5), **law),
    }
    contact = Contact("casting", "core", method, lambda x: overlap + 2e-3 * x[:, 0])
    made = problem(mesh, bodies, {}, [contact])
    heat(made, lambda x: 20 - 2e3 * x[:, 0])
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.parametrize(
    "law", [{}, {"formulation": "displacement"}], ids=["mixed", "displacement"]
)
@pytest.mark.parametrize("method", AT_ONCE)
def test_action_is_reaction(comm, method, law):
    """At every pair the forces of the two bodies are ±f n, and nothing acts elsewhere."""
    made = ring(comm, method, **law)
    pairs, normals = made.pairs[0], made.gaps.interfaces[0].normals
    forces = made.pair_values()[1]
    inside = np.all(pairs.points > 1e-9, axis=1)
    expected = (forces[:, None] * normals)[inside]
    residuals = {
        n: everywhere(comm, b.residual().reshape(-1, b.block_size)[:, :2])
        for n, b in made.bodies.items()
    }
    largest = everywhere(comm, forces).max()
    np.testing.assert_allclose(
        residuals["casting"][pairs.secondary_nodes[inside]], expected, atol=1e-10 * largest
    )
    np.testing.assert_allclose(
        residuals["core"][pairs.primary_nodes[inside]], -expected, atol=1e-10 * largest
    )
    assert 0 < np.count_nonzero(everywhere(comm, forces))
    if method in sharp(AT_ONCE):
        assert np.count_nonzero(everywhere(comm, forces)) < len(everywhere(comm, forces))


def test_methods_agree_pair_by_pair(comm):
    condensed, multipliers = (ring(comm, method) for method in EXACT)
    largest = pressures(comm, condensed).max()
    np.testing.assert_allclose(
        pressures(comm, condensed), pressures(comm, multipliers), atol=1e-10 * largest
    )
    for name in condensed.bodies:
        expected = everywhere(comm, motion(multipliers, name)[:, :2])
        size = np.abs(expected).max()
        found = everywhere(comm, motion(condensed, name)[:, :2])
        np.testing.assert_allclose(found, expected, atol=1e-10 * size)
    np.testing.assert_allclose(gaps(comm, condensed), gaps(comm, multipliers), atol=1e-14)


@pytest.mark.parametrize("method", EXACT)
def test_complementarity(comm, method):
    made = ring(comm, method)
    gap, pressure = gaps(comm, made), pressures(comm, made)
    assert gap.min() > -1e-12
    assert pressure.min() >= -1e-12 * pressure.max()
    assert np.abs(gap * pressure).max() < 1e-12 * pressure.max()
    assert 0 < np.count_nonzero(pressure) < len(pressure)


@pytest.mark.parametrize("method", AT_ONCE)
def test_what_the_matrix_depends_on(comm, method):
    """Closed pairs where they are springs; nothing where they are conditions on unknowns."""
    contact = two_blocks(comm, method).equilibrium.balance.contact
    springs = METHODS[method].unknowns is UnknownKind.DISPLACEMENTS
    assert contact.follows_set == springs
    closed = np.array([True, False, True])
    np.testing.assert_array_equal(contact.state(closed), closed if springs else [])


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_friction_makes_the_matrix_follow_the_pairs(comm, method):
    balance = two_blocks(comm, method, friction=0.3).equilibrium.balance
    assert balance.contact.follows_set and not balance.contact.is_linear
    closed = balance.active.closed
    assert len(balance.contact.state(closed)) == 2 * len(closed)
    np.testing.assert_array_equal(balance.contact.state(closed)[: len(closed)], closed)


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("method", AT_ONCE)
def test_what_pairs_remember_is_restored(comm, method, friction):
    if friction and not METHODS[method].friction:
        pytest.skip("the method has no friction")
    more = {"friction": 0.3} if friction else {}
    made = two_blocks(comm, method, **more)
    made.equilibrium.commit()
    saved = {n: array.copy() for n, array in made.equilibrium.balance.contact.saved().items()}
    assert bool(saved) == (friction or METHODS[method].updates_multipliers)
    other = two_blocks(comm, method, solved=False, **more)
    other.equilibrium.balance.contact.restore(saved)
    for name, array in other.equilibrium.balance.contact.saved().items():
        np.testing.assert_array_equal(array, saved[name])
        assert array.shape == made.gaps.local.shape
