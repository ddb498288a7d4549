"""Cells that become solid twice within a step stay solid until its end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.mechanics.constitutive.coherency import Coherency
from tests.castx.mechanics.lone_bodies import MELTING, alone, begin
from tests.coupled_cases import states

MOULD: dict[str, Any] = {"name": "mould", "material": "steel-H13", "temperature": 150.0}
CASTING: dict[str, Any] = {
    "name": "casting", "material": "AlCu4.5", "law": "thermo-elasto-plastic", "temperature": 720.7,
}  # fmt: skip


@pytest.mark.serial
def test_the_second_birth_of_a_step_lasts():
    """A cell that is solid all along, one that freezes and melts over and over, one that melts."""
    coherency = Coherency(np.array([True, False, True]))
    passes = (
        ([0.90, 0.80, 0.90], 0.0), ([0.90, 0.60, 0.60], 0.0), ([0.90, 0.75, 0.90], 0.75),
        ([0.90, 0.65, 0.90], 0.75), ([0.90, 0.72, 0.90], 0.75), ([0.90, 0.65, 0.90], 0.75),
        ([0.90, 0.85, 0.90], 0.85),
    )  # fmt: skip
    for fractions, least in passes:
        coherency.note(np.array(fractions), 0.7)
        np.testing.assert_array_equal(coherency.least, [0.0, least, 0.0])


@pytest.mark.parametrize("end", ["commit", "rewind"])
def test_a_body_forgets_what_has_settled_at_the_end_of_a_step(comm, end):
    part = alone(comm, properties=MELTING, starts_liquid=True)

    def solid(fraction: float) -> bool:
        begin(part, 600.0, fraction)
        part.update_points()
        return all(comm.allgather(bool(part.coherent.all())))

    passes = [solid(fraction) for fraction in (0.75, 0.65, 0.85, 0.65, 0.2)]
    assert passes == [True, False, True, True, True]
    np.testing.assert_allclose(part.material.conditions.solid_share, 0.5)
    getattr(part, end)()
    assert [solid(fraction) for fraction in (0.65, 0.75)] == [False, True]


@pytest.mark.serial
def test_a_gap_that_delays_the_freezing_which_opens_it(comm):
    """As a liquid the corners of this little casting freeze, as a solid they do not.

    Passes alternated between both until none was left, with any step.
    """
    case: dict[str, Any] = {
        "geometry": {
            "generator": "box_in_mould", "model": "plane-strain", "cells": "quadrilaterals",
            "box": [0.00364, 0.0039], "wall": 0.00141, "size": 0.0007,
        },
        "bodies": [CASTING, MOULD],
        "interfaces": [{
            "bodies": ["casting", "mould"],
            "contact": {"method": "condensed", "friction": 0.07},
            "heat": {
                "law": "series", "closed": 41300.0, "gas_conductivity": 0.0306,
                "radiation": {"emissivities": [0.318, 0.331]},
            },
        }],
        "boundaries": [
            {"on": "mould/base", "displacement": {"normal": 0.0}},
            {"on": "mould/outside",
             "heat": {"type": "convection", "coefficient": 30.0, "ambient": 20.0}},
        ],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 0.115},
    }  # fmt: skip
    for state in states(comm, case):
        assert state.counters.cutbacks == 0 and state.counters.passes <= 15
