"""Perzyna's flow rule: rate (f/viscosity)^exponent."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.errors import CaseError
from castx.materials.flow import VISCOPLASTIC, solid_flow
from castx.materials.flow_rules.perzyna import RULE, overstress, problems
from castx.materials.rules.viscosity import VISCOSITY
from castx.tables import Table
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial


def rate(f: float, values: Mapping[str, float], temperature: float) -> float:
    return (f / values["viscosity"]) ** values["exponent"]


def drawn(draw: st.DrawFn, stress: float, rate: float, temperature: float) -> dict[str, float]:
    exponent = draw(st.floats(0.7, 8.0))
    return {"viscosity": stress / rate ** (1 / exponent), "exponent": exponent}


@given(f=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_tables_over_temperature(f: float, step: float) -> None:
    keys = {"viscosity": [[100, 1e9], [500, 5e8]], "exponent": [[100, 2], [500, 6]]}
    modulus, temperature = np.array([20e9, 26e9]), np.array([100.0, 400.0])
    material = alloy(**keys, yield_stress=1e8)
    properties = solid_flow(material, VISCOPLASTIC, modulus, temperature, step)
    rate = (f / np.array([1e9, 6.25e8])) ** np.array([2.0, 5.0])
    np.testing.assert_allclose(properties.overstress(rate * step), f, rtol=1e-11)


def test_a_printed_value() -> None:
    """η = 2 MPa s^(1/3), n = 3: 4 MPa flow at 8/s, over 0.5 s by 4."""
    values = {"viscosity": np.array([2e6]), "exponent": np.array([3.0])}
    found = overstress(values, np.array([20.0]), 0.5)
    assert found(np.array([4.0]))[0] == pytest.approx(4e6, rel=1e-14)


def test_a_unit_of_pascal_seconds_needs_exponent_1() -> None:
    written = VISCOSITY.entry.read("2 MPa*s")
    for exponent, found in ((1.0, []), (2.0, ["viscosity"])):
        tables = {"viscosity": written, "exponent": Table.constant(exponent)}
        assert [key for key, _ in problems(tables)] == found
    with pytest.raises(CaseError, match="a unit of Pa·s fits exponent 1 only"):
        described(viscosity="2 MPa*s", exponent=2)


def test_it_is_the_law_of_a_material_that_names_none() -> None:
    assert RULE.is_default and described().law == RULE.name
