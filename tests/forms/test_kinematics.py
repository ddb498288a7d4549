"""Strains of every model against fields whose strains are known."""

from __future__ import annotations

import math
from functools import cache

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import kinematics

pytestmark = pytest.mark.serial


@cache
def cell(dimension: int) -> mesh.Mesh:
    """Return a mesh of each process of its own, one unit square or cube."""
    if dimension == 2:
        return mesh.create_rectangle(MPI.COMM_SELF, [(1.0, 0.0), (2.0, 1.0)], (1, 1))
    return mesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1)


def integrated(tensor, domain) -> np.ndarray:
    """Return the integrals of the components of a (3, 3) tensor over the cell."""
    forms = [fem.form(tensor[i, j] * ufl.dx(domain)) for i in range(3) for j in range(3)]
    return np.array([fem.assemble_scalar(form) for form in forms]).reshape(3, 3)


@pytest.mark.parametrize("model", ["plane-strain", "plane-stress", "axisymmetric"])
def test_strain_in_the_plane(model):
    domain = cell(2)
    x = ufl.SpatialCoordinate(domain)
    u = ufl.as_vector([2 * x[0] + 3 * x[1], 5 * x[0] - 7 * x[1]])
    out_of_plane = 11.0
    found = integrated(kinematics.strain(u, model, x, out_of_plane), domain)
    # The mean of u_r / r over 1 < r < 2, 0 < z < 1 is 2 + 3/2 ln 2.
    normal = 2 + 1.5 * math.log(2) if model == "axisymmetric" else out_of_plane
    expected = [[2, 4, 0], [4, -7, 0], [0, 0, normal]]
    np.testing.assert_allclose(found, expected, rtol=2e-4 if model == "axisymmetric" else 1e-12)


def test_strain_in_space():
    domain = cell(3)
    x = ufl.SpatialCoordinate(domain)
    A = np.arange(9.0).reshape(3, 3) ** 1.5
    found = integrated(kinematics.strain(ufl.as_matrix(A) * x, "3d", x), domain)
    np.testing.assert_allclose(found, (A + A.T) / 2, rtol=1e-12)


def test_weight_is_the_circumference():
    domain = cell(2)
    x = ufl.SpatialCoordinate(domain)
    dx = kinematics.WeightedMeasure(kinematics.weight("axisymmetric", x), ufl.dx(domain))
    assert fem.assemble_scalar(fem.form(1.0 * dx)) == pytest.approx(math.pi * (4 - 1), rel=1e-12)
    dx = kinematics.WeightedMeasure(kinematics.weight("plane-strain", x), ufl.dx(domain))
    assert fem.assemble_scalar(fem.form(1.0 * dx)) == pytest.approx(1.0, rel=1e-12)


def test_components_and_tensor_are_inverse():
    domain = cell(3)
    for model, count in (("3d", 6), ("plane-strain", 4)):
        values = np.arange(1.0, count + 1)
        tensor = kinematics.symmetric_tensor(fem.Constant(domain, values), model)
        back = kinematics.symmetric_components(tensor, model)
        found = [
            fem.assemble_scalar(fem.form(back[i] * ufl.dx(domain))) for i in range(count)
        ]
        np.testing.assert_allclose(found, values, rtol=1e-12)
        deviator = integrated(kinematics.deviator(tensor), domain)
        assert abs(np.trace(deviator)) < 1e-12
        np.testing.assert_allclose(deviator - np.diag(np.diag(deviator)), off_diagonal(values))


def off_diagonal(values: np.ndarray) -> np.ndarray:
    xy, xz, yz = (*values[3:], 0, 0)[:3]
    return np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
