"""Slabs and stacked blocks: places of bodies and nodes, symmetry, refusals."""

import numpy as np
import pytest

from castx.meshes.blocks import slab, stacked_blocks, two_slabs
from castx.meshes.grading import Sizing, graded
from tests.meshes.gmsh_meshes import BOTH, cell_set, generated, refused

pytestmark = pytest.mark.serial

BAR = {"length": 0.1, "width": 0.02}


@BOTH
def test_a_slab_is_refined_towards_its_wall(cells):
    sizes = {"size": 0.01, "interface_size": 0.002, "order_of_growth": 2.0}
    mesh = generated(slab, ["casting"], model="3d", depth=0.01, cells=cells, **BAR, **sizes)
    along = np.unique(np.round(mesh.points[:, 0], 12))
    np.testing.assert_allclose(along, graded(0.1, Sizing(0.01, 0.002, 2.0)), atol=1e-12)
    assert mesh.points.min(axis=0) == pytest.approx([0.0, 0.0, 0.0])
    assert mesh.points.max(axis=0) == pytest.approx([0.1, 0.02, 0.01])
    names = ("wall", "far", "bottom", "top", "back", "front")
    assert sorted(mesh.surface_names) == sorted(names)
    for axis, (low, high) in enumerate([names[:2], names[2:4], names[4:]]):
        for name, value in ((low, 0.0), (high, [0.1, 0.02, 0.01][axis])):
            faces = mesh.faces[mesh.face_surfaces == mesh.surface_names.index(name)]
            assert len(faces) > 0
            np.testing.assert_allclose(mesh.points[faces][:, :, axis], value, atol=1e-12)


@BOTH
def test_two_slabs_meet_at_zero(cells):
    mesh = generated(
        two_slabs, ["casting", "mould"], model="plane-strain", mould_length=0.05, size=0.005,
        cells=cells, **BAR,
    )  # fmt: skip
    middle = mesh.points[mesh.cells].mean(axis=1)
    assert np.array_equal(mesh.bodies, (middle[:, 0] < 0).astype(int))
    sides = mesh.points[mesh.cells][:, :, 0]
    assert not ((sides.min(axis=1) < -1e-12) & (sides.max(axis=1) > 1e-12)).any()
    assert (mesh.points[:, 0].min(), mesh.points[:, 0].max()) == pytest.approx((-0.05, 0.1))


@BOTH
def test_the_base_has_a_line_of_nodes_under_the_side_of_the_upper_block(cells):
    mesh = generated(
        stacked_blocks, ["upper", "base"], model="plane-strain", upper=[0.03, 0.02],
        base=[0.05, 0.01], size=0.007, cells=cells,
    )  # fmt: skip
    upper, base = (np.unique(mesh.cells[mesh.bodies == body]) for body in (0, 1))
    shared = mesh.points[np.intersect1d(upper, base)]
    np.testing.assert_allclose(shared[:, 1], 0.0, atol=1e-12)
    assert (shared[:, 0].min(), shared[:, 0].max()) == pytest.approx((0.0, 0.015))
    shelf = mesh.faces[mesh.face_surfaces == mesh.surface_names.index("shelf")]
    assert mesh.points[shelf][:, :, 0].min() == pytest.approx(0.015)


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


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"model": "3d"}, 'the model "3d" needs a depth'),
        ({"model": "3d", "depth": -1.0}, "depth must be positive"),
        ({"model": "plane-strain", "length": 0.0}, "length must be positive"),
    ],
)
@pytest.mark.parametrize("generator", [slab, two_slabs])
def test_impossible_slabs_are_refused(generator, arguments, text):
    rest = {} if generator is slab else {"mould_length": 1.0}
    refused(generator, text, **{"length": 1.0, "width": 1.0, **rest, **arguments})


@pytest.mark.parametrize(
    "arguments, text",
    [
        (
            {"model": "3d", "upper": [1.0, 1.0], "base": [2.0, 1.0, 1.0]},
            r"upper must be \[width, height, depth\], got 2 numbers",
        ),
        (
            {"model": "plane-strain", "upper": [1.0, 1.0], "base": [0.5, 1.0]},
            "at least as wide as the upper block, got 0.5 m under 1 m",
        ),
        (
            {"model": "axisymmetric", "upper": [1, 1], "base": [1, 1], "symmetry": False},
            "set symmetry = true",
        ),
    ],
)
def test_impossible_blocks_are_refused(arguments, text):
    refused(stacked_blocks, text, **arguments)
