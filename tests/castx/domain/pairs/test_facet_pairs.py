"""The facets round pairs: each pair has the facets whose areas make up its own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.domain.pairs.facet_pairs import facet_pairs, sums_by_number
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.pairs.patches import pairs_by_patch
from tests.castx.domain.interface_meshes import MESHES, NAMES
from tests.partitions import PARTITION, scattered, thinly_scattered

SHARP = math.radians(40)


@pytest.mark.ranks
@pytest.mark.parametrize("cut", [None, scattered, thinly_scattered])
@pytest.mark.parametrize("patches", [False, True])
@pytest.mark.parametrize("name", ["box", "box in space", "cup in space", "box, quadrilaterals"])
def test_every_pair_has_the_facets_of_its_area(comm, name, patches, cut, monkeypatch):
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    mesh = MESHES[name](comm)
    pairs = pairs_by_patch(mesh, *NAMES, SHARP) if patches else node_pairs(mesh, *NAMES)
    found = facet_pairs(mesh, pairs, SHARP if patches else None)
    label = np.flatnonzero(found.pairs >= 0)
    np.testing.assert_array_equal(np.sort(found.pairs[label]), np.arange(len(pairs.areas)))
    areas = np.bincount(found.labels.ravel(), found.facets.areas.ravel())
    np.testing.assert_allclose(areas[label], pairs.areas[found.pairs[label]], rtol=1e-12)
    nodes = np.zeros(len(found.pairs), dtype=np.int64)
    nodes[found.labels.ravel()] = found.facets.nodes.ravel()
    np.testing.assert_array_equal(nodes[label], pairs.secondary_nodes[found.pairs[label]])


@pytest.mark.serial
def test_sums_of_rows_by_number():
    found = sums_by_number(np.array([2, 0, 2]), np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]), 4)
    np.testing.assert_array_equal(found, [[3.0, 4.0], [0.0, 0.0], [6.0, 8.0], [0.0, 0.0]])
