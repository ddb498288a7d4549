"""A run with an interface of the database, and one with its numbers written out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.transfer.database import interface_entry
from tests.coupled_cases import cylinder, final_state

pytestmark = pytest.mark.serial

NAME = "aluminium-steel-coating-layer"
SHORT = {"time": {"end": 4.0, "fixed_step": 1.0}}


def temperatures(comm: Any, heat: dict[str, Any]) -> np.ndarray:
    data = cylinder(SHORT, size=0.015)
    data["time"] = {"end": 4.0, "fixed_step": 1.0}
    data["interfaces"][0]["heat"] = heat
    state = final_state(comm, data)
    return np.concatenate([state.nodal(body, "temperature") for body in ("casting", "mould")])


def test_a_case_that_names_an_entry_runs_with_its_numbers(comm):
    named = temperatures(comm, {"from": NAME})
    np.testing.assert_array_equal(named, temperatures(comm, interface_entry(NAME).heat))
    thick = temperatures(comm, {"from": NAME, "coating": {"thickness": "0.3 mm"}})
    assert np.abs(thick - named).max() > 5.0
    # A thicker coating keeps the heat in the casting.
    assert thick.max() > named.max()
