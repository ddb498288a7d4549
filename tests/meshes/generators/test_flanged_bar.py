"""A bar with a flange: volumes by Pappus, what the flange clamps, surfaces, refusals."""

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.errors import CaseError
from castx.meshes.generators.flanged_bar import flanged_bar
from tests.meshes.gmsh_meshes import BOTH, generated, refused

pytestmark = pytest.mark.serial

BAR = {"bar_radius": 0.01, "length": 0.1, "flange_radius": 0.025, "flange_thickness": 0.015,
       "wall": 0.02}  # fmt: skip


def bar(**arguments):
    given = {"model": "axisymmetric", "size": 0.006, **BAR, **arguments}
    return generated(flanged_bar, ["casting", "mould"], **given)


def volume(mesh, body):
    """Volume of a full turn: ∫ 2πr dA, exact for straight cells by their centroids."""
    corners = mesh.points[mesh.cells[mesh.bodies == body]]
    share = 0.5 if corners.shape[1] == 3 else 1.0
    area = share * mesh.kind.corner_volumes(corners)[:, 0]
    return float((2.0 * np.pi * corners[..., 0].mean(axis=1) * area).sum())


@BOTH
@pytest.mark.parametrize("sizes", [{}, {"interface_size": 0.002}])
def test_bar_and_flange_have_their_volumes_and_the_mould_is_the_rest(cells, sizes):
    mesh = bar(cells=cells, **sizes)
    casting = np.pi * (0.01**2 * 0.085 + 0.025**2 * 0.015)
    assert volume(mesh, 0) == pytest.approx(casting, rel=1e-9)
    assert volume(mesh, 1) == pytest.approx(np.pi * 0.045**2 * 0.12 - casting, rel=1e-9)


@BOTH
def test_mould_stands_behind_the_flange_and_the_bar_leaves_it(cells):
    mesh = bar(cells=cells)
    middle = mesh.points[mesh.cells].mean(axis=1)
    behind = (middle[:, 1] > 0.015) & (middle[:, 0] > 0.01)
    assert behind.any() and (mesh.bodies[behind] == 1).all()
    assert (mesh.bodies[middle[:, 1] < 0.0] == 1).all()
    faces = mesh.faces[mesh.face_surfaces == mesh.surface_names.index("top")]
    radii = mesh.points[np.unique(faces), 0]
    assert radii.min() == 0.0 and radii.max() == pytest.approx(0.045)
    assert set(mesh.surface_names) == {"base", "top", "outside"}


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"flange_radius": 0.01 * (1.0 + 1e-12)}, "need bar_radius < flange_radius"),
        ({"flange_radius": 0.01}, "need bar_radius < flange_radius, got 0.01 and 0.01 m"),
        ({"flange_thickness": 0.1}, "need flange_thickness < length, got 0.1 and 0.1 m"),
        ({"wall": 0.0}, "wall must be positive"),
        ({"model": "3d"}, 'needs the model "axisymmetric"'),
    ],
)
def test_impossible_geometries_are_refused(arguments, text):
    refused(flanged_bar, text, **{"model": "axisymmetric", **BAR, **arguments})


@BOTH
@pytest.mark.parametrize("size", [0.007, 0.004, 0.0025])
def test_every_cell_of_the_casting_has_a_node_inside_it(size, cells):
    mesh = bar(size=size, cells=cells)
    shared = np.zeros(len(mesh.points), dtype=bool)
    shared[mesh.cells[mesh.bodies == 1]] = True
    assert not shared[mesh.cells[mesh.bodies == 0]].all(axis=1).any()


@pytest.mark.parametrize("key", ["flange_radius", "flange_thickness"])
def test_contradictions_are_said_before_meshing(key):
    given = {"generator": "flanged_bar", "model": "axisymmetric", "size": 0.006, **BAR}
    with pytest.raises(CaseError, match=key):
        Geometry.read({**given, key: 0.01 if key == "flange_radius" else 0.1})
