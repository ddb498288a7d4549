"""A cylinder in its mould: sizes of cells, refinement at the interface, sectors, refusals."""

import numpy as np
import pytest

from castx.meshes.generators.cylinder_in_mould import cylinder_in_mould
from tests.meshes.gmsh_meshes import BOTH, cell_set, edges, generated, refused, scaled_jacobians

pytestmark = pytest.mark.serial

CYLINDER = {"radius": 0.03, "height": 0.1, "wall": 0.025}


def cylinder(**arguments):
    return generated(cylinder_in_mould, ["casting", "mould"], **CYLINDER, **arguments)


def test_round_mesh_keeps_to_the_size():
    size = 0.01
    longest = edges(cylinder(model="3d", sector="quarter", size=size)).max(axis=0)
    assert 0.7 * size < np.median(longest) < 1.8 * size
    assert longest.max() < 2.5 * size


def test_round_mesh_has_no_slivers():
    mesh = cylinder(model="3d", sector="quarter", size=0.01)
    volume = mesh.kind.corner_volumes(mesh.points[mesh.cells])[:, 0]
    assert (volume * np.sqrt(2) / edges(mesh).max(axis=0) ** 3).min() > 0.03


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


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"model": "plane-strain"}, 'got "plane-strain"'),
        ({"model": "3d", "floor": -0.1}, "floor must be 0 or a"),
        ({"model": "3d", "sector": "third"}, "one of full, half, quarter; got 'third'"),
        ({"model": "3d", "cells": "bricks"}, "got 'bricks'"),
        ({"model": "axisymmetric", "wall": 0.0}, "wall must be positive"),
    ],
)
def test_impossible_geometries_are_refused(arguments, text):
    refused(cylinder_in_mould, text, **{**CYLINDER, **arguments})
