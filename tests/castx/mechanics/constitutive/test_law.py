"""The law of a body at its points: liquid, mixture and solid, birth, what history forgets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.materials.material import Material
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import (
    SMALLEST_SECANT,
    Conditions,
    History,
    Law,
    Response,
    respond,
    secant_softening,
)
from castx.mechanics.constitutive.return_mapping import tensor_norm
from tests.elastic_bodies import elastic, generated

YOUNG, POISSON = 60e9, 0.3
G, K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
YIELD, VISCOSITY, COHERENCY = 20e6, 2e6, 0.6
SHRINKAGE = 0.05
FLOWING = {"yield_stress": YIELD, "hardening": 1e9, "kinematic_hardening": 2e9}


def metal(**liquid: Any) -> Material:
    """Return an aluminium-like material, with a liquid where one is given."""
    melting: dict[str, Any] = {}
    if liquid:
        melting = {"solidus": 560.0, "liquidus": 610.0, "latent_heat": 4e5, "liquid": liquid}
    return elastic(YOUNG, POISSON, 2e-5, solidification_shrinkage=SHRINKAGE * bool(liquid),
                   **FLOWING, **melting)  # fmt: skip


NEWTONIAN = {"viscosity": VISCOSITY, "coherency": COHERENCY}
NORTON = {"model": "norton", "coefficient": 1e-20, "exponent": 3.0, "coherency": COHERENCY}


@pytest.fixture
def points(comm) -> IntegrationPoints:
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.02, width=0.01, size=0.005)
    return IntegrationPoints(mesh.bodies["casting"], "plane-strain", 1)


def at(
    points: IntegrationPoints, law: Law, solid_fraction: float, temperature=560.0, step=0.5
) -> Conditions:
    nodes = points.cell_nodes.max() + 1
    return law.conditions(
        points, np.full(nodes, temperature), np.full(nodes, solid_fraction), step
    )


def strains(points: IntegrationPoints, size: float, seed: int = 0) -> FloatArray:
    random = np.random.default_rng(seed).normal(size=(points.count, 4))
    random[:, :3] -= random[:, :3].mean(axis=1, keepdims=True)
    return size * random


def after(points, conditions: Conditions, start: History, strain: FloatArray) -> History:
    """Return the history that a step leaves."""
    found = respond(conditions, start, strain)
    softening = secant_softening(found, conditions, start, strain)
    return History(
        start.birth, found.plastic, found.equivalent, strain, softening, conditions.coherent
    )


def test_a_liquid_is_viscous_and_incompressible(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    before, strain = strains(points, 0.1, 1), strains(points, 0.1, 2)
    history = History.initial(points, liquid=True)._replace(strain=before)
    for step in (0.1, 2.0):
        c = at(points, law, 0.3, step=step)
        found = respond(c, history.start(c.coherent, points), strain)
        np.testing.assert_allclose(found.stress, 2 * VISCOSITY / step * (strain - before))
        assert not c.coherent.any()
        assert c.compressibility.max() == c.thermal_strain.max() == found.work.max() == 0.0
        assert c.solid_compressibility == pytest.approx(1 / K)
        assert found.equivalent.max() == np.abs(found.plastic).max() == 0.0


def test_a_norton_liquid_creeps(points):
    """Along the change of strain; q/(3G) + A Δt qⁿ is its equivalent over the step."""
    law = Law(metal(**NORTON), 560.0, PLASTIC)
    before, strain, step = strains(points, 0.1, 1), strains(points, 0.1, 2), 0.5
    c = at(points, law, 0.0, step=step)
    history = History.initial(points, liquid=True)._replace(strain=before)
    found = respond(c, history.start(c.coherent, points), strain)
    q = np.sqrt(1.5) * tensor_norm(found.stress)
    change = strain - before
    equivalent = np.sqrt(2 / 3) * tensor_norm(change)
    np.testing.assert_allclose(q / (3 * G) + step * 1e-20 * q**3, equivalent, rtol=1e-10)
    along = found.stress / tensor_norm(found.stress)[:, None]
    np.testing.assert_allclose(along, change / tensor_norm(change)[:, None], atol=1e-10)
    assert found.equivalent.max() == 0.0


def mixed(points, law: Law, solid_fraction: float) -> tuple[Conditions, Response]:
    """Return what a freezing cell does that has been a solid, and has been strained, before."""
    past = at(points, law, 0.95)
    history = History.initial(points, liquid=False).start(past.coherent, points)
    history = after(points, past, history, strains(points, 2e-3, 1))
    c = at(points, law, solid_fraction)
    return c, respond(c, history.start(c.coherent, points), strains(points, 2e-3, 2))


@pytest.mark.parametrize("name", ["thermo-elastic", PLASTIC])
@pytest.mark.parametrize("liquid", [NEWTONIAN, NORTON], ids=["newtonian", "norton"])
def test_the_mixture_is_continuous_from_liquid_to_solid(points, liquid, name):
    law = Law(metal(**liquid), 560.0, name)
    fractions = np.linspace(COHERENCY, 1.0, 41)
    states = [mixed(points, law, fraction) for fraction in fractions]
    for quantity in (
        lambda c, r: r.stress, lambda c, r: r.isotropic, lambda c, r: c.compressibility,
        lambda c, r: c.thermal_strain, lambda c, r: r.work,
    ):  # fmt: skip
        values = np.array([quantity(c, r) for c, r in states])
        assert np.abs(np.diff(values, axis=0)).max() <= 0.05 * np.abs(values).max()
    solid, nearly = mixed(points, law, 1.0), mixed(points, law, 1.0 - 1e-9)
    np.testing.assert_allclose(nearly[1].stress, solid[1].stress, rtol=1e-6, atol=1.0)
    assert solid[0].compressibility == pytest.approx(1 / K)
    assert solid[0].thermal_strain == pytest.approx(-SHRINKAGE)
    first, last_liquid = mixed(points, law, COHERENCY), mixed(points, law, COHERENCY - 1e-9)
    assert first[0].coherent.all() and not last_liquid[0].coherent.any()
    assert first[0].compressibility.max() == first[0].thermal_strain.max() == 0.0
    np.testing.assert_allclose(first[1].stress, last_liquid[1].stress, rtol=1e-12)
    half = mixed(points, law, (1 + COHERENCY) / 2)[0]
    assert half.compressibility == pytest.approx(0.5 / K)
    assert half.thermal_strain == pytest.approx(-0.5 * SHRINKAGE)


def test_the_mixture_shares_its_stress(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    (_, solid), (_, liquid), (_, mixture) = (
        mixed(points, law, fraction) for fraction in (1.0, COHERENCY, 0.9)
    )
    w = 0.3 / 0.4
    expected = w * solid.stress + (1 - w) * liquid.stress
    np.testing.assert_allclose(mixture.stress, expected, rtol=1e-10, atol=1e-3)
    np.testing.assert_allclose(mixture.work, w * solid.work, rtol=1e-12)
    np.testing.assert_array_equal(mixture.equivalent, solid.equivalent)
    assert solid.equivalent.min() > 0


def test_coherency_of_one_makes_a_step_of_the_mixture(points):
    law = Law(metal(viscosity=VISCOSITY, coherency=1.0), 560.0, PLASTIC)
    for fraction, share in ((1.0 - 1e-9, 0.0), (1.0, 1.0)):
        c = at(points, law, fraction)
        assert np.all(c.solid_share == share) and np.all(c.coherent == (share == 1.0))


@pytest.mark.parametrize("name", [PLASTIC, VISCOPLASTIC])
def test_a_solid_is_born_without_a_past(points, name):
    material = elastic(YOUNG, POISSON, 0.0, solidus=560.0, liquidus=610.0, latent_heat=4e5,
                       liquid=NEWTONIAN, viscosity=1e7, **FLOWING)  # fmt: skip
    law = Law(material, 560.0, name)
    liquid, solid = at(points, law, 0.2), at(points, law, 1.0)
    history = History.initial(points, liquid=True).start(liquid.coherent, points)
    flowed = strains(points, 0.3, 1)
    history = after(points, liquid, history, flowed)
    born = history.start(solid.coherent, points)
    np.testing.assert_array_equal(born.birth, flowed)
    assert np.abs(respond(solid, born, flowed).stress).max() == 0.0
    change = strains(points, 1e-5, 2)
    np.testing.assert_allclose(
        respond(solid, born, flowed + change).stress, 2 * G * change, rtol=1e-8, atol=1.0
    )
    assert np.all(born.softening == 1.0)


def test_remelting_wipes_the_flow_of_the_solid(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    solid, liquid = at(points, law, 1.0), at(points, law, 0.0)
    history = History.initial(points, liquid=False).start(solid.coherent, points)
    history = after(points, solid, history, strains(points, 0.01, 1))
    assert history.equivalent.min() > 0 and np.abs(history.plastic).max() > 0
    same = history.start(solid.coherent, points)
    np.testing.assert_array_equal(same.plastic, history.plastic)
    melting = history.start(liquid.coherent, points)
    assert melting.equivalent.max() == np.abs(melting.plastic).max() == 0.0
    history = after(points, liquid, melting, strains(points, 0.02, 2))
    frozen = history.start(solid.coherent, points)
    np.testing.assert_array_equal(frozen.birth, strains(points, 0.02, 2))
    assert frozen.equivalent.max() == np.abs(frozen.plastic).max() == 0.0


def test_only_cells_that_change_forget(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    solid = at(points, law, 1.0)
    history = History.initial(points, liquid=False).start(solid.coherent, points)
    history = after(points, solid, history, strains(points, 0.01, 1))
    melts = np.arange(points.cells) % 3 == 0
    begun = history.start(~melts, points)
    np.testing.assert_array_equal(begun.plastic[~melts], history.plastic[~melts])
    np.testing.assert_array_equal(begun.birth[~melts], history.birth[~melts])
    assert np.abs(begun.plastic[melts]).max() == 0.0
    np.testing.assert_array_equal(begun.birth[melts], history.strain[melts])


def test_softening_is_the_secant_modulus(points):
    law = Law(metal(), 560.0, PLASTIC)
    c, start = at(points, law, 1.0), History.initial(points, liquid=False)
    for size in (1e-5, 1e-3, 1e-2, 1e4):
        strain = strains(points, size)
        found = respond(c, start, strain)
        secant = tensor_norm(found.stress) / (2 * tensor_norm(strain))
        expected = np.maximum(secant / G, SMALLEST_SECANT)
        softening = secant_softening(found, c, start, strain)
        np.testing.assert_allclose(softening, expected, rtol=1e-12)
        assert softening.max() <= 1.0
        assert size > 1e-5 or softening.min() == pytest.approx(1.0, abs=1e-12)
    still = np.zeros((points.count, 4))
    assert np.all(secant_softening(respond(c, start, still), c, start, still) == 1.0)


@pytest.mark.parametrize(
    "key, value",
    [("young_modulus", 50e9), ("poisson_ratio", 0.35), ("yield_stress", 10e6),
     ("hardening", 2e9), ("kinematic_hardening", 1e9)],
)  # fmt: skip
def test_every_constant_of_the_solid_acts(points, key, value):
    given = {"young_modulus": YOUNG, "poisson_ratio": POISSON, **FLOWING}
    strain, start = strains(points, 0.01), History.initial(points, liquid=False)
    found = []
    for constants in (given, {**given, key: value}):
        rest = dict(constants)
        law = Law(elastic(rest.pop("young_modulus"), rest.pop("poisson_ratio"), **rest), 20.0,
                  PLASTIC)  # fmt: skip
        c = at(points, law, 1.0)
        half = after(points, c, start, strain / 2)
        found.append(respond(c, half, strain[::-1]).stress)
    assert np.abs(found[1] - found[0]).max() > 1e-3 * np.abs(found[0]).max()
