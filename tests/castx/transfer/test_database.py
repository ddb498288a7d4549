"""Interfaces of the database: sources, units and ranges, and coefficients that are possible."""

from __future__ import annotations

from copy import deepcopy

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.errors import CaseError
from castx.input.sourced import UNKNOWN_SOURCE
from castx.report.interface_law import heat_transfer_coefficient
from castx.transfer.database import (
    interface_entry,
    interface_names,
    plain_numbers,
    read_interface,
    unit_of,
)

pytestmark = pytest.mark.serial

PROMISED = {
    "aluminium-steel-coated", "aluminium-steel-coating-layer", "aluminium-steel-uncoated",
    "aluminium-steel-low-pressure", "aluminium-steel-high-pressure", "aluminium-sand",
    "aluminium-sand-green", "aluminium-sand-furan", "aluminium-core-sand", "aluminium-chill-copper",
    "aluminium-chill-iron", "aluminium-copper-cooled", "aluminium-graphite", "bronze-sand",
    "iron-sand-green", "iron-sand-coated", "iron-chill-iron", "steel-sand", "steel-sand-coated",
    "steel-investment-shell", "magnesium-steel-squeeze", "magnesium-steel-high-pressure",
    "zinc-steel-high-pressure", "steel-copper-cooled",
}  # fmt: skip
UNITS = {
    "closed": "W/m²/K", "gas_conductivity": "W/m/K", "roughness": "m", "coating.thickness": "m",
    "coating.conductivity": "W/m/K", "radiation.emissivities": "", "law": "",
}  # fmt: skip
NO_GAP = {"aluminium-sand-furan"}  # measured with whatever gap there was
GAPS = np.array([0.0, 1e-6, 1e-5, 1e-4, 1e-3, 5e-3])


def test_the_promised_interfaces_are_there():
    assert set(interface_names()) >= PROMISED
    assert interface_names() == tuple(sorted(interface_names()))


@pytest.mark.parametrize("name", interface_names())
def test_every_number_has_source_unit_and_a_range_that_holds_it(name):
    entry = interface_entry(name)
    assert all((entry.summary, entry.alloy, entry.mould, entry.layer, entry.process))
    names = [number.name for number in entry.numbers]
    assert {name.partition(".")[0] for name in names} == set(entry.heat)
    for number in entry.numbers:
        assert len(number.source) >= len(UNKNOWN_SOURCE) and number.unit == UNITS[number.name]
        if number.name == "law":
            continue
        values = plain_numbers(number.value)
        each = number.ranges if isinstance(number.value, list) else number.ranges * len(values)
        assert len(each) == len(values)
        assert all(low <= value <= high for value, (low, high) in zip(values, each, strict=True))


@pytest.mark.parametrize("name", interface_names())
def test_every_law_takes_its_entry_and_conducts_less_over_wider_gaps(name):
    heat = interface_entry(name).heat
    InterfaceHeat.read(heat)
    for hot, cold in ((1500.0, 20.0), (600.0, 300.0), (30.0, 20.0)):
        h = heat_transfer_coefficient(heat, gap=GAPS, secondary=hot, primary=cold)
        assert np.isfinite(h).all() and (h > 0.0).all()
        if name in NO_GAP:
            assert (h == h[0]).all()
            continue
        assert (np.diff(h) < 0.0).all()
        # A gap of 5 mm of air conducts less than 20 W/m²/K at any temperature of casting.
        assert h[-1] < 20.0


def test_coefficients_are_in_the_order_that_foundries_know():
    closed = {
        name: float(heat_transfer_coefficient(interface_entry(name).heat))
        for name in interface_names()
    }
    cooled = ("aluminium-copper-cooled", "aluminium-chill-iron", "aluminium-steel-coated")
    assert sorted(cooled, key=lambda name: -closed[name]) == list(cooled)
    for metal in ("iron-sand", "steel-sand"):
        bare = closed.get(metal, closed.get(f"{metal}-green"))
        assert bare is not None and closed[f"{metal}-coated"] < bare
    assert closed["aluminium-sand"] < closed["aluminium-steel-uncoated"]
    assert closed["aluminium-steel-coated"] < closed["aluminium-steel-low-pressure"]
    # Two ways to the same coated die.
    layer = closed["aluminium-steel-coating-layer"]
    assert layer == pytest.approx(closed["aluminium-steel-coated"], rel=0.2)


