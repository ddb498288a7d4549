"""The generators' meshes as gmsh holds them: sizes, symmetry, refusals."""

import numpy as np
import pytest

from castx.gmsh_import import read_model
from castx.mesh_source import gmsh_session
from castx.meshes import (
    GENERATORS,
    core_in_ring,
    cylinder_in_mould,
    slab,
    stacked_blocks,
    two_slabs,
)
from castx.meshes.triangulation import volumes

pytestmark = pytest.mark.serial

CYLINDER = {"radius": 0.03, "height": 0.1, "wall": 0.025}


def generated(generator, bodies, **arguments):
    with gmsh_session():
        generator(**arguments)
        return read_model(bodies, 3 if arguments["model"] == "3d" else 2, "test")


def edges(mesh):
    corners = mesh.points[mesh.cells]
    n = corners.shape[1]
    pairs = [(i, j) for i in range(n) for j in range(i)]
    return np.stack([np.linalg.norm(corners[:, i] - corners[:, j], axis=1) for i, j in pairs])


def cell_set(mesh, sign=None):
    points = mesh.points if sign is None else mesh.points * sign
    return {frozenset(map(tuple, np.round(points[cell], 9) + 0.0)) for cell in mesh.cells}


def cylinder(**arguments):
    return generated(cylinder_in_mould, ["casting", "mould"], **CYLINDER, **arguments)


def test_all_generators_are_known_by_their_names():
    assert GENERATORS == {
        "slab": slab,
        "two_slabs": two_slabs,
        "cylinder_in_mould": cylinder_in_mould,
        "stacked_blocks": stacked_blocks,
        "core_in_ring": core_in_ring,
    }


def test_round_mesh_keeps_to_the_size():
    size = 0.01
    longest = edges(cylinder(model="3d", sector="quarter", size=size)).max(axis=0)
    assert 0.7 * size < np.median(longest) < 1.8 * size
    assert longest.max() < 2.5 * size


def test_round_mesh_has_no_slivers():
    mesh = cylinder(model="3d", sector="quarter", size=0.01)
    shape = volumes(mesh.points, mesh.cells) * 6 * np.sqrt(2) / edges(mesh).max(axis=0) ** 3
    assert shape.min() > 0.03


@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_interface_size_refines_at_the_interface_only(model):
    fine = cylinder(model=model, size=0.01, interface_size=0.004, sector="quarter")
    coarse = cylinder(model=model, size=0.01, sector="quarter")
    radius = np.linalg.norm(fine.points[:, : fine.points.shape[1] - 1], axis=1)
    inside = np.unique(np.round(radius[radius < 0.03 - 1e-9], 9))[-1]
    assert 0.03 - inside < 1.2 * 0.004
    shortest, everywhere = edges(fine).min(axis=0), edges(coarse).min(axis=0)
    near = np.linalg.norm(fine.points[fine.cells][:, :, :-1].mean(axis=1), axis=1)
    assert np.median(shortest[np.abs(near - 0.03) < 0.003]) < 0.6 * np.median(everywhere)
    assert np.median(shortest[np.abs(near - 0.055) < 0.003]) > 0.7 * np.median(everywhere)


def test_order_of_growth_reaches_the_mesh():
    counts = [
        len(
            cylinder(
                model="axisymmetric", size=0.005, interface_size=0.001, order_of_growth=o
            ).cells
        )
        for o in (1.0, 3.0)
    ]
    assert counts[1] > 1.3 * counts[0]


def test_full_and_half_cylinder_are_mirror_images_of_the_quarter():
    meshes = {s: cylinder(model="3d", size=0.01, sector=s) for s in ("full", "half", "quarter")}
    full = cell_set(meshes["full"])
    assert full == cell_set(meshes["full"], [-1, 1, 1]) == cell_set(meshes["full"], [1, -1, 1])
    assert cell_set(meshes["half"]) < full and cell_set(meshes["quarter"]) < full
    assert len(meshes["full"].cells) == 2 * len(meshes["half"].cells)
    assert len(meshes["half"].cells) == 2 * len(meshes["quarter"].cells)
    assert meshes["half"].points[:, 0].min() == 0.0


@pytest.mark.parametrize(
    "model, upper, base",
    [("plane-strain", [0.03, 0.02], [0.05, 0.01]), ("3d", [0.03, 0.02, 0.03], [0.05, 0.01, 0.03])],
)
def test_full_blocks_are_mirror_images_of_the_symmetric_model(model, upper, base):
    blocks = {
        symmetry: generated(
            stacked_blocks,
            ["upper", "base"],
            model=model,
            upper=upper,
            base=base,
            size=0.006,
            symmetry=symmetry,
        )
        for symmetry in (True, False)
    }
    dim = 3 if model == "3d" else 2
    sign = np.array([-1.0, *[1.0] * (dim - 1)])
    full = cell_set(blocks[False])
    assert cell_set(blocks[True]) < full
    assert full == cell_set(blocks[False], sign)
    assert len(full) == 2 ** (dim - 1) * len(cell_set(blocks[True]))


@pytest.mark.parametrize(
    "generator, arguments, text",
    [
        (slab, {"model": "3d", "length": 1.0, "width": 1.0}, 'the model "3d" needs a depth'),
        (
            slab,
            {"model": "3d", "length": 1.0, "width": 1.0, "depth": -1.0},
            "depth must be positive",
        ),
        (slab, {"model": "plane-strain", "length": 0.0, "width": 1.0}, "length must be positive"),
        (cylinder_in_mould, {"model": "plane-strain", **CYLINDER}, 'got "plane-strain"'),
        (cylinder_in_mould, {"model": "3d", **CYLINDER, "floor": -0.1}, "floor must be 0 or a"),
        (
            cylinder_in_mould,
            {"model": "3d", **CYLINDER, "sector": "third"},
            "one of full, half, quarter; got 'third'",
        ),
        (
            stacked_blocks,
            {"model": "3d", "upper": [1.0, 1.0], "base": [2.0, 1.0, 1.0]},
            r"upper must be \[width, height, depth\], got 2 numbers",
        ),
        (
            stacked_blocks,
            {"model": "plane-strain", "upper": [1.0, 1.0], "base": [0.5, 1.0]},
            "at least as wide as the upper block, got 0.5 m under 1 m",
        ),
        (
            stacked_blocks,
            {"model": "axisymmetric", "upper": [1, 1], "base": [1, 1], "symmetry": False},
            "set symmetry = true",
        ),
        (
            core_in_ring,
            {"model": "plane-stress", "core_radius": 0.1, "core_bore": 0.2, "outer_radius": 0.3},
            "need 0 <= core_bore < core_radius < outer_radius, got 0.2, 0.1, 0.3 m",
        ),
        (core_in_ring, {"model": "3d", "core_radius": 0.1, "outer_radius": 0.3}, "needs a height"),
    ],
)
def test_impossible_geometries_are_refused(generator, arguments, text):
    with gmsh_session(), pytest.raises(ValueError, match=text):
        generator(size=0.1, **arguments)
