"""The generators' meshes as gmsh holds them: sizes, symmetry, refusals."""

import basix
import numpy as np
import pytest

from castx.domain.gmsh_import import read_model
from castx.domain.source import gmsh_session
from castx.meshes import (
    GENERATORS,
    box_in_mould,
    core_in_ring,
    cylinder_in_mould,
    slab,
    stacked_blocks,
    two_slabs,
)

pytestmark = pytest.mark.serial

BOTH = pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
CYLINDER = {"radius": 0.03, "height": 0.1, "wall": 0.025}


def generated(generator, bodies, **arguments):
    with gmsh_session():
        generator(**arguments)
        return read_model(bodies, 3 if arguments["model"] == "3d" else 2, "test")


def edges(mesh):
    """Lengths of the edges of simplices, quadrilaterals and hexahedra, (edges, cells)."""
    corners = mesh.points[mesh.cells]
    pairs = basix.topology(basix.CellType[mesh.kind.name])[1]
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
        "box_in_mould": box_in_mould,
        "core_in_ring": core_in_ring,
    }


def test_round_mesh_keeps_to_the_size():
    size = 0.01
    longest = edges(cylinder(model="3d", sector="quarter", size=size)).max(axis=0)
    assert 0.7 * size < np.median(longest) < 1.8 * size
    assert longest.max() < 2.5 * size


def test_round_mesh_has_no_slivers():
    mesh = cylinder(model="3d", sector="quarter", size=0.01)
    volume = mesh.kind.corner_volumes(mesh.points[mesh.cells])[:, 0]
    assert (volume * np.sqrt(2) / edges(mesh).max(axis=0) ** 3).min() > 0.03


def scaled_jacobians(mesh):
    """Smallest det(∂x/∂ξ) at the corners of quadrilaterals or hexahedra over that of a box."""
    corners = mesh.points[mesh.cells]
    size = np.ones(corners.shape[:2])
    for i, j in basix.topology(basix.CellType[mesh.kind.name])[1]:
        length = np.linalg.norm(corners[:, i] - corners[:, j], axis=1)
        size[:, i] *= length
        size[:, j] *= length
    return (mesh.kind.corner_volumes(corners) / size).min(axis=1)


@pytest.mark.parametrize("sizes", [{}, {"interface_size": 0.002}, {"size": 0.1}])
@pytest.mark.parametrize("bore", [0.0, 0.01])
def test_quadrilaterals_of_round_plans_are_nearly_squares(sizes, bore):
    arguments = {"core_radius": 0.03, "core_bore": bore, "outer_radius": 0.05, "size": 0.004}
    mesh = generated(
        core_in_ring, ["core", "casting"], model="plane-strain", cells="quadrilaterals",
        **arguments | sizes,
    )  # fmt: skip
    assert scaled_jacobians(mesh).min() > 0.8
    if not sizes and not bore:
        assert (edges(mesh).max(axis=0) / edges(mesh).min(axis=0)).max() < 2.2
        assert edges(mesh).max() < 0.004 * 0.05 / 0.03 * 1.001


def test_hexahedra_of_a_cylinder_are_good_on_its_axis_and_keep_to_the_size():
    mesh = cylinder(model="3d", sector="quarter", size=0.01, floor=0.02, cells="quadrilaterals")
    assert scaled_jacobians(mesh).min() > 0.8
    assert edges(mesh).max() < 0.01 * 0.055 / 0.03
    inside = np.linalg.norm(mesh.points[mesh.cells].mean(axis=1)[:, :2], axis=1) < 0.03
    assert edges(mesh)[:, inside].max() < 0.0101
    assert edges(mesh).min() > 0.0025


def test_round_plans_of_quadrilaterals_mirror_themselves_about_the_diagonal():
    mesh = cylinder(model="3d", sector="quarter", size=0.01, cells="quadrilaterals")
    exchanged = mesh.points[:, [1, 0, 2]]
    assert {tuple(p) for p in mesh.points} == {tuple(p) for p in exchanged}


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


@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_interface_size_of_quadrilaterals_is_the_distance_of_nodes_across_it(model):
    sizes = {"size": 0.01, "interface_size": 0.002, "sector": "quarter"}
    mesh = cylinder(model=model, cells="quadrilaterals", **sizes)
    on_axis = mesh.points[(mesh.points[:, 1:] == 0).all(axis=1)]
    steps = np.diff(np.unique(np.round(on_axis[:, 0], 9)))
    radii = np.cumsum(steps)
    assert steps[np.abs(radii - 0.03) < 1e-9] < 0.0025
    assert 0.007 < steps[-1] < 0.01
    assert steps[radii < 0.03][0] > 0.004


@BOTH
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
def test_order_of_growth_reaches_the_mesh(model, cells):
    sizes = {"size": 0.005, "interface_size": 0.001} if model == "axisymmetric" else {"size": 0.01}
    sizes = {"interface_size": 0.002, **sizes, "sector": "quarter"}
    counts = [
        len(cylinder(model=model, cells=cells, order_of_growth=order, **sizes).cells)
        for order in (1.0, 3.0)
    ]
    assert counts[1] > 1.3 * counts[0]


