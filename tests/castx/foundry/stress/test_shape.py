"""Deviation and allowance of bodies that contract, turn and move, with and without symmetry."""

from __future__ import annotations

from dataclasses import replace

from mpi4py import MPI

import numpy as np
import pytest
from dolfinx.mesh import meshtags

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.foundry.stress.shape import Plane, Shape, plane_of
from tests.castx.fakes import cylinder_mesh

SHRUNK, HEIGHT = 0.0136935, 0.04


@pytest.fixture(scope="module")
def quarter():
    """A quarter of a cylinder in space, cut by the planes x = 0 and y = 0."""
    return cylinder_mesh(MPI.COMM_WORLD, "3d", 6e-3).bodies["casting"]


@pytest.fixture(scope="module")
def block():
    sizes = {"length": 0.06, "width": 0.02, "size": 5e-3}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting"], MPI.COMM_WORLD)
    return mesh.bodies["casting"]


def test_planes_of_symmetry_lie_where_the_mesh_has_them(quarter):
    for name, axis in (("symmetry-x", 0), ("symmetry-y", 1)):
        plane = plane_of(quarter, "3d", name)
        assert abs(plane.normal[axis]) == pytest.approx(1.0, abs=1e-12)
        assert plane.offset == pytest.approx(0.0, abs=1e-15)


