"""Samples inside cells: volumes that add up, shape functions that interpolate."""

from __future__ import annotations

import numpy as np
import pytest

from castx.domain.cell_kinds import KINDS
from castx.domain.cell_samples import DEGREES, SHARE_DEGREES, sample_rule, sample_volumes
from castx.domain.measures import nodal_volumes
from tests.elastic_bodies import generated


@pytest.mark.serial
@pytest.mark.parametrize("name", DEGREES)
@pytest.mark.parametrize("degrees", [DEGREES, SHARE_DEGREES], ids=["heat", "share"])
def test_shares_and_shapes_give_means_of_polynomials(name, degrees):
    kind = KINDS[name]
    rule = sample_rule(kind, degrees)
    assert rule.shares.sum() == pytest.approx(1.0, rel=1e-12) and rule.shares.min() > 0.0
    np.testing.assert_allclose(rule.shapes.sum(axis=1), 1.0, rtol=1e-12)
    corners = rule.shapes.shape[1]
    np.testing.assert_allclose(rule.shares @ rule.shapes, 1.0 / corners, rtol=1e-12)
    if kind.name in ("triangle", "tetrahedron"):
        # ∫ φ_i² over a simplex is 2/((d + 1)(d + 2)) of its volume.
        np.testing.assert_allclose(
            rule.shares @ rule.shapes**2, 2.0 / (corners * (corners + 1)), rtol=1e-12
        )


@pytest.mark.serial
@pytest.mark.parametrize(("name", "across"), [("quadrilateral", 8), ("hexahedron", 4)])
def test_the_share_has_samples_behind_each_other(name, across):
    places = sample_rule(KINDS[name], SHARE_DEGREES).places
    assert len(np.unique(places[:, 0].round(9))) == across


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric"])
def test_volumes_add_up_to_those_of_the_nodes(comm, model):
    mesh = generated(comm, model, "slab", ["casting"], length=0.02, width=0.01, size=0.005)
    body = mesh.bodies["casting"]
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    found = sample_volumes(body, model, sample_rule(body.kind))[:owned].sum()
    expected = nodal_volumes(body, model).sum()
    assert comm.allreduce(found) == pytest.approx(comm.allreduce(expected), rel=1e-12)
