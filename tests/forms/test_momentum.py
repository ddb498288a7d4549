"""The balance of momentum on single cells against dense matrices, and its derivative and loads."""

from __future__ import annotations

import math
from functools import cache

from mpi4py import MPI

import basix.ufl
import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import kinematics, momentum
from castx.forms.momentum import PointState

pytestmark = pytest.mark.serial

CORNERS = {
    2: np.array([[0.1, 0.2], [1.3, 0.1], [0.4, 0.9]]),
    3: np.array([[0.1, 0.2, 0.0], [1.3, 0.1, 0.2], [0.4, 0.9, -0.1], [0.3, 0.2, 0.8]]),
}
MODEL = {2: "plane-strain", 3: "3d"}
STRESS = np.array([[2.0, 0.7, 0.3], [0.7, -1.5, 0.4], [0.3, 0.4, -0.5]])
DIRECTION = STRESS / np.linalg.norm(STRESS)
SHEAR, RADIAL, COMPRESSIBILITY, THERMAL = 3.0, -1.1, 0.4, 0.02
dimensions = pytest.mark.parametrize("dimension", [2, 3])


@cache
def cell(dimension: int) -> mesh.Mesh:
    """Return a mesh of one triangle or tetrahedron, on each process."""
    kind = {2: "triangle", 3: "tetrahedron"}[dimension]
    element = basix.ufl.element("Lagrange", kind, 1, shape=(dimension,))
    corners = CORNERS[dimension]
    cells = np.arange(len(corners))[None]
    return mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=corners, e=element)


@cache
def spaces(dimension: int) -> tuple[fem.FunctionSpace, np.ndarray, np.ndarray]:
    """Return the u/p space of the cell, and the numbers of u (nodes, dimension) and p (nodes,)."""
    domain = cell(dimension)
    kind = domain.basix_cell()
    vector = basix.ufl.element("Lagrange", kind, 1, shape=(dimension,))
    scalar = basix.ufl.element("Lagrange", kind, 1)
    space = fem.functionspace(domain, basix.ufl.mixed_element([vector, scalar]))
    pressures, of_p = space.sub(1).collapse()
    _, of_u = space.sub(0).collapse()
    points = pressures.tabulate_dof_coordinates()[:, :dimension]
    node = [int(np.linalg.norm(points - x, axis=1).argmin()) for x in CORNERS[dimension]]
    return space, np.array(of_u).reshape(-1, dimension)[node], np.ravel(of_p)[node]


def tensor(array: np.ndarray):
    return ufl.as_matrix(array.tolist())


def state(dimension: int, **changes) -> PointState:
    """Return a state that is the same at all points, with everything that may differ."""
    given = {
        "stress": tensor(STRESS),
        "isotropic": SHEAR,
        "radial": RADIAL,
        "direction": tensor(DIRECTION),
        "compressibility": COMPRESSIBILITY,
        "thermal_strain": THERMAL,
    }
    return PointState(**{**given, **changes})


def measure(dimension: int, model: str = ""):
    domain = cell(dimension)
    weight = kinematics.weight(model or MODEL[dimension], ufl.SpatialCoordinate(domain))
    dx = ufl.dx(domain, metadata={"quadrature_degree": 3})
    return kinematics.WeightedMeasure(weight, dx)


def strain(dimension: int, u, model: str = ""):
    x = ufl.SpatialCoordinate(cell(dimension))
    return kinematics.strain(u, model or MODEL[dimension], x)


class Dense:
    """Matrices of one linear simplex, by hand."""

    def __init__(self, corners: np.ndarray) -> None:
        nodes, dimension = corners.shape
        jacobian = (corners[1:] - corners[0]).T
        self.volume = abs(np.linalg.det(jacobian)) / math.factorial(dimension)
        reference = np.concatenate([-np.ones((1, dimension)), np.eye(dimension)])
        self.gradients = reference @ np.linalg.inv(jacobian)
        # Strain (3, 3) of each displacement of a node in one direction.
        self.strains = np.zeros((nodes * dimension, 3, 3))
        for a in range(nodes):
            for i in range(dimension):
                gradient = np.zeros((3, 3))
                gradient[i, :dimension] = self.gradients[a]
                self.strains[a * dimension + i] = 0.5 * (gradient + gradient.T)
        self.traces = np.trace(self.strains, axis1=1, axis2=2)
        self.mass = self.volume * (np.ones((nodes, nodes)) + np.eye(nodes))
        self.mass /= (dimension + 1) * (dimension + 2)
        self.weights = np.full(nodes, self.volume / nodes)

    def stiffness(self, isotropic: float, radial: float) -> np.ndarray:
        """Return V Bᵀ (a Dev + b n ⊗ n) B."""
        deviators = self.strains - self.traces[:, None, None] / 3 * np.eye(3)
        along = np.einsum("ij,aij->a", DIRECTION, self.strains)
        found = isotropic * np.einsum("aij,bij->ab", deviators, self.strains)
        return self.volume * (found + radial * np.outer(along, along))


