"""Interfaces: the law of heat transfer and the initial gap."""

import numpy as np
import pytest

from castx.contact.description import Contact
from castx.interfaces import Interface, InterfaceHeat
from castx.refusal import Refusal

pytestmark = pytest.mark.serial

PRESSURE = {"resistance": 1.6666667e-5, "hardness": "1.2 GPa", "exponent": 0.95}
LIMITED = {"law": "limited", "closed": 800, "gas_conductivity": 0.04}


def coefficient(heat, gap, pressure=0.0):
    return InterfaceHeat.read(heat).coefficient(np.atleast_1d(gap), np.atleast_1d(pressure))


def test_limited_is_the_smaller_of_contact_and_gas():
    # 0.04/100e-6 = 400, 0.04/50e-6 = 800, 0.04/25e-6 = 1600
    h = coefficient(LIMITED, [0.0, 25e-6, 50e-6, 100e-6, 1e-3], np.zeros(5))
    np.testing.assert_allclose(h, [800.0, 800.0, 800.0, 400.0, 40.0], rtol=1e-12)


def test_series_adds_the_resistances():
    # 1/(1/2000 + 1e-4/0.05) = 400
    heat = {"law": "series", "closed": "2 kW/m^2/K", "gas_conductivity": 0.05}
    np.testing.assert_allclose(coefficient(heat, [0.0, 1e-4], np.zeros(2)), [2000.0, 400.0])


def test_constant_perfect_and_none():
    gaps = np.array([-1e-6, 0.0, 1e-3])
    heat = {"law": "constant", "closed": 80}
    np.testing.assert_array_equal(coefficient(heat, gaps, np.zeros(3)), [80.0] * 3)
    np.testing.assert_array_equal(coefficient({"law": "perfect"}, gaps, np.zeros(3)), [np.inf] * 3)
    np.testing.assert_array_equal(coefficient({"law": "none"}, gaps, np.zeros(3)), [0.0] * 3)


def test_closed_contact_of_two_bars():
    # verification V19: h0 + (1/R)(p/H_e)^b at p = 276.472197 MPa
    h = coefficient({**LIMITED, "pressure": PRESSURE}, 0.0, 276.472197e6)
    np.testing.assert_allclose(h, 15676.404, rtol=1e-6)


@pytest.mark.parametrize("law", ["limited", "series"])
@pytest.mark.parametrize("exponent", [0.5, 0.95, 1.0, 1.5])
def test_the_law_is_continuous_at_closure_and_monotone(law, exponent):
    heat = {**LIMITED, "law": law, "pressure": {**PRESSURE, "exponent": exponent}}
    gaps = np.concatenate([np.linspace(1e-4, 1e-13, 200), np.zeros(200)])
    pressures = np.concatenate([np.zeros(200), np.geomspace(1e-9, 1e9, 200)])
    h = coefficient(heat, gaps, pressures)
    assert (np.diff(h) >= -1e-9).all()
    assert h[199] == pytest.approx(800.0, rel=1e-6) and h[200] == pytest.approx(800.0, rel=1e-6)


@pytest.mark.parametrize("exponent", [0.5, 0.95])
def test_the_slope_over_pressure_is_bounded(exponent):
    pressure = InterfaceHeat.read(
        {**LIMITED, "pressure": {**PRESSURE, "exponent": exponent}}
    ).pressure
    knee = 1e-6 * 1.2e9
    steepest = pressure(knee) / knee
    p = np.geomspace(1e-12, 1e9, 500)
    assert (np.diff(pressure(p)) / np.diff(p) <= steepest * (1 + 1e-9)).all()
    np.testing.assert_allclose(pressure(knee), 1e-6**exponent / 1.6666667e-5, rtol=1e-12)
    np.testing.assert_allclose(pressure(knee * (1 + 1e-9)), pressure(knee), rtol=1e-8)


def test_penetration_counts_as_closed_and_tension_as_no_pressure():
    heat = {**LIMITED, "pressure": PRESSURE}
    np.testing.assert_array_equal(coefficient(heat, -1e-6, -1e6), coefficient(heat, 0.0, 0.0))


@pytest.mark.parametrize("key, other", [("resistance", 2e-5), ("hardness", 2e9), ("exponent", 0.8)])
def test_every_number_of_the_pressure_law_acts(key, other):
    changed = {**LIMITED, "pressure": {**PRESSURE, key: other}}
    before = coefficient({**LIMITED, "pressure": PRESSURE}, 0.0, 1e8)
    assert abs(coefficient(changed, 0.0, 1e8) - before) > 1.0


