"""Directions of displacement conditions: surfaces, axes, symmetry planes and the axis."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.mechanics.fixed_directions import (
    FixedDirections,
    SurfaceDisplacement,
    axes_of,
    fixed_directions,
    hinders_shrinkage,
    parallel,
)
from tests.elastic_bodies import blocks, everywhere, fixed, generated, sorted_by_place
from tests.partitions import PARTITION, on_the_last


def cylinder(comm, sector: str):
    return generated(
        comm, "3d", "cylinder_in_mould", ["casting", "mould"],
        radius=0.03, height=0.02, wall=0.01, size=0.01, sector=sector,
    )  # fmt: skip


def located(comm, body, directions):
    """Return positions and directions of all ranks."""
    d = body.mesh.geometry.dim
    points = body.nodes.tabulate_dof_coordinates()[directions.nodes, :d]
    return everywhere(comm, points), everywhere(comm, directions.directions)


@pytest.mark.serial
def test_parallel_are_directions_a_millionth_apart():
    angles = np.array([0.0, 5e-7, 2e-6, 1e-3, 1.0, np.pi - 5e-7, np.pi - 2e-6])
    directions = np.column_stack([np.sin(angles), 0.0 * angles, np.cos(angles)])
    found = parallel(directions, np.array([0.0, 0.0, 1.0]))
    assert found.tolist() == [True, True, False, False, False, True, False]


SLAB = {
    "plane-strain": [
        (["wall normal", "bottom normal"], False), (["wall all"], True), ([], False),
        (["wall normal", "far normal"], True), (["wall normal", "far uniform"], False),
        (["wall normal", "bottom normal", "top normal"], True),
    ],
    "axisymmetric": [
        (["bottom z"], False), (["bottom z", "top z"], True), (["far r"], True),
        (["bottom all"], True),
    ],
}  # fmt: skip


@pytest.mark.ranks
def test_supports_at_opposite_ends_keep_a_body_from_shrinking(comm):
    """Planes of symmetry do not, and neither does an end that moves as a whole."""
    for model, cases in SLAB.items():
        mesh = generated(comm, model, "slab", ["casting"], length=0.02, width=0.01, size=0.005)
        body = mesh.bodies["casting"]
        for held, expected in cases:
            conditions = [
                SurfaceDisplacement(surface, "normal", None)
                if how == "uniform" else SurfaceDisplacement(surface, how)
                for surface, how in (text.split() for text in held)
            ]  # fmt: skip
            found = hinders_shrinkage(body, model, fixed_directions(body, model, conditions))
            assert found == expected, (model, held)


def held(body, direction, *places):
    """Return one direction that is fixed at some places."""
    points = body.points[: body.nodes.dofmap.index_map.size_local]
    near = [np.linalg.norm(points - place, axis=1) < 1e-6 for place in np.array(places)]
    nodes = np.flatnonzero(np.any(near, axis=0)).astype(np.int32)
    return FixedDirections("by hand", nodes, np.tile(np.array(direction), (len(nodes), 1)))


@pytest.mark.ranks
def test_a_body_may_turn_as_it_shrinks(comm):
    """Y is held on a line up to the right, and x on one across it: all of it turns by a half."""
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.02, width=0.01, size=0.005)
    body = mesh.bodies["casting"]
    rising = held(body, [0.0, 1.0], (0.0, 0.0), (0.01, 0.005), (0.02, 0.01))
    assert everywhere(comm, rising.nodes).size == 3
    across = held(body, [1.0, 0.0], (0.01, 0.0), (0.005, 0.01))
    assert not hinders_shrinkage(body, "plane-strain", [rising, across])
    other = held(body, [1.0, 0.0], (0.005, 0.0), (0.01, 0.01))
    assert hinders_shrinkage(body, "plane-strain", [rising, other])


@pytest.mark.ranks
def test_a_ring_that_is_held_at_its_bore_does_not_shrink(comm):
    body = generated(
        comm, "axisymmetric", "cylinder_in_mould", ["casting", "mould"],
        radius=0.03, height=0.02, wall=0.01, size=0.01,
    ).bodies["mould"]  # fmt: skip
    bore = held(body, [1.0, 0.0], (0.03, 0.0), (0.03, 0.02))
    assert hinders_shrinkage(body, "axisymmetric", [bore])


@pytest.mark.ranks
def test_a_sector_shrinks_towards_its_axis_unless_its_outside_is_held(comm):
    body = cylinder(comm, "quarter").bodies["casting"]
    planes = fixed_directions(body, "3d", [])
    assert len(planes) == 2
    assert not hinders_shrinkage(body, "3d", planes)
    both = [SurfaceDisplacement(surface, "normal") for surface in ("base", "top")]
    assert not hinders_shrinkage(body, "3d", fixed_directions(body, "3d", both[:1]))
    assert hinders_shrinkage(body, "3d", fixed_directions(body, "3d", both))


@pytest.mark.serial
@pytest.mark.parametrize(
    "model, names", [("3d", "xyz"), ("axisymmetric", "rz"), ("plane-strain", "xy")]
)
def test_axes_are_numbered_in_the_order_of_the_coordinates(model, names):
    assert axes_of(model) == {name: number for number, name in enumerate(names)}


def test_axes_and_values(comm):
    body = blocks(comm, "3d").bodies["upper"]
    x, all_of = SurfaceDisplacement("top", "x"), fixed("side", "all", 3.0)
    found = fixed_directions(body, "3d", [x, all_of])
    assert [f.name for f in found] == [
        "upper/symmetry-x normal", "upper/symmetry-y normal", "upper/top x",
        "upper/side all", "upper/side all", "upper/side all",
    ]  # fmt: skip
    assert [f.symmetry for f in found] == [True, True, False, False, False, False]
    points, directions = located(comm, body, found[2])
    np.testing.assert_allclose(points[:, 2], 0.03)
    np.testing.assert_array_equal(directions, np.tile([1.0, 0.0, 0.0], (len(points), 1)))
    np.testing.assert_array_equal([located(comm, body, f)[1][0] for f in found[3:]], np.eye(3))
    assert [float(f.value(0.0)) for f in found[2:]] == [0.0, 3.0, 3.0, 3.0]


def test_a_condition_on_a_symmetry_plane_takes_its_place(comm):
    body = blocks(comm, "3d").bodies["upper"]
    names = [f.name for f in fixed_directions(body, "3d", [fixed("symmetry-x", "z")])]
    assert names == ["upper/symmetry-y normal", "upper/symmetry-x z"]


@pytest.mark.ranks
@pytest.mark.parametrize("spread", [False, True])
def test_axis_has_no_radial_motion(comm, monkeypatch, spread):
    if not spread:  # ranks without cells
        monkeypatch.setattr(PARTITION, on_the_last)
    mesh = blocks(comm, "axisymmetric", symmetry=True)
    found = fixed_directions(mesh.bodies["base"], "axisymmetric", [fixed("bottom", "z")])
    axis = next(f for f in found if f.name == "base axis")
    points, directions = located(comm, mesh.bodies["base"], axis)
    assert len(points) == 5
    np.testing.assert_allclose(points[:, 0], 0.0, atol=1e-15)
    np.testing.assert_array_equal(directions, [[1.0, 0.0]] * 5)


@pytest.mark.ranks
def test_refuses_a_direction_that_the_model_lacks(comm):
    body = blocks(comm, "axisymmetric").bodies["base"]
    with pytest.raises(CaseError, match=r"'y' on base/bottom: the model .* r, z, normal"):
        fixed_directions(body, "axisymmetric", [fixed("bottom", "y")])


def test_normals_of_a_round_surface(comm):
    body = cylinder(comm, "full").bodies["mould"]
    points, directions = located(comm, body, fixed_directions(body, "3d", [fixed("outside")])[0])
    radial = points[:, :2] / np.linalg.norm(points[:, :2], axis=1, keepdims=True)
    facets = len(np.unique(np.round(np.arctan2(*points[:, :2].T), 6)))
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-12)
    assert np.sum(directions[:, :2] * radial, axis=1).min() > np.cos(np.pi / facets)
    np.testing.assert_allclose(directions[:, 2], 0.0, atol=1e-12)


def test_a_sector_has_the_normals_of_the_whole(comm):
    located_normals = []
    for sector in ("full", "quarter"):
        body = cylinder(comm, sector).bodies["mould"]
        points, directions = located(
            comm, body, fixed_directions(body, "3d", [fixed("outside")])[-1]
        )
        here = np.all(points[:, :2] > -1e-9, axis=1)
        located_normals.append(sorted_by_place(points[here], directions[here]))
    np.testing.assert_allclose(located_normals[1][1], located_normals[0][1], atol=1e-12)
