"""What must fit together between the parts of a case."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import REMOVED, cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")
SPATIAL = {
    "geometry__model": "3d",
    "probes__0__at": [0, 0, 0.05],
    "probes__1__at": [0.03, 0, 0.05],
}
MECHANICAL = {"coupling__scheme": "mechanical"}
RIGID = {"bodies__1__law": "rigid"}
NORTON = {"model": "norton", "coefficient": 1e-8, "exponent": 2, "coherency": 0.7}


@pytest.mark.parametrize(
    "changes",
    [
        {},
        SPATIAL,
        {**SPATIAL, "boundaries__1__displacement": {"x": 0, "y": "uniform"}},
        {"boundaries__1__displacement": {"r": 0, "z": "uniform"}},
        {"boundaries__1__on": "casting/mould"},
        {"boundaries__0__clamp": {"force": "20 kN", "stiffness": "1 MN/mm"}},
        {"boundaries__0__clamp": {"force": "20 kN", "direction": "z"}},
        {**SPATIAL, "boundaries__0__clamp": {"force": "20 kN", "direction": "y"}},
        {"boundaries__1__on": "mould/outside"},
        {"interfaces__0__contact__initial_gap": {"along": "z", "table": [[0, 0], [1, 1e-3]]}},
        {**MECHANICAL, "interfaces__0__heat": REMOVED},
        {**MECHANICAL, "bodies__0__temperature_history": [[0, 670], ["10 s", "20 degC"]]},
        {**MECHANICAL, "materials__steel__expansion": REMOVED},
        {**MECHANICAL, "materials__steel__conductivity": REMOVED},
        {"coupling__scheme": "thermal", "materials__steel__young_modulus": REMOVED},
        {"coupling__scheme": "thermal", "bodies__0__formulation": "displacement"},
        {"coupling__scheme": "thermal", "materials__aluminium__liquid": NORTON},
        {"coupling__scheme": "thermal", "materials__aluminium__solidification_shrinkage": 0.06},
        {"loads": {}},
        {"loads__gravity": [0, "-9.81 m/s^2"]},
        {"bodies__1__material": "steel-H13"},
        {"materials__steel": {"extends": "steel-H13", "conductivity": 30}},
        {"bodies__1__material": "Cu-pure"},
        {"materials__aluminium__liquid": "none", "bodies__0__formulation": "displacement"},
        {"materials__aluminium__liquid": NORTON},
        {"materials__aluminium__solidification_shrinkage": 0.06},
        {"bodies__0__material": "AlCu4.5"},
        {"materials__AlCu4.5": {"extends": "AlCu4.5"}, "bodies__0__material": "AlCu4.5"},
        {**RIGID, "materials__steel__young_modulus": REMOVED},
    ],
)
def test_accepted(changes):
    assert read_case(cylinder(**changes), FILE).bodies[0].name == "casting"


@pytest.mark.parametrize(
    "changes, text",
    [
        (
            {"bodies__1__material": "stel"},
            "bodies[1].material = \"stel\": unknown material 'stel'; known: 316L, AZ91, Al-pure, ",
        ),
        ({"bodies__1__material": "stel"}, '(did you mean "steel"?)'),
        (
            {"materials__steel__heat_capacity": [[20, 500], [300, 1e-30], [900, 1e-30]]},
            "materials.steel.heat_capacity = [[20, 500], [300, 1e-30], [900, 1e-30]]: the enthalpy",
        ),
        (
            {"bodies__1__name": "die"},
            'bodies[1].name = "die": no such body; cylinder_in_mould makes',
        ),
        ({"bodies__1__name": "casting"}, 'bodies[1].name = "casting": is there already'),
        ({"probes__1__name": "centre"}, 'probes[1].name = "centre": is there already'),
        (
            {"interfaces__0__bodies": ["casting", "mold"]},
            'interfaces[0].bodies[1] = "mold": unknown',
        ),
        ({"interfaces__0__bodies": ["casting", "mold"]}, 'did you mean "mould"?'),
        ({"interfaces__0__bodies": ["mould", "mould"]}, "an interface needs two different bodies"),
        (
            {"interfaces__0__heat": REMOVED},
            'interfaces[0].heat: missing; law = "none" lets no heat',
        ),
        (
            {"interfaces__0__contact__initial_gap": {"along": "x", "table": [[0, 0], [1, 1]]}},
            'initial_gap.along = "x": coordinates of this model: r, z',
        ),
        (
            {"boundaries__1": {"on": "mould/outside", "heat": {"type": "flux", "value": 1}}},
            "'mould/outside' has it already; put both in one entry",
        ),
        (
            {"boundaries__1__displacement": {"x": 0}},
            "boundaries[1].displacement.x = 0: directions of the model 'axisymmetric': r, z, norma",
        ),
        (
            {**SPATIAL, "boundaries__1__displacement": {"r": 0}},
            "displacement.r = 0: directions of the model '3d': x, y, z, normal, all",
        ),
        (
            {"output__every": 1e-300},
            "output.every = 1e-300: would write more than 10000 states until",
        ),
        ({"boundaries__1__traction": [1, 2, 3]}, "traction = [1, 2, 3]: needs 2 components"),
        ({"boundaries__1__pressure": {"formula": "t*x"}}, "pressure: not x; coordinates of this"),
        ({"boundaries__1__traction": [1, {"formula": "x"}]}, "not x; coordinates of this model"),
        (
            {"boundaries__1__clamp": {"force": 1, "direction": "y"}},
            "clamp.direction = \"y\": a clamp in the model 'axisymmetric' may have: z, all",
        ),
        (
            {**SPATIAL, "boundaries__1": {"on": "mould/symmetry-x", "clamp": {"force": 1}}},
            "boundaries[1].clamp: the body goes on behind a symmetry plane",
        ),
        (
            {"boundaries__1": {"on": "mould/top", "clamp": "free"}},
            'boundaries[1].clamp = "free": only a stage lifts what held a surface before',
        ),
        ({"loads__gravity": [0]}, "loads.gravity = [0]: needs 2 components in the model 'axisymm"),
        ({"loads__gravity": [-9.81, 0]}, "must point along the axis in an axisymmetric model"),
        ({"loads__gravity": [0, -9.81, 0]}, "must point along the axis in an axisymmetric model"),
        ({**SPATIAL, "loads__gravity": [0, -9.81]}, "needs 3 components in the model '3d'"),
        (
            {"probes__0__body": "cast"},
            'probes[0].body = "cast": unknown body; known: casting, mould',
        ),
        (
            {"probes__1__interface": "mould/casting"},
            'probes[1].interface = "mould/casting": unknown interface; known: casting/mould',
        ),
        (
            {"probes__0__below": "mould/outside"},
            "probes[0].below = \"mould/outside\": no surface of 'casting'; known: casting/mould, "
            "casting/SURFACE",
        ),
        (
            {"probes__0__at": [0, 0, 0]},
            "probes[0].at = [0, 0, 0]: needs 2 coordinates in the model",
        ),
        (
            {"bodies__0__temperature_history": [[0, 670], [10, 20]]},
            'prescribes the temperature, but coupling.scheme = "iterated" solves for it',
        ),
        ({"bodies__0__temperature": REMOVED}, "bodies[0].temperature: missing; the initial temp"),
        (
            {**MECHANICAL, "bodies__0__temperature": REMOVED},
            "bodies[0].temperature: missing; the initial temperature in °C is needed",
        ),
        (
            {"bodies__0__formulation": "displacement"},
            "bodies[0].formulation = \"displacement\": material 'aluminium' has an incompressible",
        ),
        (
            {"materials__steel__young_modulus": REMOVED},
            "materials.steel.young_modulus: missing; body 'mould' needs it for mechanics",
        ),
        (
            {"bodies__1__material": "insulation-fibre"},
            "has no young_modulus; body 'mould' needs it for mechanics, or law = \"rigid\"",
        ),
        ({"materials__steel__poisson_ratio": REMOVED}, "materials.steel.poisson_ratio: missing;"),
        (
            {"materials__steel__expansion": REMOVED},
            "materials.steel.expansion: missing; body 'mould'",
        ),
        ({"materials__steel__density": REMOVED}, "materials.steel.density: missing; body 'mould'"),
        (
            {"materials__steel__conductivity": REMOVED},
            "materials.steel.conductivity: missing; body 'mould' needs it for heat",
        ),
        ({"materials__steel__heat_capacity": REMOVED}, "materials.steel.heat_capacity: missing;"),
        (
            {**MECHANICAL, "materials__steel__density": REMOVED},
            "materials.steel.density: missing; body 'mould' needs it for gravity",
        ),
        (
            {
                **MECHANICAL,
                "materials__steel__expansion": REMOVED,
                "bodies__1__temperature_history": [[0, 20], [1, 30]],
            },
            "materials.steel.expansion: missing; body 'mould' needs it for its thermal strain",
        ),
        (
            {"bodies__1__material": "sand-silica", "materials__sand-silica": {"extends": "sand"}},
            'materials.sand-silica.extends = "sand"',
        ),
    ],
)
def test_refused(changes, text):
    with pytest.raises(CaseError) as caught:
        read_case(cylinder(**changes), FILE)
    assert text in str(caught.value)


def test_two_interfaces_between_the_same_bodies():
    data = cylinder()
    data["interfaces"].append({**data["interfaces"][0], "bodies": ["mould", "casting"]})
    with pytest.raises(CaseError, match=r"interfaces\[1\].bodies.*have an interface already"):
        read_case(data, FILE)


@pytest.mark.parametrize(
    "model, given, expected",
    [
        ("axisymmetric", [0, 0, -9.81], (0.0, -9.81)),
        ("axisymmetric", [0, -9.81], (0.0, -9.81)),
        ("3d", [1, 2, 3], (1.0, 2.0, 3.0)),
        ("3d", None, (0.0, 0.0, 0.0)),
        ("axisymmetric", None, (0.0, 0.0)),
    ],
)
def test_gravity_in_the_directions_of_the_model(model, given, expected):
    places = SPATIAL if model == "3d" else {}
    data = cylinder(**places)
    data["loads"] = {} if given is None else {"gravity": given}
    assert read_case(data, FILE).loads.gravity == expected
