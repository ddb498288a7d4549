"""Gaps as a linear function of the displacements, with rigid and with new bodies."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem
from tests.small_contact import SOFT, two_blocks


def test_gap_matrix_of_planes(comm):
    """The gap of two rigid motions is that of two planes."""
    mesh = blocks(comm, symmetry=False)
    made = problem(
        mesh, {n: body(elastic(*SOFT)) for n in ("upper", "base")}, {"base": [fixed("bottom")]},
        [Contact("upper", "base", initial_gap=lambda x: 1e-3 + x[:, 0])],
    )  # fmt: skip
    vector = made.layout.create_vector()
    for b, part in enumerate(made.bodies.values()):
        owned = part.space.dofmap.index_map.size_local
        x = part.mesh.nodes.tabulate_dof_coordinates()[:owned]
        values = np.zeros((owned, 3))
        values[:, 0] = 7.0
        values[:, 1] = 2.0 + 3.0 * x[:, 0] if b == 0 else 1.0 - 5.0 * x[:, 0]
        vector.array[made.layout.local_slice(b)] = values.ravel()
    x = made.pairs[0].points[:, 0]
    np.testing.assert_allclose(made.gaps.values(vector), 1e-3 + x + 1.0 + 8.0 * x, atol=1e-14)


@pytest.mark.ranks
def test_a_rigid_body_that_rises_closes_gaps(comm):
    rising = SurfaceDisplacement("bottom", "y", Table.from_points([(0.0, 0.0), (2.0, 4e-4)]))
    made = problem(
        blocks(comm), {"upper": body(elastic(*SOFT))}, {"base": [rising]},
        [Contact("upper", "base", "rigid", lambda x: np.full(len(x), 1e-3))],
    )  # fmt: skip
    still = made.layout.create_vector()
    for time, gap in ((1.0, 8e-4), (2.0, 6e-4), (0.0, 1e-3)):
        made.gaps.set_time(time)
        np.testing.assert_allclose(made.gaps.values(still), gap, rtol=1e-12)
        np.testing.assert_allclose(made.gaps.primary_motion[:, 1], 1e-3 - gap, atol=1e-18)
    np.testing.assert_allclose(made.gaps.at_rest, 1e-3)


@pytest.mark.parametrize("new, moved", [(["upper"], True), (["base"], True), (["core"], False)])
def test_gaps_of_new_bodies_count_from_the_present_places(comm, new, moved):
    made = two_blocks(comm, solved=False)
    u = made.layout.create_vector()
    u.array[made.layout.local_slice(1)] = 1e-4
    before = made.gaps.values(u)
    np.testing.assert_allclose(before, -1e-4, rtol=1e-12)
    made.gaps.place_new_bodies(u.array_r.copy(), new)
    np.testing.assert_allclose(made.gaps.values(u), 0.0 if moved else before, atol=1e-19)
    np.testing.assert_array_equal(made.gaps.at_rest, made.gaps.initial)


def test_signatures_tell_rows_apart(comm):
    gaps = two_blocks(comm, solved=False).gaps
    found = everywhere(comm, gaps.signatures())
    assert np.all((found > 0.0) & (found < 1.0))
    assert len(np.unique(found)) == len(found) > 2
    for interface in gaps.interfaces:  # as if the other body were named first
        interface.normals[:] *= -1.0
    np.testing.assert_array_equal(everywhere(comm, gaps.signatures()), found)


@pytest.mark.ranks
def test_tied_pairs_have_no_gap_to_close(comm):
    mesh = blocks(comm, symmetry=False)
    made = problem(
        mesh, {n: body(elastic(*SOFT)) for n in ("upper", "base")}, {"base": [fixed("bottom")]},
        [Contact("upper", "base", "tied", initial_gap=lambda x: np.full(len(x), 1e-3))],
    )  # fmt: skip
    assert np.all(made.gaps.tied)
    assert np.all(made.gaps.values(made.layout.create_vector()) == 0.0)
