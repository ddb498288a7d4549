"""All hardening rules: isotropic curves grow from zero, and what is declared is consistent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.materials.inelastic import HARDENING_RULES
from tests.castx.materials.descriptions import described

pytestmark = pytest.mark.serial

CURVES = [rule for rule in HARDENING_RULES if rule.curve is not None]
STRAIN = np.array([1e-6, 1e-3, 0.02, 0.3])


@pytest.mark.parametrize("rule", CURVES, ids=lambda rule: rule.name)
def test_curves(rule) -> None:
    values = {key: np.full(STRAIN.shape, value) for key, value in rule.example.items()}
    curve = rule.curve(values)
    R = curve(STRAIN)
    assert (curve(0.0 * STRAIN) == 0.0).all() and (np.diff(R) > 0.0).all() and curve.curved.all()
    value, steepness = curve.evaluate(STRAIN)
    np.testing.assert_allclose(value, R, rtol=1e-12)
    difference = (curve(1.0001 * STRAIN) - curve(0.9999 * STRAIN)) / 2e-4
    np.testing.assert_allclose(steepness, difference, rtol=1e-6)
    assert (steepness <= curve.steepest * STRAIN * (1 + 1e-12)).all()
    more = STRAIN[::-1]
    rest, expected = curve.after(STRAIN)(more), curve(STRAIN + more) - R
    np.testing.assert_allclose(rest, expected, rtol=1e-9, atol=1e-15 * R.max())
    stress, logarithm = np.full(4, 3e6), np.full(4, -2.0)
    scaled = curve.scaled(stress, logarithm)
    np.testing.assert_allclose(scaled(STRAIN / np.exp(logarithm)), R / stress, rtol=1e-12)
    np.testing.assert_array_equal(curve.at(np.array([2, 0]))(STRAIN[[2, 0]]), R[[2, 0]])


@pytest.mark.parametrize("rule", HARDENING_RULES, ids=lambda rule: rule.name)
def test_a_rule_acts_where_its_first_key_is_not_zero(rule) -> None:
    given = {"hardening": rule.example} if rule.isotropic else rule.example
    material = described(yield_stress=1e7, **given)
    holder, other = ((m.hardening if rule.isotropic else m) for m in (material, described()))
    assert rule.acts(holder) and not rule.acts(other)
    values = rule.values(holder, np.array([20.0, 300.0]))
    assert {key: value[1] for key, value in values.items()} == pytest.approx(rule.example)


def test_incomplete_rules_are_refused() -> None:
    rules = {rule.name: rule for rule in HARDENING_RULES}
    with pytest.raises(TypeError, match="'linear' needs modulus or curve, and not both"):
        replace(rules["linear"], modulus=None)
    with pytest.raises(TypeError, match="'linear' needs modulus or curve, and not both"):
        replace(rules["linear"], curve=rules["voce"].curve)
    with pytest.raises(TypeError, match="'voce': a back stress needs a modulus"):
        replace(rules["voce"], isotropic=False)
    key = replace(rules["linear"].keys[0], default=None)
    with pytest.raises(TypeError, match="'linear' declares no default of linear, as 0"):
        replace(rules["linear"], keys=(key,))
    with pytest.raises(TypeError, match="'voce' has several keys, and declares no title for them"):
        replace(rules["voce"], title="")
