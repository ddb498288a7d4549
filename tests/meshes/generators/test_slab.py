"""Slabs: places of nodes, surfaces, refusals."""

import numpy as np
import pytest

from castx.meshes.generators.slab import slab
from castx.meshes.grading import Sizing, graded
from tests.meshes.gmsh_meshes import BOTH, generated, refused

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


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"model": "3d"}, 'the model "3d" needs a depth'),
        ({"model": "3d", "depth": -1.0}, "depth must be positive"),
        ({"model": "plane-strain", "length": 0.0}, "length must be positive"),
    ],
)
def test_impossible_slabs_are_refused(arguments, text):
    refused(slab, text, **{"length": 1.0, "width": 1.0, **arguments})
