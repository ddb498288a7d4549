"""Conditions on outer surfaces."""

import pytest

from castx.case.boundaries import FREE_CLAMP, Boundary
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial


CONVECTION = {"type": "convection", "ambient": 20}
OVER_TIME = {"over": "time", "table": [[0, 1]]}


def boundary(**keys):
    return Boundary.read({"on": "mould/outside", **keys})


def test_a_surface_belongs_to_a_body():
    found = boundary(pressure=1)
    assert (found.body, found.surface) == ("mould", "outside")


def test_one_heat_condition_or_a_list():
    assert [h.type for h in boundary(heat={"type": "insulated"}).heat] == ["insulated"]
    convection = {"type": "convection", "coefficient": "50 W/m^2/K", "ambient": "293.15 K"}
    flux = {"type": "flux", "value": [[0, "1 kW/m^2"], ["1 min", 0]]}
    first, second = boundary(heat=[convection, flux]).heat
    assert first.coefficient.table(0.0) == 50.0 and first.ambient(7.0) == pytest.approx(20.0)
    assert second.value(30.0) == pytest.approx(500.0) and first.value is None


def test_a_coefficient_over_time_or_temperature():
    rows = boundary(heat={**CONVECTION, "coefficient": [[0, 5], ["1 min", 10]]}).heat[0]
    assert (rows.coefficient.over, rows.coefficient.table(30.0)) == ("time", 7.5)
    named = boundary(heat={**CONVECTION, "coefficient": OVER_TIME}).heat[0]
    assert (named.coefficient.over, named.coefficient.table(9.0)) == ("time", 1.0)
    table = {"over": "temperature", "table": [["293.15 K", 5], [120, 10]]}
    film = boundary(heat={**CONVECTION, "coefficient": table}).heat[0].coefficient
    assert (film.over, film.of, film.table(70.0)) == ("temperature", "film", pytest.approx(7.5))
    surface = {**CONVECTION, "coefficient": {**table, "of": "surface"}}
    assert boundary(heat=surface).heat[0].coefficient.of == "surface"


def test_radiation():
    given = {"type": "radiation", "emissivity": [[0, 0.2], [10, 0.4]], "ambient": "300 K"}
    both = boundary(heat=[{**CONVECTION, "coefficient": 5}, given]).heat
    assert [condition.type for condition in both] == ["convection", "radiation"]
    assert both[1].emissivity(5.0) == pytest.approx(0.3)


def test_the_value_is_a_temperature_or_a_flux_by_type():
    assert boundary(heat={"type": "temperature", "value": "373.15 K"}).heat[0].value(
        0.0
    ) == pytest.approx(100.0)
    assert boundary(heat={"type": "flux", "value": -3.0}).heat[0].value(0.0) == -3.0


def test_displacements():
    found = boundary(displacement={"normal": 0, "z": [[0, 0], [1, "2 mm"]], "x": "uniform"})
    normal, z, x = found.displacement
    assert (normal.direction, normal.value(5.0), normal.uniform) == ("normal", 0.0, False)
    assert (z.direction, z.value(0.5)) == ("z", pytest.approx(0.001))
    assert (x.direction, x.value, x.uniform) == ("x", None, True)


def test_pressure_and_traction():
    found = boundary(pressure="25 MPa", traction=[0, [[0, 0], [10, "1 MPa"]]])
    assert found.pressure(1.0) == pytest.approx(25e6)
    assert [table(5.0) for table in found.traction] == [0.0, pytest.approx(0.5e6)]


def test_clamp():
    ramp = [[0, 0], ["2 s", "200 kN"]]
    found = boundary(clamp={"force": ramp, "stiffness": "1 MN/mm", "direction": "z"}).clamp
    assert (found.force(1.0), found.stiffness, found.direction) == (1e5, pytest.approx(1e9), "z")
    dead, springs = boundary(clamp={"force": 5e3}).clamp, boundary(clamp={"stiffness": 7}).clamp
    assert (dead.stiffness, dead.direction, springs.force) == (None, None, None)
    assert boundary(clamp="free").clamp is FREE_CLAMP
    left = found.released
    assert (left.force(1.0), left.stiffness, left.direction) == (0.0, None, "z")
    frame = boundary(clamp={"stiffness": 7, "direction": "all"}).clamp
    assert frame.is_frame and not found.is_frame and frame.released.is_frame