def values(dimension: int) -> tuple[fem.Function, np.ndarray, np.ndarray]:
    """Return a displacement and pressure without any pattern, and their nodal values."""
    space, of_u, of_p = spaces(dimension)
    function = fem.Function(space)
    random = np.random.default_rng(5)
    function.x.array[:] = random.standard_normal(len(function.x.array))
    return function, function.x.array[of_u].ravel(), function.x.array[of_p]


def residual(dimension: int, point: PointState, function=None):
    space = spaces(dimension)[0]
    (u, p), (v, q) = ufl.split(function), ufl.TestFunctions(space)
    dx = measure(dimension)
    return momentum.mixed_internal_virtual_work(
        strain(dimension, u), p, strain(dimension, v), q, point, dx, dx
    )


def tangent(dimension: int, point: PointState):
    space = spaces(dimension)[0]
    (du, dp), (v, q) = ufl.TrialFunctions(space), ufl.TestFunctions(space)
    dx = measure(dimension)
    return momentum.mixed_tangent(
        strain(dimension, du), dp, strain(dimension, v), q, point, dx, dx
    )


def vector(form) -> np.ndarray:
    return fem.assemble_vector(fem.form(form)).array


def matrix(form) -> np.ndarray:
    return fem.assemble_matrix(fem.form(form)).to_dense()


liquids = pytest.mark.parametrize("trapped", [0.0, 1.0])


@dimensions
@liquids
def test_the_mixed_residual_of_a_cell(dimension, trapped):
    """R_u = V s:B + ∫p tr B, R_q = ∫ N (tr ε - e^θ - p/K), trapped liquid included."""
    dense, (function, u, p) = Dense(CORNERS[dimension]), values(dimension)
    given = 4.5
    point = state(dimension, trapped=trapped, trapped_pressure=given)
    found = vector(residual(dimension, point, function))
    _, of_u, of_p = spaces(dimension)
    pressure = dense.volume * ((1 - trapped) * p.mean() + trapped * given)
    forces = dense.volume * np.einsum("ij,aij->a", STRESS, dense.strains) + pressure * dense.traces
    np.testing.assert_allclose(found[of_u].ravel(), forces, rtol=1e-12)
    dilatation = (1 - trapped) * (dense.traces @ u - THERMAL)
    volumes = dilatation * dense.weights
    volumes -= COMPRESSIBILITY * (dense.mass @ p - trapped * given * dense.weights)
    np.testing.assert_allclose(found[of_p], volumes, rtol=1e-12, atol=1e-13)


