"""Pores do not hang on the steps: on given temperatures, and by the default of the steps.

A strip of mush, fed at one end, cools evenly under a gradient across it, so that its temperatures
are exact at any step and only flow and pores are left: halving the step changes its pores by 1 %.
A cylinder of AlSi7Mg in a rigid mould that its top feeds has 0.04 % of pores, which open in its
last seconds: with the largest step by default, half and a quarter of it they differ by less than
3 %.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.coupled_cases import cylinder, merged, states
from tests.verification.mush_strips import CONDUCTIVITY, RANGE, SOLIDUS, fed_strip

pytestmark = [pytest.mark.serial, pytest.mark.slow]

HIGH, WIDE, ACROSS, RATE = 0.1, 5e-3, 6.0, 2.0
"""Length and width of the strip [m], difference across it [K], its cooling [K/s]."""
AHEAD = 10.0


def pores(comm, data) -> float:
    """Return the volume of pores at the end of a run, when all is solid."""
    for state in states(comm, data):
        solid, found = (
            state.totals[f"casting.{name}"] for name in ("solid_fraction", "unfed_volume")
        )
    assert solid == pytest.approx(1.0)
    return found


def strip(step: float) -> dict[str, Any]:
    """Return the strip, which is fed at its far end."""
    hot, gradient = SOLIDUS + RANGE + AHEAD, ACROSS / WIDE
    held: dict[str, dict[str, Any]] = {
        "wall": {"displacement": {"x": 0.0}},
        "bottom": {"displacement": {"x": 0.0, "y": 0.0},
                   "heat": {"type": "flux", "value": CONDUCTIVITY * gradient}},
        "top": {"displacement": {"x": 0.0, "y": 0.0},
                "heat": {"type": "flux", "value": -CONDUCTIVITY * gradient}},
    }  # fmt: skip
    across = {"along": "y", "table": [[0.0, hot], [WIDE, hot - ACROSS]]}
    end = (RANGE + AHEAD) / RATE + 1.0
    return fed_strip(HIGH, WIDE, across, RATE, held, step=step, end=end)


def test_pores_of_given_temperatures(comm):
    """1, 0.5 and 0.25 s, of 31 s."""
    found = np.array([pores(comm, strip(step)) for step in (1.0, 0.5, 0.25)])
    assert found.min() > 0.005 * HIGH * WIDE
    np.testing.assert_allclose(found[:-1], found[-1], rtol=0.015)


def test_pores_by_the_default_of_the_steps(comm):
    found = []
    for share in (1.0, 0.5, 0.25):
        data = cylinder({"time": {"end": 75.0, "largest_step": share * 75.0 / 20.0}},
                        size=5e-3, height=0.1)  # fmt: skip
        metal = {"extends": "AlSi7Mg", "expansion": 0.0}
        data = merged(data, {"materials": {"metal": metal}, "loads": {"gravity": [0.0, -9.81]}})
        data["bodies"][0] |= {
            "material": "metal", "law": "thermo-elasto-viscoplastic", "feeding": "darcy",
            "temperature": 640.0,
        }  # fmt: skip
        data["bodies"][1] = {"name": "mould", "material": "steel-H13", "temperature": 200.0,
                             "law": "rigid"}  # fmt: skip
        data["foundry"] = {"feeders": ["casting/top"]}
        found.append(pores(comm, data))
    assert max(found) < 1.03 * min(found)
    assert min(found) > 1e-7
