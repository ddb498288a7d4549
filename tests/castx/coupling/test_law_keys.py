"""Every key of a law that flows reaches the run: changing it changes the answer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.materials.inelastic import FLOW_RULES as RULES
from tests import coupled_cases
from tests.castx.coupling.test_building import changed
from tests.coupled_cases import final_state, ring

# Keys reach their problems alike on all ranks; the laws themselves are tested on several.
pytestmark = pytest.mark.serial

SOLID = {
    "yield_stress": [[20.0, 60e6], [600.0, 3e6]], "kinematic_hardening": 5e8,
    "hardening": {"linear": 1e9, "saturation": 20e6, "rate": 50.0},
    "solidus": 600.0, "liquidus": 660.0, "solidification_shrinkage": 0.01,
    "liquid": {"viscosity": 1e6, "coherency": 0.7},
}  # fmt: skip
PERZYNA = SOLID | {"law": "perzyna", "viscosity": 5e7, "exponent": 4.0}
CREEPING = SOLID | {
    "law": "norton", "coefficient": 1e-24, "exponent": 4.0, "activation_energy": 9e4,
    "liquid": {"model": "norton", "coefficient": 1e-14, "exponent": 2.0,
               "activation_energy": 5e4, "coherency": 0.7},
}  # fmt: skip
PLASTIC, VISCOPLASTIC = "thermo-elasto-plastic", "thermo-elasto-viscoplastic"
BASES = {
    "plastic": (PLASTIC, SOLID),
    "viscoplastic": (VISCOPLASTIC, PERZYNA),
    "creeping liquid": (VISCOPLASTIC, CREEPING),
}
BASES |= {
    name: (VISCOPLASTIC, SOLID | {"law": name, **rule.example}) for name, rule in RULES.items()
}


def base(name: str) -> dict[str, Any]:
    """Return a ring that freezes onto a cold core, partly solid, partly liquid after two steps."""
    law, material = BASES[name]
    data = ring(
        {"time": {"end": 4.0, "fixed_step": 2.0, "heat_substeps": 2},
         "materials": {"aluminium": material}},
        size=0.005,
    )  # fmt: skip
    data["bodies"][0] |= {"law": law, "temperature": 650.0}
    data["interfaces"][0]["heat"]["closed"] = 14000.0
    return data


CHANGES: dict[str, list[tuple[str, Any]]] = {
    "plastic": [
        ("bodies.0.law", "thermo-elastic"),
        ("bodies.0.stabilisation", "gls"),
        ("geometry.cells", "quadrilaterals"),
        ("materials.aluminium.yield_stress", [[20.0, 60e6], [600.0, 4e6]]),
        ("materials.aluminium.hardening.linear", 2e9),
        ("materials.aluminium.hardening.saturation", 30e6),
        ("materials.aluminium.hardening.rate", 80.0),
        ("materials.aluminium.hardening", 1e9),
        ("materials.aluminium.kinematic_hardening", 1e9),
        ("materials.aluminium.liquid.viscosity", 2e6),
        ("materials.aluminium.liquid.coherency", 0.6),
        ("materials.aluminium.liquid", "none"),
        ("materials.aluminium.solidification_shrinkage", 0.02),
        ("materials.aluminium.dissipation", 0.5),
    ],
    "viscoplastic": [
        ("bodies.0.law", PLASTIC),
        ("materials.aluminium.viscosity", 1e8),
        ("materials.aluminium.exponent", 3.0),
        ("materials.aluminium.yield_stress", 10e6),
        ("materials.aluminium.hardening.rate", 200.0),
        ("materials.aluminium.kinematic_hardening", 5e9),
        ("materials.aluminium.dissipation", 0.5),
    ],
    "creeping liquid": [
        ("materials.aluminium.coefficient", 2e-24),
        ("materials.aluminium.exponent", 4.1),
        ("materials.aluminium.activation_energy", 8e4),
        ("materials.aluminium.liquid.coefficient", 2e-14),
        ("materials.aluminium.liquid.exponent", 2.2),
        ("materials.aluminium.liquid.activation_energy", 4e4),
        ("materials.aluminium.liquid.coherency", 0.8),
    ],
}
CHANGES |= {
    name: [(f"materials.aluminium.{key}", 1.2 * value) for key, value in rule.example.items()]
    for name, rule in RULES.items()
}


def answer(comm, data: dict[str, Any]) -> dict[str, np.ndarray]:
    state = final_state(comm, data)
    totals = {k: v for k, v in state.totals.items() if "heat" in k or "enthalpy" in k}
    found = coupled_cases.fields(state) | {"totals": np.array(list(totals.values()))}
    found["stress"] = np.abs(state.cellwise("casting", "stress")).sum(axis=0)
    return found


@pytest.fixture(scope="module")
def known() -> dict[str, dict[str, np.ndarray]]:
    return {}


@pytest.mark.sampled
@pytest.mark.parametrize(
    "name, path, value", [(name, *change) for name in CHANGES for change in CHANGES[name]]
)
def test_each_key_changes_the_answer(comm, known, name, path, value):
    if name not in known:
        known[name] = answer(comm, base(name))
    original, found = known[name], answer(comm, changed(base(name), path, value))
    comparable = [n for n in found if n in original and found[n].shape == original[n].shape]
    assert "totals" in comparable
    assert any(
        np.abs(found[n] - original[n]).max() > 1e-7 * np.abs(original[n]).max() for n in comparable
    )


@pytest.mark.parametrize("name", BASES)
def test_the_casting_is_all_at_once(comm, known, name):
    """Solid, mushy and liquid, and the solid flows: no key can be without effect for lack of it."""
    state = final_state(comm, base(name))
    fractions = state.nodal("casting", "solid_fraction")
    assert fractions.max() == 1.0 and fractions.min() < 0.7
    assert np.any((fractions > 0.5) & (fractions < 1.0))
    assert state.cellwise("casting", "plastic_strain").max() > 1e-4
