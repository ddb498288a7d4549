"""Names of bodies and faces in the model that gmsh gets."""

import gmsh
import numpy as np
import pytest

from castx.domain.gmsh_import import read_model
from castx.domain.source import gmsh_session
from castx.meshes.linear_mesh import QUADRILATERALS
from castx.meshes.model import everything_else, fill_model, plane, round_surface, symmetry_plane
from castx.meshes.structured import grid, swept

pytestmark = pytest.mark.serial

LEFT_AND_RIGHT = ["left", "right"]


def two_squares():
    """Return the rectangle 0 ≤ x ≤ 2, 0 ≤ y ≤ 1 with a body on either side of x = 1."""
    line = np.array([0.0, 0.5, 1.0])
    x = np.concatenate([line, 1.0 + line[1:]])
    return grid(x, line, lambda m: (m[:, 0] > 1).astype(int), QUADRILATERALS)


def filled(mesh, surfaces, bodies=LEFT_AND_RIGHT):
    with gmsh_session():
        fill_model(mesh, bodies, surfaces)
        return read_model(bodies, mesh.dimension, "test")


def lengths(found):
    """Return the summed length of the named faces of a plane mesh."""
    sizes = np.linalg.norm(np.diff(found.points[found.faces], axis=1)[:, 0], axis=1)
    sums = np.bincount(found.face_surfaces, sizes)
    return dict(zip(found.surface_names, sums, strict=True))


def test_a_free_face_belongs_to_the_first_surface_that_takes_all_its_nodes():
    bottom, low = plane("bottom", 1, 0.0, 1e-9), plane("bottom too", 1, 0.0, 1e-9)
    found = filled(two_squares(), [bottom, low, everything_else("rest")])
    assert lengths(found) == pytest.approx({"bottom": 2.0, "rest": 4.0})


def test_faces_between_bodies_get_no_name():
    found = filled(two_squares(), [plane("middle", 0, 1.0, 1e-9)])
    assert found.surface_names == ()


def test_planes_of_symmetry_are_named_by_the_coordinate_they_cut():
    assert [symmetry_plane(axis) for axis in range(3)] == ["symmetry-x", "symmetry-y", "symmetry-z"]


def test_surfaces_of_one_name_are_one():
    ends = [plane("end", 0, 0.0, 1e-9), plane("end", 0, 2.0, 1e-9)]
    assert lengths(filled(two_squares(), ends)) == pytest.approx({"end": 2.0})


def test_cells_go_to_the_bodies_of_their_regions():
    mesh = two_squares()
    found = filled(mesh, [])
    middle = found.points[found.cells].mean(axis=1)
    assert np.array_equal(found.bodies, (middle[:, 0] > 1).astype(int))
    assert len(found.cells) == len(mesh.cells) and len(found.points) == len(mesh.points)


def test_round_surfaces_surround_the_last_axis():
    x = np.array([-1.0, 1.0])
    solid = swept(grid(x, x, lambda m: np.zeros(len(m), int)), np.array([0.0, 5.0]), lambda r, z: r)
    found = filled(solid, [round_surface("mantle", np.sqrt(2.0), 1e-9)], ["block"])
    # All corners lie at the radius, so that even the ends belong to it.
    assert len(found.faces) == 12
    assert filled(solid, [round_surface("mantle", 1.0, 1e-9)], ["block"]).surface_names == ()


def test_the_model_is_filled_and_not_written_over():
    with gmsh_session():
        fill_model(two_squares(), LEFT_AND_RIGHT, [plane("bottom", 1, 0.0, 1e-9)])
        groups = {
            (dim, gmsh.model.getPhysicalName(dim, tag))
            for dim, tag in gmsh.model.getPhysicalGroups()
        }
    assert groups == {(2, "left"), (2, "right"), (1, "bottom")}