@pytest.mark.sampled
@dimensions
@liquids
@pytest.mark.parametrize("radial", [RADIAL, None])
def test_the_mixed_tangent_of_a_cell(dimension, trapped, radial):
    dense = Dense(CORNERS[dimension])
    point = state(dimension, trapped=trapped, radial=radial)
    found = matrix(tangent(dimension, point))
    _, of_u, of_p = spaces(dimension)
    u = of_u.ravel()
    stiffness = dense.stiffness(SHEAR, radial or 0.0)
    coupling = (1 - trapped) * np.outer(dense.traces, dense.weights)
    np.testing.assert_allclose(found[np.ix_(u, u)], stiffness, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(found[np.ix_(u, of_p)], coupling, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(found[np.ix_(of_p, u)], coupling.T, rtol=1e-12, atol=1e-14)
    expected = -COMPRESSIBILITY * dense.mass
    np.testing.assert_allclose(found[np.ix_(of_p, of_p)], expected, rtol=1e-12)


def hardening_stress(total):
    """Return the stress of a law whose tangent is a dev(dε) + b n (n:dε)."""
    n = tensor(DIRECTION)
    return SHEAR * kinematics.deviator(total) + RADIAL * ufl.inner(n, total) * n


@dimensions
@liquids
def test_the_mixed_tangent_is_the_derivative_of_the_residual(dimension, trapped):
    function = values(dimension)[0]
    total = strain(dimension, ufl.split(function)[0])
    point = state(dimension, stress=hardening_stress(total), trapped=trapped)
    expected = matrix(ufl.derivative(residual(dimension, point, function), function))
    np.testing.assert_allclose(matrix(tangent(dimension, point)), expected, atol=1e-12)


@dimensions
@liquids
def test_the_work_of_the_pressure_of_a_pocket_is_the_derivative_by_it(dimension, trapped):
    """∂R/∂p_trapped: V tr B, and the weights of the nodes over K."""
    space, of_u, of_p = spaces(dimension)
    function = values(dimension)[0]
    pressure = fem.Function(fem.functionspace(cell(dimension), ("DG", 0)))
    pressure.x.array[:] = 4.5
    marker = fem.Constant(cell(dimension), trapped)
    point = state(dimension, trapped=marker, trapped_pressure=pressure)
    (v, q), dx = ufl.TestFunctions(space), measure(dimension)
    found = vector(momentum.pocket_pressure_work(strain(dimension, v), q, point, dx))
    derivative = matrix(ufl.derivative(residual(dimension, point, function), pressure))
    np.testing.assert_allclose(found, derivative[:, 0], rtol=1e-12, atol=1e-14)
    dense = Dense(CORNERS[dimension])
    expected = trapped * dense.volume * dense.traces
    np.testing.assert_allclose(found[of_u].ravel(), expected, rtol=1e-12, atol=1e-14)
    expected = trapped * COMPRESSIBILITY * dense.weights
    np.testing.assert_allclose(found[of_p], expected, rtol=1e-12)
    rows = vector(momentum.pocket_pressure_work(strain(dimension, v), 0.0, point, dx))
    np.testing.assert_array_equal(rows[of_u], found[of_u])
    assert not rows[of_p].any()


def plane_stress(total, normal):
    """Return a plane strain with ε_zz."""
    return total + normal * ufl.as_tensor(((0, 0, 0), (0, 0, 0), (0, 0, 1)))


def test_plane_stress_follows_the_strain_out_of_the_plane_in_the_mixed_form():
    """With s = 2G dev ε, s_zz + p = 0 gives ε_zz = (ε_xx + ε_yy)/2 - 3p/(4G)."""
    function = values(2)[0]
    u, p = ufl.split(function)
    total = strain(2, u)
    normal = ufl.tr(total) / 2 - 3 * p / (2 * SHEAR)
    stress = SHEAR * kinematics.deviator(plane_stress(total, normal))
    assert fem.assemble_scalar(fem.form((stress[2, 2] + p) ** 2 * measure(2))) < 1e-24
    point = state(2, stress=stress, radial=None, out_of_plane=normal)
    expected = matrix(ufl.derivative(residual(2, point, function), function))
    np.testing.assert_allclose(matrix(tangent(2, point)), expected, atol=1e-12)


def displacements(dimension: int):
    """Return a displacement without any pattern, with its trial and test functions."""
    space = fem.functionspace(cell(dimension), ("Lagrange", 1, (dimension,)))
    function = fem.Function(space)
    random = np.random.default_rng(7)
    function.x.array[:] = random.standard_normal(len(function.x.array))
    return function, ufl.TrialFunction(space), ufl.TestFunction(space)


def in_nodes(dimension: int, function) -> np.ndarray:
    """Return the numbers of the displacements of the corners, shape (corners * dimension,)."""
    points = function.function_space.tabulate_dof_coordinates()[:, :dimension]
    node = [int(np.linalg.norm(points - x, axis=1).argmin()) for x in CORNERS[dimension]]
    return (np.array(node)[:, None] * dimension + np.arange(dimension)).ravel()


@dimensions
def test_the_displacement_form_of_a_cell(dimension):
    """R = V (s + K (tr ε - e^θ) 1):B and its matrix with K tr B ⊗ tr B."""
    dense, dx, point = Dense(CORNERS[dimension]), measure(dimension), state(dimension)
    u, du, v = displacements(dimension)
    index = in_nodes(dimension, u)
    total, change, variation = (strain(dimension, w) for w in (u, du, v))
    mean = (dense.traces @ u.x.array[index] - THERMAL) / COMPRESSIBILITY
    forces = np.einsum("ij,aij->a", STRESS + mean * np.eye(3), dense.strains) * dense.volume
    found = vector(momentum.displacement_internal_virtual_work(total, variation, point, dx))
    np.testing.assert_allclose(found[index], forces, rtol=1e-11)
    bulk = dense.volume / COMPRESSIBILITY * np.outer(dense.traces, dense.traces)
    found = matrix(momentum.displacement_tangent(change, variation, point, dx))
    expected = dense.stiffness(SHEAR, RADIAL) + bulk
    np.testing.assert_allclose(found[np.ix_(index, index)], expected, atol=1e-12)


@dimensions
def test_the_deviatoric_form_and_the_dilatation_of_a_cell(dimension):
    """What Q1/P0 takes at the points, and the change of volume of the whole cell."""
    dense, dx, point = Dense(CORNERS[dimension]), measure(dimension), state(dimension)
    u, du, v = displacements(dimension)
    index = in_nodes(dimension, u)
    total, change, variation = (strain(dimension, w) for w in (u, du, v))
    forces = dense.volume * np.einsum("ij,aij->a", STRESS, dense.strains)
    found = vector(momentum.deviatoric_virtual_work(variation, point, dx))
    np.testing.assert_allclose(found[index], forces, rtol=1e-11)
    found = matrix(momentum.deviatoric_tangent(change, variation, point, dx))
    np.testing.assert_allclose(
        found[np.ix_(index, index)], dense.stiffness(SHEAR, RADIAL), atol=1e-12
    )
    constants = ufl.TestFunction(fem.functionspace(cell(dimension), ("DG", 0)))
    found = vector(momentum.dilatation(total, constants, dx))
    expected = dense.volume * dense.traces @ u.x.array[index]
    np.testing.assert_allclose(found, [expected], rtol=1e-12)


def test_plane_stress_follows_the_strain_out_of_the_plane_in_the_displacement_form():
    """With s = a dev ε, s_zz + K (tr ε - e^θ) = 0 gives ε_zz."""
    u, du, v = displacements(2)
    total, K = strain(2, u), 1 / COMPRESSIBILITY
    plane = ufl.tr(total)
    normal = (K * THERMAL + (SHEAR / 3 - K) * plane) / (2 * SHEAR / 3 + K)
    stress = SHEAR * kinematics.deviator(plane_stress(total, normal))
    point = state(2, stress=stress, radial=None, out_of_plane=normal)
    across = stress[2, 2] + momentum.mean_stress(total, point)
    assert fem.assemble_scalar(fem.form(across**2 * measure(2))) < 1e-24
    work = momentum.displacement_internal_virtual_work(total, strain(2, v), point, measure(2))
    expected = matrix(ufl.derivative(work, u))
    found = matrix(momentum.displacement_tangent(strain(2, du), strain(2, v), point, measure(2)))
    np.testing.assert_allclose(found, expected, atol=1e-12)


@dimensions
def test_uniform_stress_leaves_no_force_inside(dimension):
    """Patch test: the residual of a uniform strain with p = K (tr ε - e^θ) lies on the boundary."""
    create = {2: mesh.create_unit_square, 3: mesh.create_unit_cube}[dimension]
    domain = create(MPI.COMM_SELF, *(3,) * dimension)
    # Move the inner nodes, so that no pattern of the mesh helps.
    x = domain.geometry.x
    inside = ((x[:, :dimension] > 0.01) & (x[:, :dimension] < 0.99)).all(axis=1)
    x[inside, :dimension] += 0.08 * np.sin(37.0 * x[inside, :dimension] + 1.0)
    kind = domain.basix_cell()
    vectors = basix.ufl.element("Lagrange", kind, 1, shape=(dimension,))
    scalars = basix.ufl.element("Lagrange", kind, 1)
    space = fem.functionspace(domain, basix.ufl.mixed_element([vectors, scalars]))
    A = 0.1 * np.arange(1.0, dimension**2 + 1).reshape(dimension, dimension) ** 1.5
    w = fem.Function(space)
    w.sub(0).interpolate(lambda y: A @ y[:dimension])
    mean = (np.trace(A) - THERMAL) / COMPRESSIBILITY
    w.sub(1).interpolate(lambda y: np.full(y.shape[1], mean))
    (u, p), (v, q) = ufl.split(w), ufl.TestFunctions(space)
    position = ufl.SpatialCoordinate(domain)
    total, variation = (kinematics.strain(f, MODEL[dimension], position) for f in (u, v))
    point = state(dimension, stress=hardening_stress(total))
    dx = kinematics.WeightedMeasure(1.0, ufl.dx(domain, metadata={"quadrature_degree": 2}))
    found = vector(
        momentum.mixed_internal_virtual_work(total, p, variation, q, point, dx, dx)
    )
    forces_space, of_u = space.sub(0).collapse()
    of_p = space.sub(1).collapse()[1]
    points = forces_space.tabulate_dof_coordinates()[:, :dimension]
    forces = found[np.array(of_u)].reshape(-1, dimension)
    inner = ((points > 0.01) & (points < 0.99)).all(axis=1)
    assert inner.any() and np.abs(forces).max() > 0.1
    assert np.abs(forces[inner]).max() < 1e-13
    assert np.abs(found[of_p]).max() < 1e-13
    # Forces on the boundary are those of the stress: Σ f ⊗ x = V σ.
    strains = np.zeros((3, 3))
    strains[:dimension, :dimension] = (A + A.T) / 2
    deviator = strains - np.trace(strains) / 3 * np.eye(3)
    stress = SHEAR * deviator + RADIAL * (DIRECTION * strains).sum() * DIRECTION
    stress += mean * np.eye(3)
    np.testing.assert_allclose(forces.T @ points, stress[:dimension, :dimension], atol=1e-12)


def test_the_work_of_a_ring_counts_its_circumference():
    """A displacement (c r, d z) has tr ε = 2c + d in the ring that the triangle sweeps."""
    u, _, v = displacements(2)
    c, d = 0.3, -0.2
    u.interpolate(lambda x: np.stack([c * x[0], d * x[1]]))
    centre = CORNERS[2].mean(axis=0)[0]
    volume = 2 * math.pi * centre * Dense(CORNERS[2]).volume
    dx = measure(2, "axisymmetric")
    constants = ufl.TestFunction(fem.functionspace(cell(2), ("DG", 0)))
    found = vector(momentum.dilatation(strain(2, u, "axisymmetric"), constants, dx))
    np.testing.assert_allclose(found, [(2 * c + d) * volume], rtol=1e-10)
    # The work of the stress on that displacement: s:ε V.
    work = momentum.deviatoric_virtual_work(strain(2, v, "axisymmetric"), state(2), dx)
    expected = (c * STRESS[0, 0] + d * STRESS[1, 1] + c * STRESS[2, 2]) * volume
    assert vector(work) @ u.x.array == pytest.approx(expected, rel=1e-10)


@dimensions
def test_loads_of_a_cell(dimension):
    """A body force acts on all corners alike, tractions and pressures on those of the surface."""
    domain, corners = cell(dimension), CORNERS[dimension]
    u, _, v = displacements(dimension)
    index = in_nodes(dimension, u).reshape(-1, dimension)
    load = np.array([3.0, -2.0, 1.5])[:dimension]
    constant = fem.Constant(domain, load)
    dense = Dense(corners)
    found = vector(momentum.body_force_work(v, constant, measure(dimension)))[index]
    np.testing.assert_allclose(found, np.outer(dense.weights, load), rtol=1e-12)

    ds = kinematics.WeightedMeasure(1.0, ufl.ds(domain))
    # The area vector of the face opposite to a corner is -d V ∇N of that corner.
    vectors = -dimension * dense.volume * dense.gradients
    lengths = np.linalg.norm(vectors, axis=1)
    share = (lengths.sum() - lengths) / dimension
    found = vector(momentum.traction_work(v, constant, ds))[index]
    np.testing.assert_allclose(found, np.outer(share, load), rtol=1e-12)
    found = vector(momentum.pressure_work(v, 4.0, ufl.FacetNormal(domain), ds))[index]
    expected = -4.0 * (vectors.sum(axis=0) - vectors) / dimension
    np.testing.assert_allclose(found, expected, atol=1e-12)
