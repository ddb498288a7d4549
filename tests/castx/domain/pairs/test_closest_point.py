"""Closest points on facets against fine samples of them."""

from __future__ import annotations

import numpy as np
import pytest

from castx.domain.pairs.closest_point import project

pytestmark = pytest.mark.serial


def samples(corners: int) -> np.ndarray:
    """Return weights of many points of a facet, (points, corners)."""
    t = np.linspace(0.0, 1.0, 101 if corners == 2 else 41)
    if corners == 2:
        return np.stack((1 - t, t), axis=1)
    a, b = (grid.ravel() for grid in np.meshgrid(t, t))
    inside = a + b <= 1 + 1e-12
    a, b = a[inside], b[inside]
    if corners == 3:
        return np.stack((1 - a - b, a, b), axis=1)
    weights = np.zeros((2 * len(a), 4))
    for half, order in enumerate(((0, 1, 3), (0, 3, 2))):
        weights[half * len(a) : (half + 1) * len(a), order] = np.stack((1 - a - b, a, b), axis=1)
    return weights


@pytest.mark.parametrize("corners", [2, 3, 4])
def test_nothing_lies_closer(corners):
    random = np.random.default_rng(7)
    dimension = 2 if corners == 2 else 3
    facets = random.normal(size=(30, corners, dimension))
    if corners == 4:
        facets[:, 3] = facets[:, 1] + facets[:, 2] - facets[:, 0]
    points = 2 * random.normal(size=(50, dimension))
    normals = random.normal(size=(30, dimension))
    found = project(points, facets, normals)
    assert np.all(found.weights >= 0.0)
    np.testing.assert_allclose(found.weights.sum(axis=1), 1.0)
    reached = np.einsum("na,nak->nk", found.weights, facets[found.facet])
    distance = np.linalg.norm(points - reached, axis=1)
    everywhere = np.einsum("sa,fak->fsk", samples(corners), facets)
    sampled = np.linalg.norm(points[:, None, None] - everywhere, axis=3).min(axis=(1, 2))
    assert np.all(distance <= sampled + 1e-12)
    assert np.all(distance >= sampled - 0.1)


def test_a_point_above_a_ridge_gets_the_mean_normal():
    facets = np.array([[[-1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [1.0, 0.0]]])
    facets[0, 0, 1] = facets[1, 1, 1] = -1.0
    normals = np.array([[-1.0, 1.0], [1.0, 1.0]]) / np.sqrt(2)
    found = project(np.array([[0.0, 2.0], [1.0, 0.0]]), facets, normals)
    np.testing.assert_allclose(found.normals, [[0.0, 1.0], normals[1]], atol=1e-15)
    np.testing.assert_allclose(found.weights[1], [0.5, 0.5])
    assert found.facet[0] == 0 and found.facet[1] == 1


def test_no_points_give_an_empty_projection():
    facets = np.array([[[0.0, 0.0], [1.0, 0.0]]])
    found = project(np.zeros((0, 2)), facets, np.array([[0.0, 1.0]]))
    assert found.weights.shape == (0, 2)
    assert found.normals.shape == (0, 2)
