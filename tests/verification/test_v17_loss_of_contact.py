"""V17: a casting that shrinks away from all sides of a tight closed mould (Chiumenti, Fig. 6).

Reference: `castx/proof/verification/contact/closed_mould.py`.
"""

from __future__ import annotations

from typing import Any

import pytest

from castx.proof.verification.contact.closed_mould import closed_mould
from tests.coupled_cases import final_state, merged
from tests.verification.closed_mould import check

pytestmark = pytest.mark.sampled


def case(rigid: bool, steps: int = 2, **contact: Any) -> dict[str, Any]:
    """Return the case in steps of a second."""
    made = closed_mould(rigid, steps, **{"normals": "patches", **contact})
    return merged(made, {"time": {"fixed_step": 1.0}})


@pytest.mark.parametrize("rigid", [True, False])
@pytest.mark.parametrize(
    "contact",
    [
        {},
        {"method": "multipliers"},
        {"method": "penalty"},
        {"method": "augmented-lagrangian"},
        {"normals": "averaged"},
    ],
    ids=lambda contact: contact.get("method", contact.get("normals", "condensed")),
)
def test_the_weight_stays_on_the_floor(comm, contact, rigid):
    check(final_state(comm, case(rigid, **contact)))


@pytest.mark.ranks
def test_an_iterative_solution_has_to_be_tighter_than_the_thermal_forces(comm):
    """Those are 1e5 times the weight; a Krylov method stops at a part of them."""
    data = case(rigid=True, method="block-iterative", block_solver="preconditioner")
    data["solver"] = {"mechanics_tolerance": 1e-11}
    check(final_state(comm, data))


def test_the_method_of_rigid_moulds(comm):
    check(final_state(comm, case(rigid=True, method="rigid")))


@pytest.mark.ranks
def test_in_one_step(comm):
    state = final_state(comm, case(rigid=True, steps=1))
    check(state)
    assert state.counters.frozen_pairs == state.counters.cutbacks == 0
