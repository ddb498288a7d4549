"""Displacement formulation: Jacobian, patch test and mean stress."""

from __future__ import annotations

import numpy as np
import pytest

from tests.castx.mechanics.lone_bodies import (
    MODELS,
    POISSON,
    YOUNG,
    alone,
    begin,
    begin_anywhere,
    check_derivative,
    inside,
    move,
)
from tests.elastic_bodies import STRESS_FREE, pushed

pytestmark = pytest.mark.sampled

GRADIENT = 1e-3 * np.array([[2.0, 0.7, -0.4], [0.1, -1.2, 0.3], [0.5, -0.2, 0.9]])


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", MODELS)
def test_jacobian_is_the_derivative_of_the_residual(comm, model, cells):
    part = alone(
        comm, model, cells, formulation="displacement", loads=(pushed("far", 1e6),),
        body_force=(1e6, -3e6),
    )  # fmt: skip
    begin_anywhere(part)
    check_derivative(comm, part, 1.0)


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", ["plane-strain", "plane-stress", "3d"])
def test_uniform_strain_has_hookes_stress(comm, model, cells):
    """Hot by 50 K: σ = λ (tr ε - e^θ) 1 + 2 G (ε - e^θ/3 1) + …, in balance inside the body."""
    part = alone(comm, model, cells, formulation="displacement")
    begin(part, STRESS_FREE + 50.0)
    move(part, GRADIENT)
    d = part.dimension
    elastic = np.zeros((3, 3))
    elastic[:d, :d] = (GRADIENT + GRADIENT.T)[:d, :d] / 2
    elastic -= 50.0 * 2e-5 * np.eye(3)
    G = YOUNG / (2 * (1 + POISSON))
    first = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    if model == "plane-stress":
        elastic[2, 2] = -first * (elastic[0, 0] + elastic[1, 1]) / (first + 2 * G)
    stress = first * np.trace(elastic) * np.eye(3) + 2 * G * elastic
    expected = stress[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    found = part.stress()
    np.testing.assert_allclose(found, [expected] * len(found), rtol=1e-9, atol=10.0)
    np.testing.assert_allclose(part.nodal_pressure(), np.trace(stress) / 3, rtol=1e-9)
    forces = part.residual().reshape(-1, part.block_size)[:, :d] * inside(part)[:, None]
    assert np.abs(forces).max(initial=0.0) < 1e-11 * YOUNG * 1e-3 * 0.005 ** (d - 1)


def test_nothing_is_trapped_and_nothing_iterates(comm):
    part = alone(comm, formulation="displacement")
    begin(part, STRESS_FREE)
    assert part.liquid_totals() is None
    assert not part.improve_pressures()
    assert not part.formulation.products() and not part.formulation.coupled_products()
    assert not part.formulation.has_pockets
    assert list(part.stateful_parts()) == ["points"]
