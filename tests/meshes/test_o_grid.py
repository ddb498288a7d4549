"""Quadrilaterals of round plans: areas, rings, mirror images, angles of the core."""

import math

import numpy as np
import pytest

from castx.meshes.grading import Sizing
from castx.meshes.linear_mesh import free_faces, handedness
from castx.meshes.o_grid import quarter_o_grid

pytestmark = pytest.mark.serial

SIZING = Sizing(0.1)


def areas(mesh):
    """Return the areas of quadrilaterals by the shoelace formula."""
    x, y = np.moveaxis(mesh.points[mesh.cells], 2, 0)
    return 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)


def polygon(radius, count):
    """Return the area of a quarter of a regular polygon with `count` sides in the quarter."""
    return 0.5 * radius**2 * count * math.sin(0.5 * math.pi / count)


@pytest.mark.parametrize("bore", [0.0, 0.2])
@pytest.mark.parametrize("sizing", [SIZING, Sizing(0.2, 0.05, 2.0)])
def test_rings_fill_the_polygons_through_their_nodes(bore, sizing):
    mesh = quarter_o_grid((bore, 1.0, 1.5), sizing)
    count = 2 * math.ceil(math.pi / 4 / sizing.size)
    assert (handedness(mesh.points, mesh.cells) > 0).all() and (areas(mesh) > 0).all()
    inner = areas(mesh)[mesh.regions == 0].sum()
    outer = areas(mesh)[mesh.regions == 1].sum()
    assert inner == pytest.approx(polygon(1.0, count) - polygon(bore, count))
    assert outer == pytest.approx(polygon(1.5, count) - polygon(1.0, count))


@pytest.mark.parametrize("bore", [0.0, 0.2])
def test_the_free_edges_are_the_circles_and_the_two_sides(bore):
    """Inside, every edge has two cells: ring and core fit together."""
    mesh = quarter_o_grid((bore, 1.0, 1.5), SIZING)
    ends = mesh.points[free_faces(mesh)]
    radii = np.linalg.norm(ends, axis=2)
    on_side = (np.abs(ends) < 1e-12).all(axis=1).any(axis=1)
    on_circle = (np.abs(radii - 1.5) < 1e-12).all(axis=1)
    on_bore = (np.abs(radii - bore) < 1e-12).all(axis=1) & (bore > 0)
    assert (on_side | on_circle | on_bore).all()


@pytest.mark.parametrize("bore", [0.0, 0.2])
def test_the_plan_is_its_own_mirror_image_in_the_diagonal(bore):
    mesh = quarter_o_grid((bore, 1.0, 1.5), SIZING)
    points = {tuple(p) for p in mesh.points}
    assert points == {(y, x) for x, y in points}
    assert (mesh.points >= 0).all() and len(points) == len(mesh.points)


def test_the_angles_at_the_corner_of_the_core_are_equal():
    """Three quadrilaterals meet there, at 120° each."""
    mesh = quarter_o_grid((0.0, 1.0, 1.5), Sizing(0.05))
    corner = np.flatnonzero(np.bincount(mesh.cells.ravel()) == 3)
    inner = corner[np.linalg.norm(mesh.points[corner], axis=1) < 0.99]
    (node,) = inner[np.isclose(*mesh.points[inner].T)]
    angles = []
    for cell in mesh.cells[(mesh.cells == node).any(axis=1)]:
        k = int(np.flatnonzero(cell == node)[0])
        sides = mesh.points[cell[[k - 1, (k + 1) % 4]]] - mesh.points[node]
        cosine = sides[0] @ sides[1] / np.linalg.norm(sides, axis=1).prod()
        angles.append(math.degrees(math.acos(cosine)))
    assert angles == pytest.approx([120.0] * 3, abs=6.0)
    assert sum(angles) == pytest.approx(360.0)


@pytest.mark.parametrize("beyond, count", [(0.0, 5), (5e-11, 5), (5e-10, 6)])
def test_what_divides_the_interface_but_for_rounding_makes_no_more_cells(beyond, count):
    mesh = quarter_o_grid((0.5, 1.0, 1.5), Sizing(math.pi / 4 / 5 / (1.0 + beyond)))
    on_interface = np.isclose(np.linalg.norm(mesh.points, axis=1), 1.0)
    assert on_interface.sum() == 2 * count + 1
