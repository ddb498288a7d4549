"""The unknowns of the bodies: u = P v and Pᵀr against dense products."""

from __future__ import annotations

import numpy as np

from castx.contact.unknowns import TransformedUnknowns
from tests.small_contact import dense, of_all, two_blocks, waves


def test_displacements_and_rows(comm):
    made = two_blocks(comm, solved=False)
    transform = made.equilibrium.balance.transform
    unknowns, P = TransformedUnknowns(transform), dense(comm, transform.P)
    v, u = made.layout.create_vector(), made.layout.create_vector()
    v.array[:] = waves(v)
    unknowns.displacements(v, u)
    np.testing.assert_allclose(of_all(comm, u), P @ of_all(comm, v), atol=1e-13)
    rows = unknowns.residual(v, u)
    own = slice(*v.getOwnershipRange())
    np.testing.assert_allclose(rows, (P.T @ of_all(comm, u))[own], atol=1e-13)
    assert unknowns.extended(rows) is rows
