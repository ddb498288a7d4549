"""Points beside a surface, or turned to the same side, face nothing."""

import numpy as np
import pytest

from castx.domain.pairs.facing import SurfacePoints, faced, facet_sizes
from castx.domain.surface_facets import surface_facets
from tests.elastic_bodies import blocks


@pytest.mark.ranks
def test_distance_and_side(comm):
    mesh = blocks(comm)
    facets = surface_facets(mesh, mesh.bodies["base"], "upper")
    np.testing.assert_allclose(facet_sizes(facets), 0.005)
    height = facets.points[0, 0, 1]
    places = np.array([[0.01, height + 1e-3], [0.01, height + 1e-3], [0.03, height + 1e-3]])
    outward = np.array([[0.0, -1.0], [0.0, 1.0], [0.0, -1.0]])
    found = faced(SurfacePoints(places, outward, np.full(3, 0.1)), facets, None)
    np.testing.assert_allclose(found.distance, [1e-3, np.inf, np.inf], rtol=1e-12)
