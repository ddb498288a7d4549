"""Normals that an interface takes by default."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial



def chosen(**changes):
    return read_case(cylinder(**changes), Path("cylinder.toml")).interfaces[0].contact.normals


@pytest.mark.parametrize(
    "changes, normals",
    [
        ({}, "patches"),
        ({"interfaces__0__bodies": ["mould", "casting"], "probes": []}, "patches"),
        ({"interfaces__0__contact": {"method": "penalty"}}, "patches"),
        ({"bodies__1__law": "rigid", "interfaces__0__contact": {"method": "rigid"}}, "patches"),
        ({"interfaces__0__contact": {"normals": "averaged"}}, "averaged"),
        ({"interfaces__0__contact": {"friction": 0.1}}, "averaged"),
        ({"interfaces__0__contact": {"method": "tied"}}, "averaged"),
        ({"interfaces__0__contact": {"method": "none"}}, "averaged"),
        ({"interfaces__0__contact": {"pairing": "node-to-face"}}, "averaged"),
        ({"coupling__scheme": "thermal"}, "averaged"),
        ({"bodies__0__temperature": 600}, "averaged"),
        ({"materials__aluminium__liquid": "none"}, "averaged"),
    ],
)
def test_a_liquid_gets_a_normal_for_each_wall(changes, normals):
    assert chosen(**changes) == normals
