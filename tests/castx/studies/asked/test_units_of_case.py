"""Units of numbers that a study writes without one."""

import pytest

from castx.studies.asked.inputs import VariedInput
from castx.studies.asked.units_of_case import shown_unit, unit_at

pytestmark = pytest.mark.serial

CASE = {
    "boundaries": [
        {"heat": {"type": "convection", "coefficient": 10.0}},
        {"heat": [{"type": "flux", "value": 1.0}, {"type": "temperature", "value": 1.0}]},
        {"heat": {"type": "radiation", "emissivity": 0.3}},
    ]
}


@pytest.mark.parametrize(
    ("of", "unit"),
    [
        ("interfaces.0.heat.closed", "W/m²/K"),
        ("interfaces[0].heat.gas_conductivity", "W/m/K"),
        ("interfaces.0.heat.coating.thickness", "m"),
        ("interfaces.0.heat.radiation.emissivities.0", ""),
        ("materials.die.conductivity", "W/m/K"),
        ("materials.die.heat_capacity.liquid", "J/kg/K"),
        ("materials.die.latent_heat", "J/kg"),
        ("materials.die.liquid.coherency", ""),
        ("materials.die.yield_stress", "Pa"),
        ("bodies.0.temperature", "°C"),
        ("boundaries.0.heat.coefficient", "W/m^2/K"),
        ("boundaries.0.heat.ambient", "°C"),
        ("boundaries.1.heat.0.value", "W/m^2"),
        ("boundaries.1.heat.1.value", "°C"),
        ("boundaries.2.heat.emissivity", ""),
        ("boundaries.7.heat.coefficient", ""),
        ("stages.0.at", "s"),
        ("geometry.size", "m"),
        ("no.such.number", ""),
    ],
)
def test_the_case_tells_what_it_takes_at_a_path(of, unit):
    assert unit_at(CASE, of) == unit


@pytest.mark.parametrize(
    ("given", "unit"),
    [
        ({"low": 1.0, "high": 2.0}, "W/m/K"),
        ({"low": "1 W/mm/K", "high": "2 W/mm/K"}, "W/mm/K"),
        ({"low": 0.8, "high": 1.2, "factor": True}, ""),
    ],
)
def test_an_input_has_its_own_unit_first_and_a_factor_none(given, unit):
    one = VariedInput.read({"of": "materials.die.conductivity", **given})
    assert shown_unit(CASE, one) == unit
