"""Bodies with quadratic displacements: what they cannot have is refused, with a cure."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")
QUADRATIC = {"bodies__0__formulation": "taylor-hood"}
APART = {**QUADRATIC, "interfaces__0__contact": {"method": "none"}}
CLAMP = {"boundaries__0__on": "casting/top", "boundaries__0__clamp": {"force": "20 kN"}}


@pytest.mark.parametrize(
    "changes",
    [
        APART,
        {**QUADRATIC, "coupling__scheme": "thermal"},
        {**APART, **CLAMP},
        {**APART, "solver__linear": "direct"},
    ],
)
def test_accepted(changes):
    assert read_case(cylinder(**changes), FILE).bodies[0].formulation == "taylor-hood"


@pytest.mark.parametrize(
    "changes, text",
    [
        (QUADRATIC, r"interfaces\[0\].*'casting' has the formulation 'taylor-hood'"),
        ({**APART, "solver__linear": "iterative"}, r'solver\.linear.*use "direct"'),
        (
            {**APART, **CLAMP, "boundaries__0__clamp": {"stiffness": "1 MN/mm"}},
            r"boundaries\[0\]\.clamp\.stiffness.*takes a force",
        ),
    ],
)
def test_refused(changes, text):
    with pytest.raises(CaseError, match=text):
        read_case(cylinder(**changes), FILE)