@pytest.mark.parametrize("name", [name for name in interface_names() if name not in NO_GAP])
def test_the_gas_is_air(name):
    """The numbers of the polynomial that the entries name, in mW/m/K over °C."""
    table = interface_entry(name).heat["gas_conductivity"]["table"]
    polynomial = (
        6.5691470817717812e-15, -3.4025961923050509e-11, 5.3279284846303157e-08,
        -4.5340839289219472e-05, 7.6129675309037664e-02, 2.4169481088097051e01,
    )  # fmt: skip
    at, values = np.array(table).T
    np.testing.assert_allclose(values, 1e-3 * np.polyval(polynomial, at), rtol=2.5e-3)


def test_unknown_interfaces_are_refused():
    with pytest.raises(CaseError, match=r"unknown interface 'steel-snad'; known: .*steel-sand"):
        interface_entry("steel-snad")


@pytest.mark.parametrize(
    ("path", "unit"),
    [
        (("closed",), "W/m²/K"),
        (("pressure", "resistance"), "m² K/W"),
        (("pressure", "exponent"), ""),
        (("roughness",), "m"),
        (("decay_length",), "m"),
        (("coating", "colour"), None),
        (("colour",), None),
    ],
)
def test_units(path, unit):
    assert unit_of(path) == unit


ENTRY = {
    "summary": "a", "alloy": "b", "mould": "c", "layer": "none", "process": "d",
    "law": {"value": "series", "source": "x"},
    "closed": {"value": 900, "unit": "W/m²/K", "range": [500, 2000], "source": "somebody (1999)"},
    "gas_conductivity": {
        "value": {"over": "temperature", "table": [[20, 0.02], [900, 0.07]]},
        "unit": "W/m/K", "range": [0.02, 0.1], "source": "x",
    },
    "radiation": {
        "emissivities": {"value": [0.2, 0.8], "range": [[0.1, 0.3], [0.7, 0.9]], "source": "x"},
    },
}  # fmt: skip


def test_an_entry_is_read():
    entry = read_interface(ENTRY, "a.toml")
    assert (entry.summary, entry.alloy, entry.mould, entry.process) == ("a", "b", "c", "d")
    assert entry.heat["radiation"] == {"emissivities": [0.2, 0.8]}
    closed = next(number for number in entry.numbers if number.name == "closed")
    assert closed == ("closed", 900, "W/m²/K", ((500.0, 2000.0),), "somebody (1999)")


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("summary",), "", r"a.toml: summary = \"\": missing; a text"),
        (("mould",), None, r"mould: missing; a text"),
        (("law", "value"), "serie", r'law.value = "serie": missing or unknown; laws: constant'),
        (("law",), None, r"law.value: missing or unknown; laws: constant"),
        (("closed",), 900, r"closed = 900: a table is needed: \{ value"),
        (("closed", "source"), "", r"closed.source = \"\": missing; author"),
        (("closed", "unit"), "kW/m²/K", r'closed.unit = "kW/m²/K": must be "W/m²/K"; convert'),
        (("closed", "valid"), [0, 1], r"closed.valid.*: unknown key; known keys: value, unit"),
        (("closed", "range"), None, r"closed.range: missing; the lowest and highest"),
        (("closed", "range"), [2000, 500], r"closed.range = .*: missing; the lowest and highest"),
        (("closed", "range"), [500], r"closed.range = .*: missing; the lowest and highest"),
        (("closed", "range"), [1000, 2000], r"closed.value = 900: outside range = \[1000, 2000\]"),
        (("gas_conductivity", "range"), [0.03, 1], r"gas_conductivity.value.*: outside range"),
        (("radiation", "emissivities", "range"), [0.1, 0.9], r"emissivities.range = .*: missing"),
        (
            ("radiation", "emissivities", "range"),
            [[0.1, 0.3], [0.1, 0.3]],
            r"radiation.emissivities.value = .*: outside range",
        ),
        (("decay_length",), {"value": 1, "source": "x"}, "'series' does not take it; known: law"),
    ],
)  # fmt: skip
def test_refused_entries_name_file_key_value_and_cure(path, value, message):
    content = deepcopy(ENTRY)
    place = content
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    if value is None:
        del place[path[-1]]
    with pytest.raises(CaseError, match=message):
        read_interface(content, "a.toml")