def test_coefficients_are_new_arrays_of_the_common_shape():
    h = InterfaceHeat.read(LIMITED).coefficient(0.0, np.zeros(4))
    assert h.shape == (4,) and h.flags.writeable
    assert InterfaceHeat.read(LIMITED).coefficient(np.zeros(0), np.zeros(0)).shape == (0,)


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
        (
            {**LIMITED, "law": "solid-fraction"},
            "law: not available yet; available: limited, series",
        ),
        ({**LIMITED, "open": 100}, "open: not available yet"),
        ({**LIMITED, "radiation": {"emissivities": [0.3, 0.8]}}, "radiation: not available yet"),
        ({**LIMITED, "roughness": [1e-6, 1e-6]}, "roughness: not available yet"),
        ({**LIMITED, "coating": {"thickness": 1e-4}}, "coating: not available yet"),
        (
            {**LIMITED, "closed": {"over": "time", "table": [[0, 1]]}},
            "closed: a table over another variable is not available yet",
        ),
        ({"law": "perfect", "pressure": PRESSURE}, "pressure: the law 'perfect' takes no further"),
        ({"law": "perfect", "closed": 5}, "closed: the law 'perfect' takes no further numbers"),
        (
            {"law": "constant", "closed": 5, "gas_conductivity": 1},
            "gas_conductivity: the law 'constant' takes closed, pressure",
        ),
        ({"law": "none", "gas_conductivity": 1}, "gas_conductivity: the law 'none' takes no"),
        ({**LIMITED, "pressure": {"resistance": 1e-5}}, "pressure.hardness: missing"),
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
            "pressure.roughness: not avail",
        ),
    ],
)
def test_refused_heat(heat, text):
    with pytest.raises(Refusal, match=text):
        InterfaceHeat.read(heat)


PLANE = np.array([[0.0, 1.0], [0.5, 2.0], [2.0, 3.0]])
SPACE = np.array([[3.0, 4.0, 1.0], [0.0, 0.5, 2.0]])


@pytest.mark.parametrize(
    "gap, points, expected",
    [
        ("-25 um", PLANE, [-25e-6] * 3),
        ({"along": "x", "table": [[0, 0], [1, "1 mm"]]}, PLANE, [0.0, 5e-4, 1e-3]),
        ({"along": "r", "table": [[0, 0], [1, "1 mm"]]}, PLANE, [0.0, 5e-4, 1e-3]),
        ({"along": "y", "table": [[1, 0], [3, 2]]}, PLANE, [0.0, 1.0, 2.0]),
        ({"along": "z", "table": [[1, 0], [3, 2]]}, PLANE, [0.0, 1.0, 2.0]),
        ({"along": "y", "table": [[0, 0], [4, 4]]}, SPACE, [4.0, 0.5]),
        ({"along": "z", "table": [[1, 0], [2, 1]]}, SPACE, [0.0, 1.0]),
        ({"along": "r", "table": [[0, 0], [5, 5]]}, SPACE, [5.0, 0.5]),
    ],
)
def test_initial_gap(gap, points, expected):
    contact = Contact.read({"initial_gap": gap})
    np.testing.assert_allclose(contact.initial_gap.at(points), expected, atol=1e-15)


def test_contact_by_default():
    contact = Interface.read({"bodies": ["casting", "mould"]}).contact
    assert (contact.method, contact.normals) == ("condensed", "averaged")
    np.testing.assert_array_equal(contact.initial_gap.at(PLANE), np.zeros(3))


def test_what_asks_for_nothing_is_accepted():
    Contact.read({"pairing": "node-to-node", "friction": 0.0, "fallback": []})


@pytest.mark.parametrize(
    "contact, text",
    [
        ({"method": "condensd"}, r'method: unknown.*did you mean "condensed"\?'),
        (
            {"method": "penalty"},
            "method: not available yet; available: condensed, multipliers, none",
        ),
        ({"method": "augmented-lagrangian"}, "method: not available yet"),
        ({"method": "block-iterative"}, "method: not available yet"),
        ({"method": "rigid"}, "method: not available yet"),
        ({"method": "tied"}, "method: not available yet"),
        ({"penalty": "auto"}, "penalty: not available yet"),
        ({"pairing": "node-to-face"}, "pairing: not available yet"),
        ({"normals": "patches"}, "normals: not available yet"),
        ({"normals": "primary"}, "normals: not available yet"),
        ({"friction": 0.2}, "friction: not available yet"),
        ({"fallback": ["penalty"]}, "fallback: not available yet"),
        ({"initial_gap": "1 s"}, "initial_gap: 's' is not a unit of length"),
        ({"initial_gap": {"along": "x"}}, "initial_gap.table: missing; both along and table"),
        (
            {"initial_gap": {"along": "t", "table": [[0, 1]]}},
            "initial_gap.along: unknown; allowed: x",
        ),
        ({"initial_gap": {"along": "x", "tabel": [[0, 1]]}}, 'tabel: unknown key.*mean "table"'),
        (
            {"initial_gap": {"along": "x", "table": [[0, 1], [0, 2]]}},
            r"initial_gap.table\[1\]: the",
        ),
    ],
)
def test_refused_contact(contact, text):
    with pytest.raises(Refusal, match=text):
        Contact.read(contact)


def test_an_interface_has_two_sides():
    interface = Interface.read({"bodies": ["casting", "mould"], "heat": LIMITED})
    assert (interface.name, interface.secondary, interface.primary) == (
        "casting/mould",
        "casting",
        "mould",
    )
    with pytest.raises(Refusal, match="bodies: at least 2 needed, there are 1"):
        Interface.read({"bodies": ["casting"]})
    with pytest.raises(Refusal, match="bodies: at most 2 allowed"):
        Interface.read({"bodies": ["a", "b", "c"]})
