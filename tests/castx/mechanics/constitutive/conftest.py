"""The integration points of a small slab."""

from __future__ import annotations

import pytest

from castx.mechanics.constitutive.integration_points import IntegrationPoints
from tests.elastic_bodies import generated


@pytest.fixture
def points(comm) -> IntegrationPoints:
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.02, width=0.01, size=0.005)
    return IntegrationPoints(mesh.bodies["casting"], "plane-strain", 1)
