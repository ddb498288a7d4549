"""Bodies: defaults, the initial temperature of a prescribed history, refusals."""

import pytest

from castx.case.bodies import Body
from castx.input.problems import Refusal
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.materials.material import Material

pytestmark = pytest.mark.serial

BODY = {"name": "casting", "material": "AlSi7Mg", "temperature": "700 degC"}


def test_defaults():
    body = Body.read(BODY)
    assert (body.law, body.formulation, body.stabilisation) == ("thermo-elastic", None, "osgs")
    assert body.temperature.uniform == 700.0 and body.heat_source is None


def test_a_history_gives_the_temperature_at_the_start():
    history = [[0, "650 degC"], ["1 min", 20]]
    body = Body.read({"name": "casting", "material": "x", "temperature_history": history})
    assert body.temperature.uniform == 650.0
    assert body.temperature_history(30.0) == pytest.approx(335.0)
    both = Body.read({**BODY, "temperature_history": history})
    assert both.temperature.uniform == 700.0


def test_a_heat_source_may_change_with_time():
    body = Body.read({**BODY, "heat_source": [[0, "2 kW/m^3"], [10, 0]]})
    assert body.heat_source(5.0) == pytest.approx(1000.0)


HISTORY = [[0, 20], ["10 s", 600]]


@pytest.mark.parametrize(
    "temperature, solid",
    [
        ({"temperature": 540}, True),
        ({"temperature": 550}, False),
        ({"temperature": {"along": "x", "table": [[0, 20], [1, 700]]}}, False),
        ({"temperature": {"file": "start.vtu", "field": "T"}}, False),
        ({"temperature": 20, "temperature_history": HISTORY}, False),
    ],
)
def test_a_body_starts_solid_below_its_solidus(temperature, solid):
    freezing = {"solid_fraction": [[545, 1.0], [615, 0.0]], "latent_heat": "400 kJ/kg"}
    material = MaterialDescription.read(freezing)
    assert Body.read({**BODY, **temperature}).starts_solid(material) == solid
    assert Body.read({**BODY, **temperature}).starts_solid(MaterialDescription.read({}))


@pytest.mark.parametrize(
    ("material", "temperature", "poured"),
    [("AlSi7Mg", 700, True), ("AlSi7Mg", 20, False), ("sand-silica", 700, False)],
)
def test_a_body_is_poured_of_a_material_with_a_liquid(material, temperature, poured):
    assert (
        Body.read({**BODY, "temperature": temperature}).is_poured(find_material(material)) == poured
    )


def test_what_melts_without_a_liquid_is_not_poured():
    freezing = {"solid_fraction": [[545, 1.0], [615, 0.0]], "latent_heat": "400 kJ/kg"}
    metal = Material("metal", MaterialDescription.read(freezing))
    assert metal.melts and not Body.read(BODY).is_poured(metal)


@pytest.mark.parametrize(
    "change, text",
    [
        ({"temperature": None}, "temperature: .*needed"),
        ({"name": "a/b"}, "name: a name has 1 to 64"),
        ({"material": "x" * 101}, "material: at most 100 characters"),
        ({"law": "elastic"}, "law: unknown; allowed: thermo-elastic, "),
        ({"formulation": "q1"}, 'formulation: unknown; allowed: .*mean "q1p0"'),
        ({"stabilisation": "none"}, "stabilisation: unknown; allowed: osgs, gls"),
        ({"heat_source": "5 W"}, "heat_source: .*not a unit of heat source per volume"),
        ({"temperature_history": []}, "temperature_history: a table needs 1 to"),
    ],
)
def test_refused(change, text):
    with pytest.raises(Refusal, match=text):
        Body.read({**BODY, **change})


def test_the_initial_temperature_is_needed():
    with pytest.raises(Refusal, match="temperature: missing; the initial temperature in °C"):
        Body.read({"name": "casting", "material": "steel"})
