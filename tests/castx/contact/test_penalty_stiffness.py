"""Penalties against the diagonal of the matrix of the bodies."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.penalty_stiffness import FACTOR, PenaltyStiffness
from tests.elastic_bodies import blocks, body, elastic, fixed, problem
from tests.partitions import PARTITION, on_the_last
from tests.small_contact import SOFT, STIFF, dense, two_blocks


def made_of(made, given, moduli=(0.0, 0.0)):
    names = list(made.bodies)
    return PenaltyStiffness(made.layout, names, 2, made.gaps, given, moduli)


@pytest.mark.serial
def test_the_softer_side_decides(comm):
    """Mean over the pairs of the mean diagonal at their nodes, over their areas."""
    made = two_blocks(comm, "penalty")
    A = made.equilibrium.balance.assembly.matrix()
    diagonal = np.diag(dense(comm, A))
    pairs, areas = made.pairs[0], made.gaps.areas
    sides = []
    for b, nodes in enumerate((pairs.secondary_nodes, pairs.primary_nodes)):
        entries = [diagonal[made.layout.dofs(b, nodes, k)] for k in range(2)]
        sides.append(np.mean(np.mean(entries, axis=0) / areas))
    assert sides[0] < sides[1]
    stiffness = made_of(made, np.full(3, np.nan))
    np.testing.assert_allclose(stiffness.penalties(A), FACTOR * sides[0], rtol=1e-12)
    stiffness.update(A)
    np.testing.assert_allclose(stiffness.springs, FACTOR * sides[0] * areas, rtol=1e-12)
    # Pairs give way by about a tenth of what an element of 1 cm does.
    assert np.all(stiffness.penalties(A) == pytest.approx(10 * SOFT[0] / 0.01, rel=0.3))


@pytest.mark.ranks
def test_no_body_counts_as_softer_than_its_solid_as_a_whole(comm):
    """The second is stiffer than the first anyway, which counts as soon as it has the larger."""
    made = two_blocks(comm, "penalty")
    A = made.equilibrium.balance.assembly.matrix()
    unknown = np.full(len(made.gaps.local), np.nan)
    soft = made_of(made, unknown).penalties(A)
    unchanged = made_of(made, unknown, (0.09 * soft.mean(), 1e3)).penalties(A)
    np.testing.assert_array_equal(unchanged, soft)
    stiffer = made_of(made, unknown, (0.11 * soft.mean(), 0.0)).penalties(A)
    np.testing.assert_allclose(stiffer, 1.1 * soft, rtol=1e-12)


@pytest.mark.ranks
def test_the_mean_is_that_of_the_pairs_of_all_ranks(comm):
    """Each rank alone finds the same in the whole problem.

    The soft base is wider than the block, so that it is stiffer at the edges of the interface.
    """
    penalties = []
    for ranks in (comm, MPI.COMM_SELF):
        mesh = blocks(ranks, base=(0.04, 0.02), symmetry=False, size=0.0025)
        bodies = {"upper": body(elastic(*STIFF)), "base": body(elastic(*SOFT))}
        held = {"base": [fixed("bottom", "all")]}
        made = problem(mesh, bodies, held, [Contact("upper", "base", "penalty")])
        made.equilibrium.solve(0.0)
        stiffness = made_of(made, np.full(len(made.gaps.local), np.nan))
        penalties.append(stiffness.penalties(made.equilibrium.balance.assembly.matrix()))
        assert np.all(penalties[-1] > 0)
    np.testing.assert_allclose(penalties[0], penalties[1][0], rtol=1e-12)


@pytest.mark.ranks
def test_given_penalties_are_kept(comm):
    made = two_blocks(comm, "penalty")
    given = np.full(len(made.gaps.local), np.nan)
    given[::2] = 1e9
    A = made.equilibrium.balance.assembly.matrix()
    found = made_of(made, given).penalties(A)
    np.testing.assert_array_equal(found[::2], 1e9)
    assert np.all(found[1::2] > 1e10)


@pytest.mark.ranks
def test_ranks_without_pairs_take_part(comm, monkeypatch):
    alone = two_blocks(MPI.COMM_SELF, "penalty", solved=False)
    monkeypatch.setattr(PARTITION, on_the_last)
    found = []
    for made in (alone, two_blocks(comm, "penalty", solved=False)):
        made.equilibrium.balance.assembly.residual()
        A = made.equilibrium.balance.assembly.matrix()
        found.append(made_of(made, np.full(len(made.gaps.local), np.nan)).penalties(A))
    expected = found[0] if comm.rank == comm.size - 1 else []
    np.testing.assert_allclose(found[1], expected, rtol=1e-12)
