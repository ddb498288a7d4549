"""Fields of heat: read from the nodes, shown in the units of a foundry."""

import pytest

from castx.case.fields.heat import FIELDS
from castx.input.units import number
from tests.castx.case.fields.samples import KnownState, by_name, displayed, followed

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("name", ["temperature", "solid_fraction", "enthalpy"])
def test_values_are_those_of_the_nodes(name):
    state = KnownState()
    assert by_name(FIELDS)[name].values(state) is state.nodes[name]


def test_measured_enthalpies_have_units():
    dimension = by_name(FIELDS)["enthalpy"].dimension
    assert dimension is not None
    assert number("2 MJ/m^3", dimension) == pytest.approx(2e6)


def test_the_heat_flux_is_followed_in_cells():
    assert followed(FIELDS) == {"heat_flux": "cells", "heat_flux_error": "cells"}


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("temperature", 660.0, "660 °C"),
        ("solid_fraction", 0.5, "0.5"),
        ("heat_flux", 2e5, "200 kW/m²"),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_foundry(name, value, text):
    assert displayed(by_name(FIELDS)[name], value) == text
