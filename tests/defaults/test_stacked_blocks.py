"""A hot block rests on a cold one: the contact bears its weight in every accepted step.

Both shrink or grow, bow and flow, so that internal forces are up to thousands of times the weight,
and the pairs that bear it change from step to step. Reference: the weight, ρ g V.
"""

from __future__ import annotations

from typing import Any

import pytest

from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.materials.inelastic import FLOW_RULES
from castx.materials.lookup import find_material
from castx.mechanics.constitutive.law import ELASTIC
from tests.contact_methods import AT_ONCE
from tests.coupled_cases import merged
from tests.defaults.runs import accepted_steps, bears

pytestmark = pytest.mark.sampled

WIDTH, HEIGHT, GRAVITY = 0.02, 0.02, 9.81


def stacked(**changes: Any) -> dict:
    """Return the case with changes at its top level."""
    case = {
        "geometry": {
            "generator": "stacked_blocks", "model": "plane-strain", "upper": [WIDTH, HEIGHT],
            "base": [0.04, 0.02], "size": 0.0025, "symmetry": False,
        },
        "bodies": [
            {"name": "upper", "material": "AlSi7Mg", "temperature": 500,
             "law": VISCOPLASTIC},
            {"name": "base", "material": "AlSi7Mg", "temperature": 100,
             "law": VISCOPLASTIC},
        ],
        "interfaces": [
            {"bodies": ["upper", "base"],
             "heat": {"law": "limited", "closed": 2000, "gas_conductivity": 0.05}},
        ],
        "boundaries": [{"on": "base/bottom", "displacement": {"normal": 0}}],
        "loads": {"gravity": [0, -GRAVITY, 0]},
        "time": {"end": 3},
    }  # fmt: skip
    return merged(case, changes)


def bears_its_weight(comm, case: dict) -> None:
    weight = find_material("AlSi7Mg", {}).density * GRAVITY * WIDTH * HEIGHT
    steps = 0
    for state in accepted_steps(comm, case):
        steps += 1
        bears(state, "upper/base", weight)
    assert steps > 5


def with_law(case: dict, law: str, rule: str | None = None) -> dict:
    """Return the case with a law of both bodies, by a flow rule if one is given."""
    material = "AlSi7Mg"
    if rule is not None and not FLOW_RULES[rule].is_default:
        material = f"AlSi7Mg {rule}"
        example = {"extends": "AlSi7Mg", "law": rule, **FLOW_RULES[rule].example}
        case = merged(case, {"materials": {material: example}})
    bodies = [body | {"law": law, "material": material} for body in case["bodies"]]
    return case | {"bodies": bodies}


@pytest.mark.parametrize("linear", ["direct", "iterative"])
@pytest.mark.parametrize("law", [ELASTIC, PLASTIC, VISCOPLASTIC])
def test_by_every_law_and_every_linear_solver(comm, law, linear):
    bears_its_weight(comm, with_law(stacked(solver={"linear": linear}), law))


@pytest.mark.parametrize("rule", FLOW_RULES)
def test_by_every_flow_rule(comm, rule):
    bears_its_weight(comm, with_law(stacked(), VISCOPLASTIC, rule))


@pytest.mark.parametrize("method", AT_ONCE)
def test_by_every_contact_method(comm, method):
    case = stacked()
    case["interfaces"][0]["contact"] = {"method": method}
    bears_its_weight(comm, case)


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_on_tied_blocks(comm, cells):
    case = stacked(geometry={"cells": cells})
    case["interfaces"][0]["contact"] = {"method": "tied"}
    bears_its_weight(comm, case)
