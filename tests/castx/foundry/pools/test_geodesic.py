"""Shortest paths in a plate, round a corner and through a box, on all kinds of cells."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.pools.geodesic import shortest_paths

pytestmark = pytest.mark.serial

KUHN = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]


def grid(*counts):
    """Return points of a unit square or cube and its cells with corners in binary order."""
    axes = [np.linspace(0.0, 1.0, count + 1) for count in counts]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(counts))
    numbers = np.arange(len(points)).reshape([count + 1 for count in counts])
    corners = []
    for corner in np.ndindex(*(2,) * len(counts)):
        place = tuple(slice(c, c + n) for c, n in zip(corner, counts, strict=True))
        corners.append(numbers[place].ravel())
    return points, np.stack(corners, axis=1)


def triangles(cells):
    return np.concatenate([cells[:, [0, 1, 3]], cells[:, [0, 2, 3]]])


def bent(n, split):
    """Return an L: the unit square without its upper right quarter."""
    points, cells = grid(n, n)
    middle = points[cells].mean(axis=1)
    cells = cells[(middle < 0.5).any(axis=1)]
    return points, triangles(cells) if split else cells


@pytest.mark.parametrize("split", [True, False])
def test_a_straight_side_is_exact(split):
    points, cells = grid(7, 5)
    cells = triangles(cells) if split else cells
    found = shortest_paths(points, cells, points[:, 0] < 1e-9)
    np.testing.assert_allclose(found, points[:, 0], atol=1e-9)


@pytest.mark.parametrize("split", [True, False])
def test_round_the_corner_of_an_l(split):
    """From the end of one leg to the corner, from there to the end of the other."""
    start, corner = np.array([1.0, 0.5]), np.array([0.5, 0.5])
    errors = []
    for n in (8, 32):
        points, cells = bent(n, split)
        found = shortest_paths(points, cells, np.linalg.norm(points - start, axis=1) < 1e-9)
        end = np.linalg.norm(points - (0.0, 1.0), axis=1) < 1e-9
        exact = np.linalg.norm(start - corner) + np.linalg.norm(corner - (0.0, 1.0))
        errors.append(abs(found[end][0] / exact - 1.0))
        removed = (points > 0.5 + 1e-9).all(axis=1)
        assert np.isinf(found[removed]).all()
    assert errors[1] < 0.03 and errors[1] < errors[0] / 1.6 + 1e-9


@pytest.mark.parametrize("kind", ["tetrahedra", "hexahedra"])
def test_across_a_box(kind):
    """The distance to a face is exact, that to a corner is never too short and converges."""
    errors = []
    for n in (3, 9):
        points, cells = grid(n, n, n)
        if kind == "tetrahedra":
            cells = np.concatenate([cells[:, list(corners)] for corners in KUHN])
        face = shortest_paths(points, cells, points[:, 2] > 1.0 - 1e-9)
        np.testing.assert_allclose(face, 1.0 - points[:, 2], atol=1e-9)
        exact = np.linalg.norm(points - (1.0, 0.0, 0.0), axis=1)
        error = shortest_paths(points, cells, exact < 1e-9) - exact
        assert error.min() > -1e-9
        errors.append(error.mean())
    assert errors[1] < 0.07 and errors[1] < errors[0] / 1.3


def test_without_a_source_there_is_no_path():
    points, cells = grid(2, 2)
    assert np.isinf(shortest_paths(points, cells, np.zeros(len(points), dtype=bool))).all()
