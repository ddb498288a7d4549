"""ε_zz of plane stress: σ_zz vanishes for every law, strain and first guess."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from castx.errors import ConvergenceError
from castx.materials.flow import FlowProperties
from castx.materials.rules.power_law import PowerLaw
from castx.mechanics.constitutive import plane_stress
from castx.mechanics.constitutive.growth import MetalNodes, Shares
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import Conditions
from castx.mechanics.constitutive.plane_stress import deviatoric, normal_strain, with_normal
from castx.mechanics.constitutive.response import respond

YOUNG, YIELD = 60e9, 60e6
COUNT = 50


def conditions(poisson: float, yield_stress: float, hardening: float, viscous: float) -> Conditions:
    G, K = YOUNG / (2 * (1 + poisson)), YOUNG / (3 * (1 - 2 * poisson))
    none, one = np.zeros(COUNT), np.ones(COUNT)
    flow = FlowProperties(
        G * one, yield_stress * one, hardening * one, (), none, PowerLaw(viscous * one, 0.3 * one)
    )
    return Conditions(
        G * one, flow, Shares.between(one, one, one), None, None, one, one, one,
        np.full(COUNT, 1 / K), none, np.zeros((COUNT, 4)), MetalNodes(one, none, none),
    )  # fmt: skip


def history() -> PointHistory:
    none = np.zeros((COUNT, 4))
    return PointHistory(none, none, none[:, 0], none, none[:, 0] + 1, none)


@settings(max_examples=40)
@given(
    seed=st.integers(0, 10**6),
    poisson=st.floats(0.0, 0.49),
    yield_stress=st.sampled_from([0.0, YIELD, 1e12]),
    hardening=st.sampled_from([0.0, 1e9]),
    viscous=st.sampled_from([0.0, 1e8]),
)
def test_no_stress_across_the_plane(seed, poisson, yield_stress, hardening, viscous):
    """Where ν < 0.2, full Newton steps can yield in tension and in compression in turn."""
    random = np.random.default_rng(seed)
    strain = random.normal(size=(COUNT, 4)) * 10 ** random.uniform(-5, -1.5, (COUNT, 1))
    strain[:, 2] = 0.0
    guess = random.normal(size=COUNT) * 10 ** random.uniform(-5, -1.5, COUNT)
    law = partial(respond, conditions(poisson, yield_stress, hardening, viscous), history())
    stiffness = YOUNG / (3 * (1 - 2 * poisson))

    def mean_stress(normal):
        return stiffness * (strain[:, 0] + strain[:, 1] + normal), np.full(COUNT, stiffness)

    found = normal_strain(strain, guess, law, mean_stress)
    deviator = law(deviatoric(with_normal(strain, found))).stress[:, 2]
    size = stiffness * np.abs(with_normal(strain, found)[:, :3]).max(axis=1)
    assert np.abs(deviator + mean_stress(found)[0]).max() <= 1e-11 * size.max()


def test_the_slope_of_an_elastic_law_is_exact():
    """One step of Newton's method from any guess, and another one that sees that it was right."""
    strain, calls = np.zeros((COUNT, 4)), []
    strain[:, 0] = np.linspace(1e-5, 1e-3, COUNT)
    law = partial(respond, conditions(0.3, 1e12, 0.0, 0.0), history())

    def counted(deviator):
        calls.append(deviator)
        return law(deviator)

    def mean_stress(normal):
        return 50e9 * (strain[:, 0] + normal), np.full(COUNT, 50e9)

    found = normal_strain(strain, np.full(COUNT, 5e-3), counted, mean_stress)
    shear = YOUNG / 2.6
    exact = -(50e9 - 2.0 * shear / 3.0) / (50e9 + 4.0 * shear / 3.0)
    np.testing.assert_allclose(found, exact * strain[:, 0], rtol=1e-10)
    assert len(calls) <= 3


@pytest.mark.parametrize("thermal", [0.0, 1e-3, 0.04])
def test_a_state_in_which_all_strain_has_cancelled_is_found(thermal):
    """As where a held bar is back at its stress-free temperature: what is left is rounding."""
    law = partial(respond, conditions(0.3, 1e12, 0.0, 0.0), history())

    def mean_stress(normal):
        return 50e9 * ((normal + thermal) - thermal), np.full(COUNT, 50e9)

    guess = np.linspace(-1e-3, 1e-3, COUNT)
    found = normal_strain(np.zeros((COUNT, 4)), guess, law, mean_stress)
    np.testing.assert_allclose(found, 0.0, atol=1e-15)


def test_what_is_not_found_is_said(monkeypatch):
    monkeypatch.setattr(plane_stress, "MOST_ITERATIONS", 2)
    law = partial(respond, conditions(0.3, YIELD, 0.0, 0.0), history())
    strain = np.zeros((COUNT, 4))
    strain[:, 0] = 0.01
    with pytest.raises(ConvergenceError, match=r"not found in 2 iterations: σ_zz = -?\d"):
        normal_strain(strain, np.zeros(COUNT), law, lambda e: (50e9 * (0.01 + e), 50e9 + 0 * e))
