"""Nodes that are fed, and the pressure on their melt, on a slab of 20 mm by 10 mm."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.mechanics.mush.feeding import FedNodes
from tests.castx.mechanics.lone_bodies import LENGTH, WIDTH, slab

pytestmark = pytest.mark.sampled

WEIGHT = np.array([0.0, -2e4])


def fed(comm, feeders, closed=(), pressures=None):
    body = slab(comm)
    given = pressures or {}
    return body, FedNodes(body, "plane-strain", feeders, closed, WEIGHT, lambda: given)


def test_named_feeders_and_free_surfaces(comm):
    body, named = fed(comm, ("far",))
    x, y = body.points[:, 0], body.points[:, 1]
    liquid = np.where(y > 0.7 * WIDTH, 0.02, 0.021)
    named.begin(liquid, 0.02)
    np.testing.assert_array_equal(named.nodes, np.isclose(x, LENGTH) & (y < 0.7 * WIDTH))
    body, free = fed(comm, None, ("wall", "bottom", "far"))
    free.begin(np.ones(len(x)), 0.02)
    np.testing.assert_array_equal(free.nodes, np.isclose(y, WIDTH))
    _, none = fed(comm, ())
    none.begin(np.ones(len(x)), 0.02)
    assert not none.nodes.any()


@pytest.mark.ranks
def test_head_below_the_highest_point_and_gas(comm):
    """At the far end −ρ g depth, and 3 kPa of gas; at the top no head but its own."""
    body, found = fed(comm, ("far", "top"), pressures={"far": 3e3})
    y = body.points[:, 1]
    found.begin(np.ones(len(y)), 0.02)
    far = np.isclose(body.points[:, 0], LENGTH) & ~np.isclose(y, WIDTH)
    np.testing.assert_allclose(
        found.mean_stress(np.zeros(2))[far], -3e3 - 2e4 * (WIDTH - y[far]), rtol=1e-12
    )
    top = np.isclose(y, WIDTH) & ~np.isclose(body.points[:, 0], LENGTH)
    np.testing.assert_allclose(found.mean_stress(np.zeros(2))[top], 0.0, atol=1e-9)


@pytest.mark.ranks
def test_the_head_pushes_on_the_surface(comm):
    """Its resultant is −ρ g W²/2 along the normal, of what is fed only."""
    body, found = fed(comm, ("far",))
    y = body.points[:, 1]
    space = fem.functionspace(body.mesh, ("Lagrange", 1, (2,)))
    work = fem.form(found.virtual_work(ufl.TestFunction(space)))

    def resultant() -> float:
        found.use(found.head(np.zeros(1)))
        rows = fem.assemble_vector(work).array.reshape(-1, 2)[:, 0]
        return comm.allreduce(float(rows.sum()))

    found.begin(np.ones(len(y)), 0.02)
    assert resultant() == pytest.approx(-0.5 * 2e4 * WIDTH**2, rel=1e-12)
    found.begin(np.zeros(len(y)), 0.02)
    assert resultant() == 0.0


@pytest.mark.ranks
def test_levels_that_sink(comm):
    """The top is 20 mm wide, the far end has no horizontal area; the head falls with the level."""
    body, found = fed(comm, ("top", "far"))
    np.testing.assert_allclose(found.areas, [LENGTH, 0.0], atol=1e-15)
    top = np.isclose(body.points[:, 1], WIDTH)
    found.begin(np.ones(len(top)), 0.02)
    fall = found.head(np.array([1e-3, 0.0])) - found.head(np.zeros(2))
    np.testing.assert_allclose(fall, np.where(top, -20.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(1e-3 * found.of_metre(0), fall, atol=1e-12)