@BOTH
def test_full_and_half_cylinder_are_mirror_images_of_the_quarter(cells):
    meshes = {
        sector: cylinder(model="3d", size=0.01, sector=sector, cells=cells)
        for sector in ("full", "half", "quarter")
    }
    full = cell_set(meshes["full"])
    assert full == cell_set(meshes["full"], [-1, 1, 1]) == cell_set(meshes["full"], [1, -1, 1])
    assert cell_set(meshes["half"]) < full and cell_set(meshes["quarter"]) < full
    assert len(meshes["full"].cells) == 2 * len(meshes["half"].cells)
    assert len(meshes["half"].cells) == 2 * len(meshes["quarter"].cells)
    assert meshes["half"].points[:, 0].min() == 0.0


@BOTH
@pytest.mark.parametrize(
    "model, upper, base",
    [("plane-strain", [0.03, 0.02], [0.05, 0.01]), ("3d", [0.03, 0.02, 0.03], [0.05, 0.01, 0.03])],
)
def test_full_blocks_are_mirror_images_of_the_symmetric_model(model, upper, base, cells):
    blocks = {
        symmetry: generated(
            stacked_blocks,
            ["upper", "base"],
            model=model,
            upper=upper,
            base=base,
            size=0.006,
            symmetry=symmetry,
            cells=cells,
        )
        for symmetry in (True, False)
    }
    dim = 3 if model == "3d" else 2
    sign = np.array([-1.0, *[1.0] * (dim - 1)])
    full = cell_set(blocks[False])
    assert cell_set(blocks[True]) < full
    assert full == cell_set(blocks[False], sign)
    assert len(full) == 2 ** (dim - 1) * len(cell_set(blocks[True]))


def box(model="plane-strain", **arguments):
    sides = [0.1, 0.06, 0.05] if model == "3d" else [0.1, 0.06]
    arguments = {"box": sides, "wall": 0.02, "size": 0.012, **arguments}
    return generated(box_in_mould, ["casting", "mould"], model=model, **arguments)


@BOTH
@pytest.mark.parametrize("lid", [True, False])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_box_is_its_own_mirror_image(model, lid, cells):
    mesh = box(model, lid=lid, cells=cells, interface_size=0.005)
    for axis in range(2 if model == "3d" else 1):
        sign = np.ones(mesh.points.shape[1])
        sign[axis] = -1.0
        assert cell_set(mesh, sign) == cell_set(mesh)
        assert {tuple(p) for p in mesh.points * sign + 0.0} == {tuple(p) for p in mesh.points}
    assert mesh.points[:, -1].max() == pytest.approx(0.08 if lid else 0.06)


@BOTH
@pytest.mark.parametrize("size", [0.012, 0.009])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_every_cell_of_a_box_with_lid_has_a_node_inside_it(model, size, cells):
    mesh = box(model, lid=True, size=size, cells=cells)
    shared = np.zeros(len(mesh.points), dtype=bool)
    shared[mesh.cells[mesh.bodies == 1]] = True
    assert not shared[mesh.cells[mesh.bodies == 0]].all(axis=1).any()


def test_box_is_refined_at_the_interface_on_all_sides():
    mesh = box(interface_size=0.002, cells="quadrilaterals", lid=True)
    middle = mesh.points[mesh.cells].mean(axis=1)
    width, height = np.abs(np.ptp(mesh.points[mesh.cells], axis=1)).T
    for place, size in ((np.abs(np.abs(middle[:, 0]) - 0.05), width),
                        (np.abs(np.abs(middle[:, 1] - 0.03) - 0.03), height)):  # fmt: skip
        assert size[place < 0.0015].max() < 0.0025
        assert size.max() > 0.008


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
        (
            box_in_mould,
            {"model": "axisymmetric", "box": [1, 1], "wall": 0.1},
            "axisymmetric generator is cylinder_in_mould",
        ),
        (
            box_in_mould,
            {"model": "3d", "box": [1, 1], "wall": 0.1},
            r"box must be \[width, height, depth\], got 2 numbers",
        ),
        (
            box_in_mould,
            {"model": "plane-stress", "box": [1, 0], "wall": 0.1},
            "each length of box must be positive",
        ),
        (
            box_in_mould,
            {"model": "plane-stress", "box": [1, 1], "wall": 0.0},
            "wall must be positive",
        ),
        (cylinder_in_mould, {"model": "3d", **CYLINDER, "cells": "bricks"}, "got 'bricks'"),
        (core_in_ring, {"model": "3d", "core_radius": 0.1, "outer_radius": 0.3}, "needs a height"),
    ],
)
def test_impossible_geometries_are_refused(generator, arguments, text):
    with gmsh_session(), pytest.raises(ValueError, match=text):
        generator(size=0.1, **arguments)
