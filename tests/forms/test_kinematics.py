"""Strains of every model against fields whose strains are known."""

from __future__ import annotations

import math
from functools import cache

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import kinematics, momentum


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


@pytest.mark.parametrize("mixed", [True, False])
def test_plane_stress_has_none_out_of_plane(mixed):
    """With σ_zz = 0 the in-plane stress is that of E/(1 - ν²), thermal strain and e0 included."""
    domain = cell(2)
    x = ufl.SpatialCoordinate(domain)
    E, nu, thermal = 3.0, 0.25, 0.6
    G, K = E / (2 * (1 + nu)), E / (3 * (1 - 2 * nu))
    born = ufl.as_tensor([[0.2, 0.1, 0.0], [0.1, 0.3, 0.0], [0.0, 0.0, -0.5]])
    state = momentum.ElasticState(G, 1 / K, thermal, born)
    u = ufl.as_vector([2 * x[0] + x[1], 3 * x[0] - x[1]])
    if mixed:
        # p solves tr ε = p/K + e^θ with ε_zz = (∇·u)/2 - 3p/(4G) + 3/2 e0_zz.
        in_plane = 1.0
        p = (1.5 * in_plane - 0.75 - thermal) / (1 / K + 3 / (4 * G))
        total = momentum.mixed_strain(u, p, state, "plane-stress", x)
        stress = momentum.deviatoric_stress(total, state) + p * ufl.Identity(3)
    else:
        stress = momentum.displacement_stress(u, state, "plane-stress", x)
    found = integrated(stress, domain)
    # Reference: Hooke's law of the strain without e^θ/3 and e0, condensed by hand.
    free = np.array([[2, 2, 0], [2, -1, 0], [0, 0, 0]]) - thermal / 3 * np.eye(3)
    free -= np.array([[0.2, 0.1, 0], [0.1, 0.3, 0], [0, 0, -0.5]])
    lame = K - 2 * G / 3
    normal = -lame * (free[0, 0] + free[1, 1]) / (lame + 2 * G)
    free[2, 2] = normal
    expected = lame * np.trace(free) * np.eye(3) + 2 * G * free
    assert abs(expected[2, 2]) < 1e-12
    np.testing.assert_allclose(found, expected, atol=1e-12)
