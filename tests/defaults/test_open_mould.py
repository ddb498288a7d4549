"""A block freezes in an open mould, comes off its walls and bows: which pairs it rests on.

Reference: complementarity, the weight, and the other methods and orders of the bodies.
"""

from __future__ import annotations

from typing import Any

import pytest

from castx.materials.flow import VISCOPLASTIC
from castx.materials.lookup import find_material
from tests.coupled_cases import merged
from tests.defaults.runs import accepted_steps, bears, complies

pytestmark = pytest.mark.sampled

WIDTH, HEIGHT, GRAVITY = 0.04, 0.03, 9.81
WEIGHT = find_material("AlSi7Mg", {}).density * GRAVITY * WIDTH * HEIGHT


def open_mould(first: str = "casting", method: str = "condensed", **changes: Any) -> dict:
    """Return the case with one body named first, by a contact method."""
    names = ["casting", "mould"] if first == "casting" else ["mould", "casting"]
    case = {
        "geometry": {"generator": "box_in_mould", "model": "plane-strain",
                     "box": [WIDTH, HEIGHT], "wall": 0.02, "size": 0.005},
        "bodies": [
            {"name": "casting", "material": "AlSi7Mg", "temperature": 650, "law": VISCOPLASTIC},
            {"name": "mould", "material": "steel-H13", "temperature": 200},
        ],
        "interfaces": [
            {"bodies": names, "contact": {"method": method},
             "heat": {"law": "limited", "closed": 2000, "gas_conductivity": 0.05}},
        ],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0}}],
        "loads": {"gravity": [0, -GRAVITY, 0]},
        "time": {"end": 45},
    }  # fmt: skip
    return merged(case, changes)


@pytest.mark.parametrize("method", ["condensed", "multipliers"])
@pytest.mark.parametrize("first", ["casting", "mould"])
def test_pairs_neither_pull_nor_penetrate_and_bear_the_weight(comm, first, method):
    case = open_mould(first, method)
    name, sign = ("casting/mould", 1) if first == "casting" else ("mould/casting", -1)
    steps = 0
    for state in accepted_steps(comm, case):
        steps += 1
        complies(state, WEIGHT)
        bears(state, name, sign * WEIGHT)
    assert 20 < steps < 40
    assert state.totals[f"{name}.closed_fraction"] < 0.2
