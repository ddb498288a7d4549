"""All flow rules: their overstress is increasing, and the inverse of the rate in their tests."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from castx.materials.inelastic import FLOW_RULES
from castx.materials.material import Material
from tests.castx.flow_reference import TEST_FILES, reference
from tests.castx.materials.descriptions import described

pytestmark = pytest.mark.serial

INCREMENT = np.logspace(-12, 1, 27, dtype=np.float64)


@pytest.mark.parametrize("name", FLOW_RULES)
@settings(max_examples=25)
@given(data=st.data())
def test_the_overstress_over_a_step_is_the_inverse_of_the_rate(name, data) -> None:
    stress, rate = 10 ** data.draw(st.floats(5, 9)), 10 ** data.draw(st.floats(-8, 2))
    step, temperature = 10 ** data.draw(st.floats(-3, 3)), data.draw(st.floats(0.0, 700.0))
    values = reference(name).drawn(data.draw, stress, rate, temperature)
    assert reference(name).rate(stress, values, temperature) == pytest.approx(rate, rel=1e-8)
    arrays = {key: np.array([value]) for key, value in values.items()}
    overstress = FLOW_RULES[name].overstress(arrays, np.array([temperature]), step)
    assert overstress(np.array([rate * step]))[0] == pytest.approx(stress, rel=1e-8)
    found = float(overstress.logarithm(np.array([stress]))[0])
    assert found == pytest.approx(np.log(rate * step), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("name", FLOW_RULES)
def test_the_overstress_increases_from_zero_and_has_its_slope(name) -> None:
    rule = FLOW_RULES[name]
    arrays = {key: np.full(INCREMENT.shape, value) for key, value in rule.example.items()}
    overstress = rule.overstress(arrays, np.full(INCREMENT.shape, 500.0), 0.5)
    assert (overstress(0.0 * INCREMENT) == 0.0).all()
    values = overstress(INCREMENT)
    assert (np.diff(values) > 0.0).all() and values[0] > 0.0
    y, h = np.log(INCREMENT), 1e-4
    np.testing.assert_allclose(overstress.evaluate(y)[0], values, rtol=1e-10)
    difference = (overstress.evaluate(y + h)[0] - overstress.evaluate(y - h)[0]) / (2 * h)
    np.testing.assert_allclose(overstress.evaluate(y)[1], difference, rtol=1e-6)
    straight = ~overstress.curved
    np.testing.assert_allclose((overstress.modulus * INCREMENT)[straight], values[straight])


@pytest.mark.parametrize("name", FLOW_RULES)
def test_the_example_flows_at_its_rate(name) -> None:
    rule, rates = FLOW_RULES[name], np.logspace(-8, 0, 9, dtype=np.float64)
    stress = rule.example_overstress(rates, 450.0)
    found = [reference(name).rate(f, rule.example, 450.0) for f in stress]
    np.testing.assert_allclose(found, rates, rtol=1e-8)


@pytest.mark.parametrize("name", FLOW_RULES)
def test_a_material_gives_its_tables(name) -> None:
    rule = FLOW_RULES[name]
    material = Material("own", described(law=name, **rule.example))
    tables = rule.tables(material.description)
    assert {key: table(500.0) for key, table in tables.items()} == pytest.approx(rule.example)
    temperature = np.array([500.0])
    found = rule.over_step(material.description, temperature, 2.0)
    arrays = {key: np.array([value]) for key, value in rule.example.items()}
    expected = rule.overstress(arrays, temperature, 2.0)
    assert found(np.array([1e-3])) == expected(np.array([1e-3]))
    assert set(rule.needed) == {key.name for key in rule.keys if key.default is None}


def test_a_rule_without_its_test_file_is_named(monkeypatch) -> None:
    text = r"^the flow rule 'ey-ring' has no test file tests/.*/test_ey_ring\.py: write it; it"
    with pytest.raises(AssertionError, match=text):
        reference("ey-ring")
    monkeypatch.setitem(TEST_FILES, "norton", ModuleType("empty"))
    with pytest.raises(AssertionError, match=r"test_norton\.py has no rate and no drawn; it needs"):
        reference("norton")
