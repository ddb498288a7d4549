"""The integration points of a small slab."""

from __future__ import annotations

import pytest
from dolfinx import fem

from castx.domain.mesh import BodyMesh
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from tests.elastic_bodies import generated


@pytest.fixture
def body(comm) -> BodyMesh:
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.02, width=0.01, size=0.005)
    return mesh.bodies["casting"]


@pytest.fixture
def points(body) -> IntegrationPoints:
    return IntegrationPoints(body, "plane-strain", 1)


@pytest.fixture
def cells(body) -> fem.FunctionSpace:
    return fem.functionspace(body.mesh, ("DG", 0))
