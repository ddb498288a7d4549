"""Numbers in mistaken units are told, with the unit in which they would be usual."""

import pytest

from castx.case.reading.read import load_case
from castx.case.unusual import USUAL, unusual
from castx.materials.database import database_entry, database_names

pytestmark = pytest.mark.serial

CYLINDER = "demos/cylinder.toml"
MINE = "materials.mine"


def found(*given):
    return list(unusual(load_case(CYLINDER, given)))


def of_material(key, value):
    mine = f'{MINE}={{ extends = "AlSi7Mg", {key} = {value} }}'
    return found(mine, 'bodies.0.material="mine"')


@pytest.mark.parametrize(
    ("key", "value", "meant"),
    [
        ("density", "2.7", ': is "2.7 g/cm^3" meant?'),
        ("density", "2.7e-9", ""),
        ("heat_capacity", "0.9", ': is "0.9 kJ/kg/K" meant?'),
        ("heat_capacity", "{ solid = 0.9, liquid = 1.1 }", ': is "1.1 kJ/kg/K" meant?'),
        ("conductivity", "0.16", ': is "0.16 W/mm/K" meant?'),
        ("conductivity", "160e3", ""),
        ("latent_heat", "400", ': is "400 kJ/kg" meant?'),
        ("young_modulus", "[[20, 70], [500, 20]]", ': is "70 GPa" meant?'),
        ("young_modulus", "7e4", ': is "70000 MPa" meant?'),
        ("expansion", "23", ': is "23 um/m/K" meant?'),
        ("expansion", "-2.3e-5", ""),
        ("yield_stress", "[[20, 100], [500, 2]]", ': is "100 MPa" meant?'),
        ("solidification_shrinkage", "0.6", ""),
        ("solidification_shrinkage", "-0.2", ""),
    ],
)
def test_a_property_that_no_material_has_is_told(key, value, meant):
    (text,) = of_material(key, value)
    assert text.startswith(f"mine: {key} = ") and USUAL[key].unit in text
    assert text.endswith(meant or f"plain numbers are in {USUAL[key].unit}")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("density", "51"), ("heat_capacity", "51"), ("conductivity", "0.51"), ("latent_heat", "0"),
        ("young_modulus", "[[20, 1.1e6], [500, 1]]"), ("expansion", "0"), ("yield_stress", "0"),
        ("expansion", "[[20, -1e-6], [500, 1e-6]]"), ("solidification_shrinkage", "-0.1"),
    ],
)  # fmt: skip
def test_what_some_material_has_is_not_told(key, value):
    assert of_material(key, value) == []


SANDS = sorted(name for name in database_names() if database_entry(name).material_class == "sand")


@pytest.mark.parametrize("name", SANDS)
def test_sand_that_is_given_a_solidus_is_no_metal_in_another_unit(name):
    melting = "solidus = 1600, liquidus = 1710, latent_heat = 1.5e5"
    mine = f'{MINE}={{ extends = "{name}", {melting} }}'
    thermal = ('coupling.scheme="thermal"', "probes=[]", 'output.fields=["temperature"]')
    assert found(mine, 'bodies.1.material="mine"', "bodies.1.temperature=100", *thermal) == []


def test_what_melts_is_compared_with_metals_and_other_things_with_moulds_too():
    (text,) = of_material("conductivity", "0.16")
    assert "0.16 is far from that of any metal, 0.5 to 5000 W/m/K; plain" in text
    (text,) = of_material("density", "2.7")
    assert "2.7 is far from that of any casting or mould, 50 to 25000 kg/m³; plain" in text


@pytest.mark.parametrize("name", database_names())
def test_the_database_is_usual(name):
    thermal = ('coupling.scheme="thermal"', "probes=[]", 'output.fields=["temperature"]')
    assert found(f'bodies.1.material="{name}"', "bodies.1.temperature=100", *thermal) == []


@pytest.mark.parametrize(
    ("temperature", "warned"),
    [("943", False), ("961", True), ("1238", True), ('"943 K"', False)],
)
def test_a_casting_poured_far_too_hot_is_told(temperature, warned):
    texts = found(f"bodies.0.temperature={temperature}")
    assert len(texts) == warned
    assert not warned or f"""is "{temperature} K" or "{temperature} degF" meant?""" in texts[0]


@pytest.mark.parametrize(("temperature", "warned"), [("660", False), ("661", True), ("900", True)])
def test_a_mould_hotter_than_the_casting_freezes_is_told(temperature, warned):
    texts = found(f"bodies.1.temperature={temperature}")
    assert len(texts) == warned
    assert not warned or ("nothing can freeze on it" in texts[0] and "660.323 °C" in texts[0])


@pytest.mark.parametrize(
    ("temperature", "mould", "warned"),
    [
        ("650", "20", True), ("530", "20", True), ("520", "20", False), ("661", "20", False),
        ("{ formula = '650' }", "20", False), ("20", "650", False), ("650", "700", True),
    ],
)  # fmt: skip
def test_a_case_that_starts_solid_a_little_below_the_solidus_is_told(temperature, mould, warned):
    texts = found(f"bodies.0.temperature={temperature}", f"bodies.1.temperature={mould}")
    assert len(texts) == warned
    assert not warned or "below the solidus of Al-pure, 660.323 °C: it is solid from" in texts[0]


@pytest.mark.parametrize(("gap", "warned"), [("0.02", False), ("0.021", True), ("-0.5", False)])
def test_a_gap_in_millimetres_is_told(gap, warned):
    texts = found(f"interfaces.0.contact.initial_gap={gap}")
    assert len(texts) == warned
    assert not warned or texts[0].endswith(f'is "{gap} mm" meant?')
