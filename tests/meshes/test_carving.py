"""Meshes that a surface cuts: volumes and areas are exact, cells fit together and stay good."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from castx.meshes.carving import NEAR, Carving, pieces
from castx.meshes.linear_mesh import LinearMesh, free_faces, handedness, oriented

pytestmark = pytest.mark.serial

SHARES = (0.0, 0.4, 0.7)


def cubes(count, shift=0.0):
    """Cubes of six tetrahedra each, with inner points shifted at random."""
    steps = np.arange(count + 1)
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    points = grid / count
    inner = ((grid > 0) & (grid < count)).all(axis=1)
    random = np.random.default_rng(3)
    points[inner] += shift / count * random.uniform(-1, 1, (inner.sum(), 3))
    number = np.arange(len(grid)).reshape((count + 1,) * 3)
    cells = []
    for order in permutations(range(3)):
        at, path = np.zeros(3, dtype=int), []
        for axis in (None, *order):
            if axis is not None:
                at[axis] += 1
            path.append(number[tuple(slice(a, a + count) for a in at)].ravel())
        cells.append(np.stack(path, axis=1))
    renumbered = random.permutation(len(points))
    moved = np.empty_like(points)
    moved[renumbered] = points
    return moved, oriented(moved, renumbered[np.concatenate(cells)])


def sides(points):
    return np.hstack([points == 0.0, points == 1.0])


def carved(points, cells, levels, fixed=None):
    fixed = np.zeros(len(points), dtype=bool) if fixed is None else fixed
    carving = Carving(points, cells, levels, sides(points), fixed)
    return carving, carving.points, oriented(carving.points, carving.kept(cells)[0])


def faces_of(cells):
    zeros = np.zeros(len(cells), dtype=np.int64)
    return free_faces(LinearMesh(np.zeros((cells.max() + 1, 3)), cells, zeros, zeros))


def area(points, faces):
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


@pytest.mark.parametrize("signs", list(product((-1, 0, 1), repeat=4)))
def test_pieces_of_a_cell_fill_what_lies_below_a_plane(signs):
    """Against points drawn at random: each one below lies in one piece, none above does."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    levels = np.array(signs) * np.array([1.0, 0.6, 1.4, 0.8])
    points = list(corners)
    for first, second in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)):
        share = levels[first] / (levels[first] - levels[second] or 1.0)
        points.append(corners[first] + share * (corners[second] - corners[first]))
    found = [np.array(points)[list(piece)] for piece in pieces(signs)]
    shares = np.random.default_rng(5).dirichlet(np.ones(4), 400)
    count = np.zeros(len(shares), dtype=int)
    for piece in found:
        inverse = np.linalg.inv(np.vstack([piece.T, np.ones(4)]))
        count += (inverse @ np.vstack([(shares @ corners).T, np.ones(400)]) > 0).all(axis=0)
    np.testing.assert_array_equal(count, shares @ levels < 0)


@pytest.mark.parametrize("shift", [0.0, 0.25])
def test_a_plane_is_met_exactly(shift):
    points, cells = cubes(5, shift)
    normal, place = np.array([0.3, -0.5, 0.81]), 0.31
    carving, moved, kept = carved(points, cells, points @ normal - place)
    faces = faces_of(kept)
    on_box = (sides(moved)[faces].all(axis=1)).any(axis=1)
    above = moved[faces[~on_box]] @ normal - place
    off = (np.abs(above) > 1e-12).mean()
    assert off < 0.02  # corners on an edge of the box that cannot move along it
    volume = np.abs(handedness(moved, kept)).sum() / 6
    drawn = np.random.default_rng(1).uniform(size=(400_000, 3)) @ normal < place
    assert volume == pytest.approx(drawn.mean(), abs=3e-3)
    outer = carving.kept(faces_of(cells))[0]
    assert area(moved, outer).sum() == pytest.approx(area(moved, faces[on_box]).sum(), rel=1e-12)
    assert {frozenset(f) for f in outer.tolist()} == {frozenset(f) for f in faces[on_box].tolist()}


def test_a_ball_in_a_cube_has_its_volume_and_good_cells():
    """Its volume is that of a polyhedron: the error falls with the square of the size."""
    errors, exact = [], 4 / 3 * np.pi * 0.4**3
    for count in (8, 16):
        points, cells = cubes(count, 0.2)
        levels = np.linalg.norm(points - 0.5, axis=1) - 0.4
        _, moved, kept = carved(points, cells, levels)
        volumes = handedness(moved, kept) / 6
        edges = moved[kept[:, [1, 2, 3, 2, 3, 3]]] - moved[kept[:, [0, 0, 0, 1, 1, 2]]]
        longest = np.linalg.norm(edges, axis=2).max(axis=1)
        assert (6 * volumes / longest**3).min() > 0.003  # 0.7 in a regular one
        errors.append(exact - volumes.sum())
    assert 3.0 < errors[0] / errors[1] < 5.0 and abs(errors[1]) < 0.02 * exact


def test_points_near_the_surface_move_onto_it_but_not_off_their_plane():
    points, cells = cubes(4)
    level = 0.5 + 0.24 * NEAR  # just above the layer in the middle: its points move up
    normal = np.array([0.02, 0.0, 1.0])
    _, moved, _ = carved(points, cells, points @ normal - level)
    old = moved[: len(points)]
    changed = (old != points).any(axis=1)
    assert changed.any()
    np.testing.assert_allclose(old[changed] @ normal, level, rtol=1e-12)
    np.testing.assert_array_equal(sides(points)[changed], sides(old)[changed])


def test_fixed_points_stay_below():
    points, cells = cubes(2)
    fixed = points[:, 2] == 0.0
    levels = points[:, 2] - 0.1  # passes them at a fifth of the edges
    _, _, few = carved(points, cells, levels)
    assert not len(few)
    _, moved, kept = carved(points, cells, levels, fixed)
    assert handedness(moved, kept).sum() / 6 == pytest.approx(0.1)


def test_points_leave_a_plane_of_which_nothing_stays():
    points, cells = cubes(4)
    level = 1.0 - 0.1 / 4  # the whole upper side of the cube goes
    _, moved, kept = carved(points, cells, points[:, 2] - level)
    np.testing.assert_allclose(moved[np.unique(kept), 2].max(), level, rtol=1e-12)
    assert handedness(moved, kept).sum() / 6 == pytest.approx(level)


@pytest.mark.parametrize("face, moves", [(0.1, False), (0.9, True)])
def test_no_point_moves_through_a_face_opposite_to_it(face, moves):
    """It would by a fifth of an edge of the first cell, behind the face of the second one."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1],
                       [face, -1, -1], [face, -1, 1], [face, -0.2, 0]])  # fmt: skip
    cells = oriented(points, np.array([[0, 1, 2, 3], [0, 4, 5, 6]]))
    levels = np.array([-0.2, 0.8, -1.0, -1.0, -1.0, -1.0, -1.0])
    none = np.zeros((7, 1), dtype=bool)
    carving = Carving(points, cells, levels, none, none[:, 0])
    assert carving.points[0, 0] == pytest.approx(0.2 if moves else 0.0)