@pytest.mark.parametrize(
    "keys, text",
    [
        ({}, "says nothing; give heat, displacement, pressure, traction or clamp"),
        ({"on": "mould"}, 'on: a surface is named "body/surface"'),
        ({"on": "/outside"}, 'on: a surface is named "body/surface"'),
        ({"on": 3}, 'on: a surface is named "body/surface"'),
        ({"heat": {"type": "insulatd"}}, r'heat.type: unknown.*mean "insulated"\?'),
        (
            {"heat": {"type": "radiation", "emissivity": 0.8}},
            "heat.ambient: missing; heat of type 'radiation' needs it",
        ),
        (
            {"heat": {"type": "radiation", "emissivity": 1.2, "ambient": 20}},
            "heat.emissivity: must be positive and at most 1",
        ),
        (
            {"heat": {"type": "convection", "coefficient": 5, "ambient": 20, "emissivity": 0.3}},
            "heat.emissivity: heat of type 'convection' uses coefficient, ambient",
        ),
        (
            {"heat": {**CONVECTION, "coefficient": {"over": "gap", "table": [[0, 1]]}}},
            "heat.coefficient.over: unknown; allowed: temperature, time",
        ),
        (
            {"heat": {**CONVECTION, "coefficient": {"over": "temperature"}}},
            "heat.coefficient.table: missing; both over and table are needed",
        ),
        (
            {"heat": {**CONVECTION, "coefficient": {**OVER_TIME, "of": "film"}}},
            "heat.coefficient.of: only a table over temperature has it, not one over time",
        ),
        (
            {"heat": {**CONVECTION, "coefficient": {**OVER_TIME, "tabel": 3}}},
            r'heat.coefficient.tabel: unknown key.*did you mean "table"\?',
        ),
        (
            {"heat": {**CONVECTION, "coefficient": {"over": "time", "table": [[0, -1]]}}},
            r"heat.coefficient.table\[0\]: must be at least 0",
        ),
        ({"heat": {"value": 3}}, "heat.type: missing"),
        (
            {"heat": {"type": "temperature"}},
            "heat.value: missing; heat of type 'temperature' needs",
        ),
        (
            {"heat": {"type": "temperature", "value": "3 W/m^2"}},
            "heat.value: 'W/m.2' is not a unit",
        ),
        ({"heat": {"type": "flux", "value": "3 K"}}, "heat.value: 'K' is not a unit of heat flux"),
        (
            {"heat": {"type": "flux", "value": [[0, 1], [0, 2]]}},
            r"heat.value\[1\]: the first column",
        ),
        (
            {"heat": {"type": "convection", "coefficient": 5}},
            "heat.ambient: missing; heat of type 'convection' needs it",
        ),
        (
            {"heat": {"type": "convection", "coefficient": -5, "ambient": 20}},
            "heat.coefficient: must be at least 0",
        ),
        (
            {"heat": {"type": "insulated", "value": 5}},
            "heat.value: heat of type 'insulated' uses no numbers",
        ),
        ({"heat": []}, "heat: a list of 1 to 20 heat conditions"),
        ({"heat": [{"type": "flux", "value": 1}, 5]}, r"heat\[1\]: a table of keys"),
        (
            {"heat": [{"type": "insulated"}, {"type": "flux", "value": 1}]},
            "heat: type 'insulated' excludes every other",
        ),
        (
            {"heat": [{"type": "temperature", "value": 1}, {"type": "flux", "value": 1}]},
            "heat: type 'temperature' excludes every other",
        ),
        ({"displacement": {}}, "displacement: a table of directions is needed"),
        ({"displacement": 0}, "displacement: a table of directions is needed"),
        ({"displacement": {"nrmal": 0}}, r'displacement.nrmal: unknown.*mean "normal"\?'),
        ({"displacement": {"x": "unifrom"}}, 'displacement.x: a length is needed.*, or "uniform"'),
        ({"displacement": {"x": "1 K"}}, "displacement.x: 'K' is not a unit of length"),
        ({"displacement": {"x": [[0, 0], [1, "1 K"]]}}, r"displacement.x\[1\]: 'K' is not a unit"),
        ({"displacement": {"all": 0, "x": 0}}, "displacement.all: leaves nothing for the other"),
        ({"pressure": "1 N"}, "pressure: 'N' is not a unit of pressure or stress"),
        ({"traction": 5}, "traction: a list is needed"),
        ({"traction": [1, 2, 3, 4]}, "traction: at most 3 allowed"),
        ({"traction": [1, "5 m"]}, r"traction\[1\]: 'm' is not a unit"),
        ({"clamp": {}}, "clamp: says nothing; give force, stiffness or both"),
        ({"clamp": {"direction": "x"}}, "clamp: says nothing; give force, stiffness or both"),
        ({"clamp": 5}, "clamp: a table of keys is needed"),
        ({"clamp": "open"}, "clamp: a table of keys is needed"),
        ({"clamp": {"force": -1}}, r"clamp.force: must be at least 0 \(in N\)"),
        ({"clamp": {"force": [[0, 1], [1, -1]]}}, r"clamp.force\[1\]: must be at least 0"),
        ({"clamp": {"force": "20 MPa"}}, "clamp.force: 'MPa' is not a unit of force"),
        ({"clamp": {"stiffness": -1}}, "clamp.stiffness: must be positive"),
        ({"clamp": {"stiffness": 0}}, "clamp.stiffness: must be positive"),
        ({"clamp": {"stiffness": "3 N"}}, "clamp.stiffness: 'N' is not a unit of stiffness"),
        ({"clamp": {"stiffness": [[0, 1]]}}, "clamp.stiffness: a stiffness is needed"),
        ({"clamp": {"force": 1, "direction": "r"}}, "clamp.direction: unknown; allowed: x, y, z"),
        ({"clamp": {"force": 1, "stiffness": 1, "direction": "all"}}, "clamp.force: a force has o"),
        ({"clamp": {"fource": 1}}, r'clamp.fource: unknown key.*did you mean "force"\?'),
        ({"presure": 5}, r'presure: unknown key.*did you mean "pressure"\?'),
    ],
)
def test_refused(keys, text):
    with pytest.raises(Refusal, match=text):
        boundary(**keys)
