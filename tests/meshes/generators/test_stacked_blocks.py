"""Stacked blocks: places of nodes, symmetry, refusals."""

import numpy as np
import pytest

from castx.meshes.generators.stacked_blocks import GENERATOR, stacked_blocks
from tests.meshes.gmsh_meshes import BOTH, cell_set, generated, refused

pytestmark = pytest.mark.serial


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
def test_blocks_in_space_have_their_lengths(cells):
    """A quarter of each: half of width and depth, all of the height."""
    mesh = generated(
        stacked_blocks, ["upper", "base"], model="3d", upper=[0.03, 0.02, 0.04],
        base=[0.05, 0.01, 0.06], size=0.0019, cells=cells,
    )  # fmt: skip
    for body, low, high in ((0, 0.0, (0.015, 0.02, 0.02)), (1, -0.01, (0.025, 0.03, 0.0))):
        points = mesh.points[np.unique(mesh.cells[mesh.bodies == body])]
        np.testing.assert_allclose(points.min(axis=0), (0.0, 0.0, low), atol=1e-12)
        np.testing.assert_allclose(points.max(axis=0), high, atol=1e-12)


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


@pytest.mark.parametrize("missing, refuses", [(5e-10, False), (5e-9, True)])
def test_a_base_may_be_narrower_by_rounding(missing, refuses):
    """By a billionth, for the mesh and for the case alike."""
    sides = {"upper": [0.03, 0.02], "base": [0.03 * (1.0 - missing), 0.01]}
    assert bool(list(GENERATOR.problems(sides, "plane-strain"))) == refuses
    arguments = {"model": "plane-strain", "size": 0.01, **sides}
    if refuses:
        refused(stacked_blocks, "at least as wide as the upper block", **arguments)
    else:
        generated(stacked_blocks, ["upper", "base"], **arguments)
