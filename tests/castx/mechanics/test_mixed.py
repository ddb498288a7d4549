"""Mixed u/p formulation: Jacobian, patch test, liquid at rest under its weight, trapped liquid."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from tests.castx.mechanics.lone_bodies import (
    LENGTH,
    MELTING,
    MODELS,
    POISSON,
    SHUT,
    YOUNG,
    alone,
    begin,
    begin_anywhere,
    check_derivative,
    inside,
    molten_ends,
    move,
    random_field,
)
from tests.elastic_bodies import STRESS_FREE, pulled, pushed

pytestmark = pytest.mark.sampled

BULK, SHEAR = YOUNG / (3 * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
GRADIENT = 1e-3 * np.array([[2.0, 0.7, -0.4], [0.1, -1.2, 0.3], [0.5, -0.2, 0.9]])
stabilised = pytest.mark.parametrize("stabilisation", ["osgs", "gls"])


@stabilised
@pytest.mark.parametrize("model", MODELS)
def test_jacobian_is_the_derivative_of_the_residual(comm, model, stabilisation):
    loads = (pushed("far", 1e6), pulled("wall", *(2e6,) * (3 if model == "3d" else 2)))
    part = alone(comm, model, loads=loads, body_force=(1e6, -3e6), stabilisation=stabilisation)
    begin_anywhere(part)
    check_derivative(comm, part, 1.0)


@stabilised
@pytest.mark.parametrize("fraction", [0.2, 0.9, 1.0], ids=["liquid", "mixture", "solid"])
def test_jacobian_of_a_body_that_melts(comm, stabilisation, fraction):
    part = alone(comm, properties=MELTING, stabilisation=stabilisation)
    begin_anywhere(part, fraction)
    check_derivative(comm, part, 1.0)


@pytest.mark.ranks
@stabilised
@pytest.mark.parametrize("ends", [False, True], ids=["all", "ends"])
@pytest.mark.parametrize("model", ["plane-strain", "generalised-plane-strain", "axisymmetric"])
def test_jacobian_of_trapped_liquid(comm, model, ends, stabilisation):
    """Full, in one pocket or in two with a shell between them."""
    part = alone(
        comm, model, properties=MELTING, closed=SHUT, starts_liquid=True,
        stabilisation=stabilisation,
    )  # fmt: skip
    begin_anywhere(part, molten_ends(part) if ends else 0.2)
    assert part.formulation.has_pockets and not part.is_linear
    check_derivative(comm, part, 1.0)


@pytest.mark.ranks
@stabilised
def test_jacobian_of_porous_liquid(comm, stabilisation):
    """Its pressure stays, whatever its volume is."""
    part = alone(
        comm, properties=MELTING, closed=SHUT, starts_liquid=True, stabilisation=stabilisation
    )
    begin_anywhere(part, molten_ends(part))
    move(part, GRADIENT)
    part.residual()  # pores open
    (add_product,) = part.formulation.coupled_products()
    nothing = np.zeros(part.unknowns.owned)
    add_product(random_field(part, 1.9)[: len(nothing)], nothing)
    assert part.formulation.has_pockets and not nothing.any()
    check_derivative(comm, part, 1.0)


@pytest.mark.ranks
def test_products_are_those_of_their_matrix(comm):
    """Of the solid and of the liquid, each with its projection; GLS has none."""
    assert (
        alone(comm, properties=MELTING, stabilisation="gls").formulation.matrix_of_products()
        is None
    )
    part = alone(comm, properties=MELTING)
    begin_anywhere(part, molten_ends(part))
    products, matrix = part.formulation.products(), part.formulation.matrix_of_products()
    assert len(products) == 2
    x, y = matrix.createVecs()
    x.array[:] = random_field(part, 1.7)[: part.unknowns.owned]
    matrix.mult(x, y)
    expected = np.zeros(part.unknowns.owned)
    for add_product in products:
        before = expected.copy()
        add_product(x.array_r.copy(), expected)
        assert comm.allreduce(np.abs(expected - before).max(initial=0.0), op=MPI.MAX) > 0
    scale = comm.allreduce(np.abs(expected).max(initial=0.0), op=MPI.MAX)
    np.testing.assert_allclose(y.array_r, expected, atol=1e-12 * scale, rtol=0)
    for item in (matrix, x, y):
        item.destroy()


def test_cells_of_trapped_liquid_have_the_pressure_of_their_pocket(comm):
    """All others have the mean of their nodal pressures."""
    part = alone(comm, properties={**MELTING, "cavitation": 3e5}, closed=SHUT, starts_liquid=True)
    begin(part, 640.0, molten_ends(part))
    move(part, GRADIENT, 7e5)
    part.residual()
    found, liquid = part.formulation.mean_stress(), ~part.coherent
    assert comm.allreduce(int(liquid.sum())) and comm.allreduce(int((~liquid).sum()))
    np.testing.assert_allclose(found, np.where(liquid, 3e5, 7e5), rtol=1e-12)


@stabilised
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_patch_of_uniform_strain_is_in_balance(comm, model, stabilisation):
    """With p = K tr ε no row of an inner node has a residual, nor any continuity equation."""
    part = alone(comm, model, stabilisation=stabilisation)
    begin(part, STRESS_FREE)
    d = part.dimension
    strain = np.zeros((3, 3))
    strain[:d, :d] = (GRADIENT + GRADIENT.T)[:d, :d] / 2
    mean = BULK * np.trace(strain)
    move(part, GRADIENT, mean)
    residual = part.residual().reshape(-1, part.block_size)
    force = YOUNG * 1e-3 * 0.005 ** (d - 1)
    forces, free = residual[:, :d], inside(part)
    assert comm.allreduce(free.sum()) > 0
    assert np.abs(forces * free[:, None]).max(initial=0.0) < 1e-12 * force
    assert np.abs(residual[:, d]).max(initial=0.0) < 1e-12 * force
    assert comm.allreduce(np.abs(forces).max(initial=0.0), op=MPI.MAX) > 1e-2 * force
    deviator = 2 * SHEAR * (strain - np.trace(strain) / 3 * np.eye(3))
    expected = (deviator + mean * np.eye(3))[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(part.stress(), [expected] * len(part.stress()), rtol=1e-9, atol=1.0)
    np.testing.assert_allclose(part.nodal_pressure(), mean, rtol=1e-12)


@stabilised
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_a_liquid_at_rest_carries_its_weight_by_its_pressure(comm, model, stabilisation):
    """∇p = -b needs no motion: 1/K = 0, and neither GLS nor OSGS may see a residual."""
    weight = (0.0, -26.5e3, 0.0)
    part = alone(
        comm, model, properties=MELTING, starts_liquid=True, body_force=weight,
        stabilisation=stabilisation,
    )  # fmt: skip
    begin(part, 640.0, 0.0)
    heights = part.mesh.nodes.tabulate_dof_coordinates()[:, 1]
    pressure = part.unknowns.pressure_component
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, pressure] = 26.5e3 * heights / part.unknowns.pressure_scale
    residual = part.residual().reshape(-1, part.block_size)
    force = 26.5e3 * LENGTH * 0.005 ** (part.dimension - 1)
    assert np.abs(residual[:, :2] * inside(part)[:, None]).max(initial=0.0) < 1e-10 * force
    assert np.abs(residual[:, pressure]).max(initial=0.0) < 1e-10 * force
    np.testing.assert_allclose(part.nodal_pressure(), 26.5e3 * heights, rtol=1e-12, atol=1e-9)


def test_cells_have_the_mean_of_their_nodal_pressures(comm):
    part = alone(comm)
    begin(part, STRESS_FREE)
    points = part.mesh.points
    values = part.solution.x.array.reshape(-1, part.block_size)
    pressure = 1e6 * (1 + points[:, 0] / LENGTH - 3 * points[:, 1] / LENGTH)
    values[:, 2] = pressure / part.unknowns.pressure_scale
    expected = pressure[part.cell_nodes].mean(axis=1)
    np.testing.assert_allclose(part.stress()[:, :3].mean(axis=1), expected, rtol=1e-12)
    np.testing.assert_allclose(part.formulation.mean_stress(), expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("start", "end", "solid"),
    [(0.0, 0.0, False), (0.0, 0.75, True), (0.7, 1.0, True), (0.85, 0.9, True),
     (1.0, 0.75, True), (1.0, 0.7, False)],
)  # fmt: skip
def test_the_stabilisation_takes_the_modulus_of_the_phase(comm, start, end, solid):
    """That of a liquid is η/Δt, three orders below G, as long as nothing bears."""
    part = alone(comm, properties=MELTING)
    begin(part, 600.0, start)
    part.commit()
    begin(part, 600.0, end)
    modulus = YOUNG / (2 * (1 + POISSON)) if solid else 2e6
    np.testing.assert_allclose(part.material.secant_modulus.x.array, modulus, rtol=1e-12)


def test_the_stabilisation_takes_the_secant_modulus_of_the_last_step(comm):
    """Where plastic flow has softened the solid to a quarter, τ is four times as large."""
    part = alone(comm)
    history = part.material.history
    part.material.history = history._replace(softening=0.25 * np.ones_like(history.softening))
    begin(part, 20.0)
    np.testing.assert_allclose(part.material.secant_modulus.x.array, 0.25 * SHEAR, rtol=1e-12)