@pytest.mark.serial
def test_images_lie_as_far_behind_a_plane_away_from_the_origin():
    plane = Plane(np.array([0.6, 0.8]), 2.0)
    points = np.array([[1.2, 1.6], [1.2 + 3.0, 1.6 + 4.0], [0.0, 0.0]])
    expected = [[1.2, 1.6], [1.2 - 3.0, 1.6 - 4.0], [2.4, 3.2]]
    np.testing.assert_allclose(plane.image(points), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.ranks
def test_a_quarter_contracts_towards_its_axis(quarter):
    """-e (x - x̄)·n with x̄ on the axis at half the height, whatever it has moved along it."""
    points = quarter.points
    moved = -SHRUNK * points + np.array([0.0, 0.0, 3e-3])
    shape = Shape(quarter, "3d")
    found = shape.nodal_deviation(moved)
    z, r = points[:, 2], np.linalg.norm(points[:, :2], axis=1)
    side = (np.abs(r - 0.02) < 1e-6) & (z > 1e-6) & (z < HEIGHT - 1e-6)
    top = (z > HEIGHT - 1e-6) & (r < 0.019)
    np.testing.assert_allclose(found[top], -SHRUNK * HEIGHT / 2, rtol=1e-9)
    # The side is made of facets, also beyond the planes of symmetry.
    np.testing.assert_allclose(found[side], -SHRUNK * 0.02, rtol=2e-3)
    cut = (r < 0.019) & ((points[:, 0] < 1e-9) | (points[:, 1] < 1e-9)) & (z > 1e-6)
    assert np.isnan(found[cut & (z < HEIGHT - 1e-6)]).all()
    assert shape.of(moved)["allowance"] == pytest.approx([SHRUNK] * 3, rel=1e-12)


@pytest.mark.ranks
def test_two_planes_with_one_name_and_a_body_without_surface_have_nothing_to_compare(block):
    """Opposite sides under one name, then all sides as planes of symmetry."""
    tags, dimension = block.facet_tags, block.mesh.topology.dim
    sides = [block.surfaces[name] for name in ("wall", "far")]
    both = np.where(np.isin(tags.values, sides), np.int32(1), tags.values + np.int32(1))
    doubled = meshtags(block.mesh, dimension - 1, tags.indices, both)
    pair = replace(block, facet_tags=doubled, surfaces={"symmetry-x": 1})
    assert plane_of(pair, "plane-strain", "symmetry-x") is None
    names = {f"symmetry-{name}": tag for name, tag in block.surfaces.items()}
    nodes = {f"symmetry-{name}": found for name, found in block.nodes_on.items()}
    assert not Shape(replace(block, surfaces=names, nodes_on=nodes), "plane-strain").known
    assert Shape(block, "plane-strain").known


def test_turning_and_moving_is_no_distortion(block):
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    shape = Shape(block, "plane-strain")
    rigid = block.points @ turn.T + np.array([0.02, -0.01]) - block.points
    assert np.nanmax(np.abs(shape.nodal_deviation(rigid))) < 1e-15
    shrunk = (1.0 - SHRUNK) * block.points @ turn.T - block.points
    found = shape.nodal_deviation(shrunk)
    x, y = block.points.T
    end = (x > 0.06 - 1e-9) & (y > 1e-9) & (y < 0.02 - 1e-9)
    np.testing.assert_allclose(found[end], -SHRUNK * 0.03, rtol=1e-10)
    inside = (x > 1e-9) & (x < 0.06 - 1e-9) & (y > 1e-9) & (y < 0.02 - 1e-9)
    assert np.isnan(found[inside]).all()


def test_extremes_have_their_places(block):
    """One side bulges by a parabola, which hardly moves the fit of the others."""
    x, y = block.points.T
    bulge = np.zeros_like(block.points)
    bulge[:, 1] = np.where(y > 0.02 - 1e-9, 1e-4 * 4.0 * x * (0.06 - x) / 0.06**2, 0.0)
    found = Shape(block, "plane-strain").of(bulge)
    assert found["outward"]["place"] == pytest.approx([0.03, 0.02], abs=1e-9)
    assert 0.5e-4 < found["outward"]["value"] < 1e-4
    assert found["inward"]["value"] < 0.0


@pytest.mark.ranks
def test_what_is_fed_is_no_part_of_the_shape(comm):
    """The top has sunk by a millimetre; the others tell the contraction as if it had not.

    Without it no two faces tell the height.
    """
    body = cylinder_mesh(comm, size=4e-3).bodies["casting"]
    r, z = body.points.T
    top = z > HEIGHT - 1e-9
    moved = -SHRUNK * body.points
    moved[:, 1] -= np.where(top & (r < 0.02 - 1e-9), 1e-3, 0.0)
    fed = body.facet_tags.find(body.surface_tag("top"))
    whole, shape = Shape(body, "axisymmetric"), Shape(body, "axisymmetric", fed)
    across, along = shape.of(moved)["allowance"]
    assert across == pytest.approx(SHRUNK, rel=1e-9) and along is None
    assert abs(whole.of(moved)["allowance"][1] - SHRUNK) > 0.1 * SHRUNK
    found = shape.nodal_deviation(moved)
    assert np.isnan(found[top & (r < 0.02 - 1e-9)]).all()
    side = (r > 0.02 - 1e-9) & (z > 1e-9) & (z < HEIGHT - 1e-9)
    np.testing.assert_allclose(found[side], -SHRUNK * 0.02, rtol=1e-10)


@pytest.mark.ranks
def test_a_plane_that_is_left_alone_is_no_shape(comm):
    """So the whole surface is compared."""
    body = cylinder_mesh(comm, size=4e-3).bodies["casting"]
    left = [body.surfaces[name] for name in body.surfaces if name != "base"]
    fed = np.concatenate([body.facet_tags.find(tag) for tag in left])
    moved = -SHRUNK * body.points
    whole, shape = (Shape(body, "axisymmetric", each).of(moved) for each in (None, fed))
    assert shape == whole


def test_in_an_axisymmetric_body_only_the_axis_is_left_to_move_along(comm):
    body = cylinder_mesh(comm, size=4e-3).bodies["casting"]
    moved = -SHRUNK * body.points + np.array([0.0, 5e-3])
    found = Shape(body, "axisymmetric").nodal_deviation(moved)
    r, z = body.points.T
    side = (r > 0.02 - 1e-9) & (z > 1e-9) & (z < HEIGHT - 1e-9)
    top = (z > HEIGHT - 1e-9) & (r < 0.02 - 1e-9)
    np.testing.assert_allclose(found[side], -SHRUNK * 0.02, rtol=1e-10)
    np.testing.assert_allclose(found[top], -SHRUNK * HEIGHT / 2, rtol=1e-9)
    axis = (r < 1e-9) & (z > 1e-9) & (z < HEIGHT - 1e-9)
    assert np.isnan(found[axis]).all()


@pytest.mark.ranks
def test_a_surface_at_the_axis_is_no_plane_of_symmetry(comm):
    """Blocks of revolution call it so; it has no area and no normal."""
    geometry = Geometry.read({
        "generator": "stacked_blocks", "model": "axisymmetric",
        "upper": [0.02, 0.01], "base": [0.02, 0.01], "size": 0.005, "symmetry": True,
    })  # fmt: skip
    names = list(geometry.surfaces)
    body = build_mesh(geometry, names, comm).bodies[names[-1]]
    shape = Shape(body, "axisymmetric")
    assert shape.known
    found = shape.of(-SHRUNK * body.points)
    assert found["allowance"] == pytest.approx([SHRUNK, SHRUNK], rel=1e-9)
    assert -SHRUNK * 0.02 - 1e-12 <= found["inward"]["value"] < 0.0
