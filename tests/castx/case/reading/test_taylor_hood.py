"""Bodies with quadratic displacements: what they cannot have is refused, with a cure."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")
QUADRATIC = {"bodies__0__formulation": "taylor-hood"}
FACING = {
    "interfaces__0__contact": {
        "pairing": "node-to-face", "surfaces": ["mould", "casting"],
    }
}  # fmt: skip
MOULD = {"bodies__1__formulation": "taylor-hood"}
BLOCKS = {"method": "block-iterative"}
CLAMP = {"boundaries__0__on": "casting/top", "boundaries__0__clamp": {"force": "20 kN"}}


@pytest.mark.parametrize(
    "changes",
    [
        QUADRATIC,
        {**QUADRATIC, "interfaces__0__contact": {"method": "none"}},
        {**QUADRATIC, "interfaces__0__contact": {"method": "multipliers"}},
        {**QUADRATIC, **FACING},
        {**QUADRATIC, **MOULD, **FACING},
        {**QUADRATIC, "coupling__scheme": "thermal", "interfaces__0__contact": BLOCKS},
        {**QUADRATIC, **CLAMP},
        {**QUADRATIC, "solver__linear": "direct"},
    ],
)
def test_accepted(changes):
    assert read_case(cylinder(**changes), FILE).bodies[0].formulation == "taylor-hood"


@pytest.mark.parametrize(
    "changes, text",
    [
        (
            {**QUADRATIC, "interfaces__0__contact": BLOCKS},
            r"interfaces\[0\]\.contact\.method.*'casting' has .*use 'condensed' in place",
        ),
        (
            {**MOULD, "interfaces__0__contact": BLOCKS | {"fallback": ["condensed"]}},
            r"interfaces\[0\]\.contact\.method.*'mould' has the formulation 'taylor-hood'",
        ),
        (
            {**QUADRATIC, "interfaces__0__contact": {"fallback": ["penalty", "block-iterative"]}},
            r"interfaces\[0\]\.contact\.fallback.*in place of 'block-iterative'",
        ),
        ({**QUADRATIC, "solver__linear": "iterative"}, r'solver\.linear.*use "direct"'),
        (
            {**QUADRATIC, **CLAMP, "boundaries__0__clamp": {"stiffness": "1 MN/mm"}},
            r"boundaries\[0\]\.clamp\.stiffness.*takes a force",
        ),
    ],
)
def test_refused(changes, text):
    with pytest.raises(CaseError, match=text):
        read_case(cylinder(**changes), FILE)
