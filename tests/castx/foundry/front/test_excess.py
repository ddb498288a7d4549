"""Excess of enthalpies: none at nodes where the front stands, as brute force finds their means."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.excess import PLACES, Excess, Step, narrowed
from castx.foundry.front.gradients import midpoint_gradients
from castx.foundry.front.levels import Level
from castx.foundry.front.passing import Front
from tests.castx.fakes import slab_mesh
from tests.castx.foundry.front.test_passing import LATENT, LEFT, SPEED, Curve, enthalpies

SIZE, COLUMN = 1e-3, 3


def with_a_front(comm, place):
    """Return body, excess, parts and rest of a slab whose front stands beside a column of nodes.

    Args:
        comm: communicator.
        place: of the front, in widths of a control volume from the column.
    """
    body = slab_mesh(comm, SIZE, 6 * SIZE).bodies["casting"]
    volumes, levels = ControlVolumes(body), [Level.of(Curve(), 1.0)]
    enthalpy = enthalpies(body, (COLUMN + place) * SIZE / SPEED)
    _, sizes = midpoint_gradients(body.nodes, body.points[volumes.cell_nodes])
    rest = Step(enthalpy, enthalpy)
    parts = Front(body, Curve(), levels, volumes).parts(rest)
    return body, Excess(Curve(), levels, volumes, sizes), [parts] * len(PLACES), rest


@pytest.mark.ranks
@pytest.mark.parametrize("place", range(len(PLACES)))
def test_a_node_with_the_front_at_its_place_has_no_excess(comm, place):
    """Of the heat that the eutectic sets free; nodes ahead have some, and those behind lack it."""
    body, excess, parts, rest = with_a_front(comm, PLACES[place])
    found = excess.at(rest, 0.0, parts)[0, place] / (LEFT * LATENT)
    column = np.rint(body.points[:, 0] / SIZE)
    np.testing.assert_allclose(found[column == COLUMN], 0.0, atol=0.08)
    assert (found[column > COLUMN] > 0.1).all() and (found[column < COLUMN] < -0.02).all()


def test_shares_of_their_own_and_one_for_all_give_the_same(comm):
    _, excess, parts, rest = with_a_front(comm, 0.2)
    step = Step(rest.start, rest.start - 0.1 * LATENT)
    every = np.full((1, len(PLACES), rest.start.size), 0.3)
    np.testing.assert_array_equal(excess.after(step, every, parts), excess.at(step, 0.3, parts))


def test_nodes_asked_for_alone_have_the_excess_that_they_have_among_all(comm):
    body, excess, parts, rest = with_a_front(comm, 0.2)
    some = np.tile(body.points[:, 0] < 3.5 * SIZE, (len(PLACES), 1))
    few = narrowed(parts, some)
    assert all(len(part.nodes) < len(whole.nodes) for part, whole in zip(few, parts, strict=True))
    found, whole = (excess.at(rest, 0.0, of)[0] for of in (few, parts))
    np.testing.assert_allclose(found[some], whole[some], rtol=1e-12, atol=1e-6 * LATENT)
