"""The description of the heat transfer at interfaces: what is read and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial

PRESSURE = {"resistance": 1.6666667e-5, "hardness": "1.2 GPa", "exponent": 0.95}
LIMITED = {"law": "limited", "closed": 800, "gas_conductivity": 0.04}
COATING = {"thickness": "100 um", "conductivity": 0.5}
OVER_TEMPERATURE = {"over": "temperature", "table": [[100, 900], [600, 600]]}
SOLID = {"law": "solid-fraction", "closed": 2000, "open": 200}


def test_radiation():
    heat = InterfaceHeat.read({"law": "none", "radiation": {"emissivities": [0.3, 0.8]}})
    assert heat.radiation.emissivities == (0.3, 0.8)


def test_patches_take_what_they_do_not_change():
    sleeve = {"within": {"z": ["50 mm", "80 mm"]}, "closed": 300, "coating": COATING}
    spot = {"within": {"x": [0, 1], "y": [2, 2]}, "law": "constant", "closed": OVER_TEMPERATURE}
    rough = {**LIMITED, "pressure": {"hardness": 1e9}, "roughness": [1e-6, 1e-6]}
    heat = InterfaceHeat.read({**rough, "patches": [sleeve, spot]})
    first, second = (heat.on(patch) for patch in heat.patches)
    assert (first.law, first.closed.table(0.0)) == ("limited", 300)
    assert first.coating.resistance == pytest.approx(2e-4)
    assert first.roughness == (1e-6, 1e-6) and heat.coating is None
    assert second.law == "constant" and second.gas_conductivity is None
    assert second.closed.of == "secondary"
    plane, space = np.array([[0.5, 0.05], [0.5, 0.1]]), np.array([[0.3, 0.4, 0.08]])
    np.testing.assert_array_equal(heat.patches[0].contains(plane, {}), [True, False])
    np.testing.assert_array_equal(heat.patches[0].contains(space, {}), [True])
    ring = InterfaceHeat.read({**LIMITED, "patches": [{"within": {"r": [0.5, 1]}, "closed": 1}]})
    np.testing.assert_array_equal(ring.patches[0].contains(space, {}), [True])


@pytest.mark.parametrize("coefficient", [1e-6, 0.5])
def test_a_coefficient_may_be_as_small_as_wanted(coefficient):
    heat = InterfaceHeat.read({"law": "constant", "closed": coefficient})
    assert heat.closed.table(0.0) == coefficient


def patched(**keys):
    return {**LIMITED, "patches": [keys]}


@pytest.mark.parametrize(
    "heat, text",
    [
        ({}, "law: missing"),
        ({"law": "limited"}, "closed: missing; the law 'limited' needs it"),
        ({"law": "series", "closed": 800}, "gas_conductivity: missing; the law 'series' needs it"),
        ({**LIMITED, "closed": 0}, r"closed: must be positive \(in W/m\^2/K\)"),
        ({**LIMITED, "closed": -2}, "closed: must be positive"),
        ({**LIMITED, "closed": "800 W/m/K"}, "closed: 'W/m/K' is not a unit of heat-transfer"),
        ({**LIMITED, "gas_conductivity": 0}, "gas_conductivity: must be positive"),
        ({**LIMITED, "law": "limitd"}, r'law: unknown.*did you mean "limited"\?'),
        ({"law": "solid-fraction", "closed": 5}, "open: missing; the law 'solid-fraction' needs"),
        ({**SOLID, "pressure": PRESSURE}, "pressure: the law 'solid-fraction' takes closed, open"),
        ({**SOLID, "open": {"over": "gap", "table": [[0, 1], [1, 2]]}}, "open: in the law 'solid-"),
        ({**LIMITED, "open": 100}, "gas_conductivity: open is given already"),
        ({"law": "limited", "closed": 5, "open": 9}, "open: in the law 'limited' it varies"),
        (
            {"law": "limited", "closed": 50, "open": {"over": "gap", "table": [[0, 40], [1, 2]]}},
            "open: 40 W/m²/K at gap 0, but closed is 50: the law would jump",
        ),
        (
            {
                "law": "limited",
                "closed": {"over": "temperature", "table": [[0, 10], [500, 50], [900, 20]]},
                "open": {"over": "gap", "table": [[0, 40], [1, 2]]},
            },
            "open: 40 W/m²/K at gap 0, but closed is 50: the law would jump",
        ),
        (
            {
                "law": "limited", "roughness": [6e-6, 8e-6], "gas_conductivity": 0.04,
                "open": {"over": "gap", "table": [[0, 40], [1, 2]]},
            },
            "open: 40 W/m²/K at gap 0, but closed is 8000: the law would jump",
        ),
        ({"law": "series", "closed": 5, "gas_conductivity": 1, "open": 3}, "open: the law 'seri"),
        ({**LIMITED, "radiation": {"emissivities": [0.3]}}, "radiation.emissivities: at least 2"),
        ({**LIMITED, "radiation": {"emissivities": [0.3, 0]}}, r"emissivities\[1\]: must be"),
        ({**LIMITED, "radiation": {"emissivities": [1.1, 1]}}, r"emissivities\[0\]: must be"),
        ({**LIMITED, "roughness": [1e-6, 1e-6]}, "roughness: not used: closed is given"),
        ({**LIMITED, "coating": COATING}, "coating: not used: closed is given"),
        ({**LIMITED, "coating": {"thickness": 1e-4}}, "coating.conductivity: missing"),
        ({"law": "constant", "roughness": [1e-6, 2e-6]}, "gas_conductivity: missing; the gas in"),
        (
            {**LIMITED, "closed": {"over": "gap", "table": [[0, 1], [1, 2]]}},
            "closed: in the law 'limited' it varies over temperature or time or pressure",
        ),
        ({**LIMITED, "closed": [[0, 1]]}, 'closed: a table needs its argument: { over = "temperat'),
        ({**LIMITED, "closed": {"table": [[0, 1]]}}, "closed.over: missing; both over and table"),
        ({**LIMITED, "closed": {"over": "tim", "table": [[0, 1]]}}, r'over: unknown.*"time"\?'),
        ({**LIMITED, "closed": {**OVER_TEMPERATURE, "of": "film"}}, "closed.of: unknown; allowed"),
        (
            {**LIMITED, "closed": {"over": "time", "table": [[0, 1], [0, 2]]}},
            r"closed.table\[1\]: the first column must increase",
        ),
        ({**LIMITED, "transition": 0}, "transition: must be positive"),
        ({"law": "constant", "closed": 5, "transition": 1e-5}, "transition: the law 'constant'"),
        ({"law": "perfect", "pressure": PRESSURE}, "pressure: the law 'perfect' takes no further"),
        ({"law": "perfect", "closed": 5}, "closed: the law 'perfect' takes no further numbers"),
        ({"law": "perfect", "radiation": {"emissivities": [1, 1]}}, "radiation: the law 'perfect'"),
        (
            {"law": "constant", "closed": 5, "gas_conductivity": 1},
            "gas_conductivity: the law 'constant' needs it for roughness only",
        ),
        ({"law": "none", "gas_conductivity": 1}, "gas_conductivity: the law 'none' takes"),
        ({**LIMITED, "pressure": {"resistance": 1e-5}}, "pressure.hardness: missing"),
        ({**LIMITED, "pressure": {"hardness": 1e9}}, "pressure.resistance: missing; give it"),
        (
            {**LIMITED, "pressure": {**PRESSURE, "resistance": 0}},
            "pressure.resistance: must be pos",
        ),
        (
            {**LIMITED, "pressure": {**PRESSURE, "exponent": 0}},
            "pressure.exponent: must be above|pos",
        ),
        (
            {**LIMITED, "pressure": {**PRESSURE, "roughness": [1, 2]}},
            "pressure.roughness: resistance is given already",
        ),
        ({**LIMITED, "patches": 5}, "patches: a list of 1 to 100 patches"),
        (patched(closed=5), r"patches\[0\]: a table with a place is needed"),
        (patched(on="", closed=5), r"patches\[0\].on: a name that the mesh has"),
        (patched(on="coated"), r"patches\[0\]: must say what is different"),
        (patched(within={}, closed=5), r"patches\[0\].within: needs a coordinate: x, y, z, r"),
        (patched(within={"t": [0, 1]}, closed=5), r"within.t: unknown coordinate"),
        (patched(within={"x": 1}, closed=5), r"within.x: two bounds are needed"),
        (patched(within={"x": [1, 0]}, closed=5), r"within.x: the lower bound comes first"),
        (patched(within={"x": [0, "1 s"]}, closed=5), r"within.x: 's' is not a unit of length"),
        (patched(within={"x": [0, 1]}), r"patches\[0\]: must say what is different"),
        (patched(within={"x": [0, 1]}, closd=5), r'patches\[0\].closd: unknown key.*"closed"\?'),
        (patched(within={"x": [0, 1]}, law="constant"), r"patches\[0\].closed: missing"),
        (patched(within={"x": [0, 1]}, law="perfect"), r"patches\[0\].law: perfect contact has no"),
        (
            {"law": "perfect", "patches": [{"within": {"x": [0, 1]}, "closed": 5}]},
            "patches: perfect contact has no parts",
        ),
    ],
)
def test_refused_heat(heat, text):
    with pytest.raises(Refusal, match=text):
        InterfaceHeat.read(heat)
