"""The case of blocks on each other is valid and has the sizes, moduli and push that were given."""

from __future__ import annotations

import pytest

from castx.case.reading.read import load_case
from castx.proof.verification.contact.stacked import stacked_case

pytestmark = pytest.mark.serial


def test_the_case_says_what_was_given():
    blocks, young = {"upper": (0.02, 0.03), "base": (0.04, 0.05)}, {"upper": 1e9, "base": 2e9}
    made = stacked_case(0.005, blocks, young, 0.25, 1e-4, {"method": "multipliers"})
    case = load_case(made)
    assert {body.name: body.material for body in case.bodies} == {"upper": "upper", "base": "base"}
    assert [case.interfaces[0].contact.method] == ["multipliers"]
    assert made["geometry"]["upper"] == [0.02, 0.03] and made["geometry"]["base"] == [0.04, 0.05]
    assert made["materials"]["base"] == {
        "young_modulus": 2e9, "poisson_ratio": 0.25, "expansion": 0.0
    }  # fmt: skip
    assert made["boundaries"][1] == {"on": "upper/top", "displacement": {"normal": -1e-4}}
