"""Edge bubbles: 4 λ_a λ_b, with which linear functions make all quadratic ones."""

from __future__ import annotations

import basix
import numpy as np
import pytest

from castx.mechanics.midsides.bubbles import bubble_element

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("cell, dimension", [("triangle", 2), ("tetrahedron", 3)])
def test_bubbles_are_products_of_the_functions_of_both_ends(cell, dimension):
    points = np.random.default_rng(3).dirichlet(np.ones(dimension + 1), 20)
    edges = basix.topology(getattr(basix.CellType, cell))[1]
    values = bubble_element(cell, dimension).tabulate(0, points[:, 1:])[0]
    rows = values.reshape(20, dimension, len(edges), dimension)
    for k, (a, b) in enumerate(edges):
        bubble = 4 * points[:, a] * points[:, b]
        found = rows[:, :, k]
        np.testing.assert_allclose(found, bubble[:, None, None] * np.eye(dimension), atol=1e-13)
