"""Checks of contact, loads and supports against the bodies and surfaces of a case."""

from pathlib import Path
from typing import Any

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")
RIGID = {"bodies__1__law": "rigid"}
THERMAL = {"coupling__scheme": "thermal"}
FACES: dict[str, Any] = {"pairing": "node-to-face", "surfaces": ["mould", "casting"]}
PERFECT = {"law": "perfect"}
HEAT = {"law": "constant", "closed": 1000.0}


@pytest.mark.parametrize(
    "changes",
    [
        {**RIGID, "interfaces__0__contact": {"method": "rigid"}},
        {**RIGID, "interfaces__0__contact": {"method": "penalty", "penalty": "2 GPa/mm"}},
        {**RIGID, "bodies__0__law": "rigid", **THERMAL},
        {**RIGID, **THERMAL, "boundaries__0": {"on": "mould/outside", "pressure": 1e5}},
        {"support": {"in_gate": ["casting/top", "casting/base"]}},
        {"interfaces__0__contact": FACES, "interfaces__0__heat": HEAT},
        {"interfaces__0__heat": PERFECT},
    ],
)
def test_accepted(changes):
    assert read_case(cylinder(**changes), FILE).bodies[1].name == "mould"


@pytest.mark.parametrize(
    "changes, text",
    [
        (
            {"interfaces__0__contact": {"method": "rigid"}},
            "needs a rigid primary body; give 'mould' law = ",
        ),
        (
            {"bodies__0__law": "rigid"},
            'name the bodies the other way round: ["mould", "casting"]',
        ),
        ({**RIGID, "bodies__0__law": "rigid"}, 'all bodies are rigid; use "thermal"'),
        (
            {**RIGID, "boundaries__0": {"on": "mould/outside", "pressure": 1e5}},
            "boundaries[0].pressure",
        ),
        (
            {**RIGID, "boundaries__0": {"on": "mould/outside", "traction": [0, 1e5]}},
            "boundaries[0].traction = [0, 100000.0]: body 'mould' is rigid and feels no load",
        ),
        (
            {**RIGID, "boundaries__0": {"on": "mould/top", "clamp": {"force": 1e5}}},
            "boundaries[0].clamp: body 'mould' is rigid and feels no load; leave it out",
        ),
        ({"boundaries__0__on": "mold/outside"}, 'boundaries[0].on = "mold/outside": unknown body'),
        (
            {"boundaries__0__on": "mould/outsid"},
            "[0].on = \"mould/outsid\": no surface 'outsid'; surfaces of 'mould': outside, "
            'base, top, symmetry-x, symmetry-y, casting (did you mean "outside"?)',
        ),
        (
            {"support": {"in_gate": ["casting/top", "casting/side"]}},
            "support.in_gate[1] = \"casting/side\": no surface 'side'; surfaces of 'casting': ",
        ),
        (
            {**RIGID, "support": {"in_gate": ["mould/top"]}},
            "support.in_gate[0] = \"mould/top\": body 'mould' is rigid and cannot lose its place",
        ),
        (
            {"interfaces__0__contact": FACES, "interfaces__0__heat": PERFECT},
            'interfaces[0].heat.law = "perfect": "perfect" joins the nodes of matching meshes',
        ),
        (
            {"interfaces__0__contact": {**FACES, "surfaces": ["mould", "cast"]}},
            "interfaces[0].contact.surfaces[1] = \"cast\": no surface 'cast'; surfaces of 'mould'",
        ),
    ],
)
def test_refused(changes, text):
    with pytest.raises(CaseError) as caught:
        read_case(cylinder(**changes), FILE)
    assert text in str(caught.value)
