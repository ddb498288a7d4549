"""Coefficients of the law of a body in a step, from temperatures and solid fractions at nodes."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.description import MaterialDescription
from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.materials.material import Material
from castx.mechanics.constitutive.law import ELASTIC, Law
from tests.castx.mechanics.constitutive.metals import (
    NEWTONIAN,
    NORTON,
    POISSON,
    VISCOSITY,
    K,
    at,
    metal,
)
from tests.elastic_bodies import elastic


def test_coherency_of_one_makes_a_step_of_the_mixture(points):
    law = Law(metal(viscosity=VISCOSITY, coherency=1.0), 560.0, PLASTIC)
    for fraction, share in ((1.0 - 1e-9, 0.0), (1.0, 1.0)):
        c = at(points, law, fraction)
        assert np.all(c.shares.end == share) and np.all(c.coherent == (share == 1.0))


def test_elastic_coefficients_over_temperature(points):
    """E falls linearly: at a linear temperature the points have E of their own places."""
    nodes = points.cell_nodes.max() + 1
    temperature = 100.0 + 200.0 * np.random.default_rng(2).random(nodes)
    young = [[0.0, 70e9], [400.0, 30e9]]
    law = Law(elastic(young, POISSON, 2e-5), 20.0)
    c = law.conditions(points, temperature, np.ones(nodes), 0.5)
    E = 70e9 - 1e8 * temperature
    np.testing.assert_allclose(c.shear_modulus, points.from_nodes(E / (2 * (1 + POISSON))))
    corners = points.cell_nodes
    np.testing.assert_allclose(
        c.compressibility, np.mean(3 * (1 - 2 * POISSON) / E[corners], axis=1), rtol=1e-12
    )
    strain = 3 * 2e-5 * (temperature - 20.0)
    assert not c.contraction.any()
    cold = law.initial_nodes(nodes, liquid=False)
    c = law.conditions(points, temperature, np.ones(nodes), 0.5, cold)
    np.testing.assert_allclose(c.contraction, np.mean(strain[corners], axis=1), rtol=1e-12)
    assert c.flow is None and c.liquid_modulus is None and c.coherent.all()
    assert law.largest_shear_modulus() == pytest.approx(70e9 / (2 * (1 + POISSON)))


def test_a_liquid_has_its_viscosity_over_the_step_and_no_volume_strain(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    for step in (0.1, 2.0):
        c = at(points, law, 0.3, step=step)
        np.testing.assert_allclose(c.liquid_modulus, VISCOSITY / step)
        assert c.contraction.max() == c.compressibility.max() == c.shares.end.max() == 0.0
        np.testing.assert_allclose(c.solid_compressibility, 1 / K)
    nodes = points.cell_nodes.max() + 1
    start = law.initial_nodes(nodes, liquid=True)
    cold = law.conditions(points, np.full(nodes, 300.0), np.full(nodes, 0.3), 1.0, start)
    assert np.all(cold.contraction == 0.0) and not cold.coherent.any()


def test_pressure_of_a_step_meets_the_solid_that_is_there_meanwhile(points):
    """θ = w_m p/K + E in the step, and θ = w p/K + E of what is left behind it."""
    law = Law(metal(viscosity=VISCOSITY, coherency=0.6), 560.0, PLASTIC)
    pressure = np.full(points.cells, -3e7)
    for start, end, mean in ((0.6, 0.8, 0.25), (0.7, 0.9, 0.5), (0.9, 0.7, 0.25), (1.0, 1.0, 1.0)):
        c = at(points, law, end, start=start)
        np.testing.assert_allclose(c.compressibility, mean / K, rtol=1e-9)
        behind = c.share / K * pressure + c.born_later(pressure)
        np.testing.assert_allclose(behind, mean / K * pressure, rtol=1e-9)


def test_the_share_of_the_solid_rises_from_coherency_to_full_solidity(points):
    law = Law(metal(viscosity=VISCOSITY, coherency=0.6), 560.0, PLASTIC)
    for fraction, share in ((0.5, 0.0), (0.6, 0.0), (0.7, 0.25), (0.9, 0.75), (1.0, 1.0)):
        np.testing.assert_allclose(at(points, law, fraction).shares.end, share, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "liquid", "linear"),
    [(ELASTIC, {}, True), (ELASTIC, NEWTONIAN, True), (ELASTIC, NORTON, False),
     (PLASTIC, NEWTONIAN, False), (VISCOPLASTIC, {}, False)],
)  # fmt: skip
@pytest.mark.serial
def test_what_is_linear_in_the_strain(name, liquid, linear):
    assert Law(metal(**liquid), 560.0, name).is_linear == linear


@pytest.mark.serial
def test_elastic_properties_are_needed():
    bare = Material("bare", MaterialDescription.read({"density": 1.0}))
    with pytest.raises(CaseError, match="material 'bare' needs young_modulus and poisson_ratio"):
        Law(bare, 20.0).largest_shear_modulus()


@pytest.mark.serial
def test_fronts_are_plateaus_on_which_the_skeleton_bears_and_shrinks():
    """f_s from 0.8 to 1 at 560 °C; s = 5 %, of which coherency leaves s (f_s − f_c)."""

    def fronts(coherency: float, shrinkage: float = 0.05, *, begin: float = 0.8):
        given = {
            "solid_fraction": [[560.0, 1.0], [560.0, begin], [600.0, 0.0]],
            "solidification_shrinkage": shrinkage, "latent_heat": 4e5,
            "liquid": {"viscosity": 1e5, "coherency": coherency},
        }  # fmt: skip
        return Law(Material("alloy", MaterialDescription.model_validate(given)), 560.0).fronts()

    (front,) = fronts(0.6)
    assert front.begin == pytest.approx(0.5) and front.end == 1.0
    assert front.contraction == pytest.approx(-0.05 * 0.2 / 0.5)
    assert not fronts(0.8) and not fronts(0.9) and not fronts(0.6, 0.0)
    assert not fronts(0.6, begin=1.0)
