"""Two slabs face to face: places of bodies, refusals."""

import numpy as np
import pytest

from castx.meshes.generators.two_slabs import two_slabs
from tests.meshes.gmsh_meshes import BOTH, generated, refused

pytestmark = pytest.mark.serial

BAR = {"length": 0.1, "width": 0.02}


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


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"model": "3d"}, 'the model "3d" needs a depth'),
        ({"model": "3d", "depth": -1.0}, "depth must be positive"),
        ({"model": "plane-strain", "length": 0.0}, "length must be positive"),
    ],
)
def test_impossible_slabs_are_refused(arguments, text):
    refused(two_slabs, text, **{"length": 1.0, "mould_length": 1.0, "width": 1.0, **arguments})
