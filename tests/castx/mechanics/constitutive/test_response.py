"""Stress and tangent at points: liquid, mixture, solid, and the secant modulus."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import PLASTIC
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import Conditions, Law
from castx.mechanics.constitutive.response import (
    SMALLEST_SECANT,
    Response,
    foreseen,
    respond,
    secant_softening,
)
from castx.mechanics.constitutive.return_mapping import tensor_norm
from tests.castx.mechanics.constitutive.metals import (
    COHERENCY,
    FLOWING,
    NEWTONIAN,
    NORTON,
    POISSON,
    SHRINKAGE,
    VISCOSITY,
    YOUNG,
    G,
    K,
    after,
    at,
    metal,
    strains,
)
from tests.elastic_bodies import elastic


def test_a_liquid_is_viscous_and_incompressible(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    before, strain = strains(points, 0.1, 1), strains(points, 0.1, 2)
    history = PointHistory.initial(points)._replace(strain=before)
    for step in (0.1, 2.0):
        c = at(points, law, 0.3, step=step)
        found = respond(c, history, strain)
        np.testing.assert_allclose(found.stress, 2 * VISCOSITY / step * (strain - before))
        assert not c.coherent.any()
        assert c.compressibility.max() == c.contraction.max() == found.work.max() == 0.0
        assert c.solid_compressibility == pytest.approx(1 / K)
        assert found.equivalent.max() == np.abs(found.plastic).max() == 0.0


def test_a_norton_liquid_creeps(points):
    """Along the change of strain; q/(3G) + A Δt qⁿ is its equivalent over the step."""
    law = Law(metal(**NORTON), 560.0, PLASTIC)
    before, strain, step = strains(points, 0.1, 1), strains(points, 0.1, 2), 0.5
    c = at(points, law, 0.0, step=step)
    history = PointHistory.initial(points)._replace(strain=before)
    found = respond(c, history, strain)
    q = np.sqrt(1.5) * tensor_norm(found.stress)
    change = strain - before
    equivalent = np.sqrt(2 / 3) * tensor_norm(change)
    np.testing.assert_allclose(q / (3 * G) + step * 1e-20 * q**3, equivalent, rtol=1e-10)
    along = found.stress / tensor_norm(found.stress)[:, None]
    np.testing.assert_allclose(along, change / tensor_norm(change)[:, None], atol=1e-10)
    assert found.equivalent.max() == 0.0


def test_a_strain_of_contraction_alone_leaves_the_solid_free_of_stress(points):
    """Its deviatoric part is taken off the strain; liquid beside the solid resists all of it."""
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    shape = strains(points, 2e-3, 1)
    history = PointHistory.initial(points)
    solid = at(points, law, 1.0)._replace(shape=shape)
    found = respond(solid, history, shape)
    assert np.abs(found.stress).max() < 1e-9 * G and found.equivalent.max() == 0.0
    assert np.abs(respond(solid, history, 0.0 * shape).stress).max() > 1e-4 * G
    half = at(points, law, (1.0 + COHERENCY) / 2, step=2.0)._replace(shape=shape)
    liquid = (1.0 - half.shares.end)[:, None] * VISCOSITY * shape
    np.testing.assert_allclose(respond(half, history, shape).stress, liquid, atol=1e-9 * G)


def mixed(points, law: Law, solid_fraction: float) -> tuple[Conditions, Response]:
    """Return what a freezing cell does that has been half solid, and strained, before."""
    half = (1.0 + COHERENCY) / 2
    past = at(points, law, half)
    history = after(points, past, PointHistory.initial(points), strains(points, 2e-3, 1))
    c = at(points, law, solid_fraction, start=half)
    return c, respond(c, history, strains(points, 2e-3, 2))


@pytest.mark.parametrize("name", ["thermo-elastic", PLASTIC])
@pytest.mark.parametrize("liquid", [NEWTONIAN, NORTON], ids=["newtonian", "norton"])
def test_the_mixture_is_continuous_from_liquid_to_solid(points, liquid, name):
    law = Law(metal(**liquid), 560.0, name)
    fractions = np.linspace(COHERENCY, 1.0, 41)
    states = [mixed(points, law, fraction) for fraction in fractions]
    for quantity in (
        lambda c, r: r.stress, lambda c, r: r.isotropic, lambda c, r: c.compressibility,
        lambda c, r: r.work,
    ):  # fmt: skip
        values = np.array([quantity(c, r) for c, r in states])
        assert np.abs(np.diff(values, axis=0)).max() <= 0.06 * np.abs(values).max()
    solid, nearly = mixed(points, law, 1.0), mixed(points, law, 1.0 - 1e-9)
    np.testing.assert_allclose(nearly[1].stress, solid[1].stress, rtol=1e-6, atol=1.0)
    assert solid[0].compressibility == pytest.approx(0.75 / K)
    assert solid[0].contraction == pytest.approx(-SHRINKAGE * (1 - COHERENCY) / 2)
    first, last_liquid = mixed(points, law, COHERENCY + 1e-9), mixed(points, law, COHERENCY)
    assert first[0].coherent.all() and not last_liquid[0].coherent.any()
    assert first[0].compressibility.max() < 1e-8 / K
    np.testing.assert_allclose(first[1].stress, last_liquid[1].stress, rtol=1e-6, atol=1.0)
    half = mixed(points, law, (1 + COHERENCY) / 2)[0]
    assert half.compressibility == pytest.approx(0.5 / K)
    assert half.contraction.max() == 0.0


def test_the_mixture_shares_its_stress(points):
    """Share w of the solid, of which what was there has yielded, and the rest of the liquid."""
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    w, start = 0.75, 0.5
    strain = strains(points, 2e-3, 1)
    c = at(points, law, COHERENCY + w * (1 - COHERENCY), start=COHERENCY + start * (1 - COHERENCY))
    history = PointHistory.initial(points)
    found = respond(c, history, strain)
    # The same solid alone, strained by w_m/w of it.
    alone = respond(at(points, law, 1.0), history, 0.5 * (w + start) / w * strain)
    liquid = 2 * VISCOSITY / 0.5 * strain
    np.testing.assert_allclose(found.stress, w * alone.stress + (1 - w) * liquid, rtol=1e-9)
    np.testing.assert_allclose(found.work, w * alone.work, rtol=1e-9)
    np.testing.assert_allclose(found.equivalent, alone.equivalent, rtol=1e-9)
    assert alone.equivalent.min() > 0


@pytest.mark.parametrize("name", ["thermo-elastic", PLASTIC])
@pytest.mark.parametrize("start", [0.0, 0.3, 1.0])
def test_the_tangent_is_the_derivative_of_the_stress(points, name, start):
    """While solid grows and melts; one phase flows at a time, so that it is exact."""
    law = Law(metal(**NEWTONIAN), 560.0, name)
    before = COHERENCY + start * (1 - COHERENCY)
    c = at(points, law, COHERENCY + 0.7 * (1 - COHERENCY), start=before)
    history = after(points, at(points, law, before), PointHistory.initial(points),
                    strains(points, 1e-3, 1))  # fmt: skip
    strain, change = strains(points, 2e-3, 2), strains(points, 1e-9, 3)
    found = respond(c, history, strain)
    weights = np.array([1.0, 1.0, 1.0, 2.0])
    along = (found.direction * change) @ weights
    predicted = found.isotropic[:, None] * change
    predicted += (found.radial * along)[:, None] * found.direction
    forward, back = (respond(c, history, strain + sign * change).stress for sign in (1, -1))
    np.testing.assert_allclose((forward - back) / 2, predicted, rtol=1e-4, atol=1e-4)


def test_what_has_not_moved_is_foreseen_to_contract(points):
    """Without the stress that its contraction would have if the solid did not follow."""
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    before, half = strains(points, 1e-3, 1), 0.5 * (1 + COHERENCY)
    history = after(points, at(points, law, half), PointHistory.initial(points), before)
    shape = strains(points, 5e-3, 4)
    shape[0] = 0.0
    c = at(points, law, 0.9, start=half)._replace(shape=shape)
    strain = before.copy()
    strain[1] += 1e-9
    found, plain = foreseen(c, history, strain), respond(c, history, strain)
    for name in ("elastic", "plastic", "equivalent", "work"):
        np.testing.assert_array_equal(getattr(found, name), getattr(plain, name))
    for name in ("stress", "isotropic", "radial", "direction"):
        np.testing.assert_array_equal(getattr(found, name)[:2], getattr(plain, name)[:2])
    there, rate = (respond(c, history, before + part * shape) for part in (1.0, 1.0 + 1e-7))
    linear = there.stress - (rate.stress - there.stress) / 1e-7
    np.testing.assert_allclose(found.stress[2:], linear[2:], rtol=1e-4, atol=1.0)
    assert np.abs(found.stress - plain.stress)[2:].max(axis=1).min() > 1e5
    assert there.equivalent.max() < plain.equivalent[2:].min()
    never = c._replace(flow=None)
    np.testing.assert_array_equal(
        foreseen(never, history, strain).stress, respond(never, history, strain).stress
    )


def test_softening_is_the_secant_modulus(points):
    law = Law(metal(), 560.0, PLASTIC)
    c, start = at(points, law, 1.0), PointHistory.initial(points)
    for size in (1e-5, 1e-3, 1e-2, 1e4):
        strain = strains(points, size)
        found = respond(c, start, strain)
        secant = tensor_norm(found.stress) / (2 * tensor_norm(strain))
        expected = np.maximum(secant / G, SMALLEST_SECANT)
        softening = secant_softening(found, c, start, strain)
        np.testing.assert_allclose(softening, expected, rtol=1e-12)
        assert softening.max() <= 1.0
        assert size > 1e-5 or softening.min() == pytest.approx(1.0, abs=1e-12)
    # At least a thousandth: the pressure of what has no stiffness left would not be smoothed.
    weak = found._replace(elastic=1e-9 * found.elastic)
    np.testing.assert_allclose(secant_softening(weak, c, start, strain), 1e-3, rtol=1e-12)
    # Flow against the present stress makes nothing stiffer than elastic.
    turned = found._replace(plastic=-0.5 * found.elastic)
    np.testing.assert_array_equal(secant_softening(turned, c, start, strain), 1.0)
    # Far below one pascal, too.
    tiny = strains(points, 1e-13)
    half = respond(c, start, tiny)
    half = half._replace(elastic=0.5 * half.elastic, plastic=0.5 * half.elastic)
    np.testing.assert_allclose(secant_softening(half, c, start, tiny), 0.5, rtol=1e-12)
    still = np.zeros((points.count, 4))
    assert np.all(secant_softening(respond(c, start, still), c, start, still) == 1.0)


@pytest.mark.parametrize(
    "key, value",
    [("young_modulus", 50e9), ("poisson_ratio", 0.35), ("yield_stress", 10e6),
     ("hardening", 2e9), ("kinematic_hardening", 1e9)],
)  # fmt: skip
def test_every_constant_of_the_solid_acts(points, key, value):
    given = {"young_modulus": YOUNG, "poisson_ratio": POISSON, **FLOWING}
    strain, start = strains(points, 0.01), PointHistory.initial(points)
    found = []
    for constants in (given, {**given, key: value}):
        rest = dict(constants)
        law = Law(elastic(rest.pop("young_modulus"), rest.pop("poisson_ratio"), **rest), 20.0,
                  PLASTIC)  # fmt: skip
        c = at(points, law, 1.0)
        half = after(points, c, start, strain / 2)
        found.append(respond(c, half, strain[::-1]).stress)
    assert np.abs(found[1] - found[0]).max() > 1e-3 * np.abs(found[0]).max()
