"""A box in its mould: symmetry, nodes inside every cell, refinement, refusals."""

import numpy as np
import pytest

from castx.meshes.generators.box_in_mould import box_in_mould
from tests.meshes.gmsh_meshes import BOTH, cell_set, generated, refused

pytestmark = pytest.mark.serial


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


def test_floor_and_lid_are_layered_alike():
    heights = np.unique(box(lid=True, interface_size=0.003).points[:, 1])
    assert (heights < 0.0).sum() > 3
    np.testing.assert_allclose(heights, 0.06 - heights[::-1], atol=1e-12)


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
    "arguments, text",
    [
        ({"model": "axisymmetric"}, "axisymmetric generator is cylinder_in_mould"),
        ({"model": "3d"}, r"box must be \[width, height, depth\], got 2 numbers"),
        ({"model": "plane-stress", "box": [1, 0]}, "each length of box must be positive"),
        ({"model": "plane-stress", "wall": 0.0}, "wall must be positive"),
    ],
)
def test_impossible_geometries_are_refused(arguments, text):
    refused(box_in_mould, text, **{"box": [1, 1], "wall": 0.1, **arguments})
