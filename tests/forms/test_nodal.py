"""Volumes, areas and normals of the nodes of a ring and of the unit square."""

import numpy as np
import pytest
import ufl
from dolfinx import fem, la, mesh

from castx.forms.kinematics import weight as model_weight
from castx.forms.nodal import nodal_area_vector, nodal_measure


def owned_values(form, gdim):
    vector = fem.assemble_vector(fem.form(form))
    vector.scatter_reverse(la.InsertMode.add)
    return vector.array[: vector.index_map.size_local * vector.block_size].reshape(-1, gdim)


@pytest.fixture
def square(comm):
    return mesh.create_unit_square(comm, 4, 4)


@pytest.mark.parametrize(("model", "volume"), [("axisymmetric", 3 * np.pi), ("plane-strain", 1.0)])
def test_volumes_of_all_nodes_are_the_volume(comm, model, volume):
    ring = mesh.create_rectangle(comm, [[1.0, 0.0], [2.0, 1.0]], [4, 3])
    v = ufl.TestFunction(fem.functionspace(ring, ("Lagrange", 1)))
    circumference = model_weight(model, ufl.SpatialCoordinate(ring))
    volumes = owned_values(nodal_measure(v, circumference, ufl.dx), 1)
    assert comm.allreduce(volumes.sum()) == pytest.approx(volume)
    assert (volumes > 0).all()


@pytest.mark.parametrize("weight, perimeter", [(1.0, 4.0), (3.0, 12.0)])
def test_areas_add_up_to_the_weighted_boundary(square, weight, perimeter, comm):
    v = ufl.TestFunction(fem.functionspace(square, ("Lagrange", 1)))
    areas = owned_values(nodal_measure(v, weight, ufl.ds), 1)
    assert comm.allreduce(areas.sum()) == pytest.approx(perimeter)
    assert (areas > -1e-15).all()


def test_area_vectors_point_outwards_and_close(square, comm):
    space = fem.functionspace(square, ("Lagrange", 1, (2,)))
    form = nodal_area_vector(ufl.TestFunction(space), ufl.FacetNormal(square), 1.0, ufl.ds)
    vectors = owned_values(form, 2)
    points = space.tabulate_dof_coordinates()[: len(vectors), :2]
    assert comm.allreduce(vectors.sum(axis=0)) == pytest.approx([0.0, 0.0], abs=1e-14)
    # Divergence theorem for the position: ∫ x·n dS = 2 area.
    assert comm.allreduce((vectors * points).sum()) == pytest.approx(2.0)
    right = (np.abs(points[:, 0] - 1.0) < 1e-12) & (np.abs(points[:, 1] - 0.5) < 0.49)
    assert np.allclose(vectors[right], [0.25, 0.0])
