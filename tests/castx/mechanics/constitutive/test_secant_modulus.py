"""Shear modulus of the stabilisation: of the solid where there is any, for the rest of a step."""

from types import SimpleNamespace

import numpy as np

from castx.mechanics.constitutive.secant_modulus import SecantModulus

SOLID, LIQUID = 2e10, 3e5


def conditions(points, share, liquid=LIQUID, both=()):
    one = np.ones(points.count)
    return SimpleNamespace(
        shear_modulus=SOLID * one,
        liquid_modulus=None if liquid is None else liquid * one,
        shares=SimpleNamespace(end=share * one),
        mush=SimpleNamespace(layers=SimpleNamespace(points=np.array(both, dtype=int))),
    )


def test_a_point_that_has_held_solid_in_a_step_keeps_its_modulus(points, cells):
    modulus = SecantModulus(points, cells)
    softening = np.full(points.count, 0.5)
    found, bearing = [], []
    for share in (0.0, 1e-9, 0.0):
        modulus.use(conditions(points, share), softening)
        found.append(modulus.function.x.array.copy())
        bearing.append(modulus.bearing.x.array.copy())
    np.testing.assert_allclose(found[0], LIQUID)
    np.testing.assert_allclose(found[1:], 0.5 * SOLID)
    assert not bearing[0].any() and np.all(bearing[1:] == np.ones_like(bearing[0]))
    modulus.commit()
    modulus.use(conditions(points, 0.0), softening)
    np.testing.assert_allclose(modulus.function.x.array, LIQUID)
    modulus.rewind(conditions(points, 0.0), softening)
    np.testing.assert_allclose(modulus.function.x.array, 0.5 * SOLID)
    modulus.use(conditions(points, 0.0), softening)
    np.testing.assert_allclose(modulus.function.x.array, LIQUID)
    assert not modulus.bearing.x.array.any()
    modulus.use(conditions(points, 0.3, liquid=None), softening)
    np.testing.assert_allclose(modulus.function.x.array, 0.5 * SOLID)
    assert modulus.bearing.x.array.all()


def test_solid_beside_mush_is_elastic(points, cells):
    """Until the end of the step, whatever passes say."""
    modulus = SecantModulus(points, cells)
    softening = np.full(points.count, 0.01)
    expected = np.full(points.count, 0.01 * SOLID)
    expected[2] = SOLID
    for both in ([2], []):
        modulus.use(conditions(points, 0.9, both=both), softening)
        np.testing.assert_allclose(modulus.function.x.array, expected)
    modulus.commit()
    modulus.use(conditions(points, 0.9), softening)
    np.testing.assert_allclose(modulus.function.x.array, 0.01 * SOLID)
    modulus.rewind(conditions(points, 0.9), softening)
    np.testing.assert_allclose(modulus.function.x.array, expected)
