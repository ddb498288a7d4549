"""V17, its exact answer: a casting that shrinks away from all sides of a tight closed mould.

A box of w × h, plane strain, cools so that it shrinks freely by s = (1 + ν) α ΔT in the plane. It
stays on the floor by its weight ρ g w h per metre of depth; the gap under the lid is s h, those at
the sides add up to s w. Nothing holds the box sideways: it stays in the middle by the weak springs
on the motions that nothing holds, which carry no force. After M. Chiumenti, Fig. 6.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.process.state import State

WIDTH, HEIGHT, DENSITY, GRAVITY, SHRINKAGE = 0.1, 0.06, 2400.0, 9.81, 0.012
WEIGHT = DENSITY * GRAVITY * WIDTH * HEIGHT
POISSON, EXPANSION = 0.3, 2e-5
COOLING = SHRINKAGE / ((1 + POISSON) * EXPANSION)
METAL = {
    "young_modulus": 70e9,
    "poisson_ratio": POISSON,
    "expansion": EXPANSION,
    "density": DENSITY,
}


def closed_mould(rigid: bool, seconds: float, **contact: Any) -> dict[str, Any]:
    """Return a casting that cools evenly for some seconds in a rigid or an elastic mould."""
    return {
        "geometry": {
            "generator": "box_in_mould", "model": "plane-strain", "box": [WIDTH, HEIGHT],
            "wall": 0.03, "size": 0.01, "lid": True,
        },
        "materials": {"metal": {**METAL, "stress_free": 500.0}, "steel": {**METAL}},
        "bodies": [
            {"name": "casting", "material": "metal",
             "temperature_history": [[0.0, 500.0], [seconds, 500.0 - COOLING]]},
            {"name": "mould", "material": "steel", "temperature": 20.0,
             "law": "rigid" if rigid else "thermo-elastic"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": contact}],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0.0}}],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "coupling": {"scheme": "mechanical"},
        "time": {"end": seconds},
    }  # fmt: skip


def by_side(state: State, name: str) -> dict[str, FloatArray]:
    """Return the values of the pairs of all ranks by the side of the box that they are on."""
    comm, pairs = state.mesh.comm, state.pairs["casting/mould"]
    values = state.paired("casting/mould", name)
    sides = {"floor": (1, 1), "lid": (1, -1), "left": (0, 1), "right": (0, -1)}
    return {
        side: np.concatenate(comm.allgather(values[pairs.normals[:, k] * sign > 0.9]))
        for side, (k, sign) in sides.items()
    }


def check(state: State, tolerance: float = 1e-6) -> None:
    """Compare the last state with the exact answer."""
    gaps = by_side(state, "gap")
    pressures = by_side(state, "contact_pressure")
    assert state.totals["casting/mould.force.y"] == pytest.approx(WEIGHT, rel=tolerance)
    assert state.totals["casting/mould.force.x"] == pytest.approx(0.0, abs=1e-9 * WEIGHT)
    for side in ("lid", "left", "right"):
        assert not pressures[side].any()
    np.testing.assert_allclose(gaps["lid"], SHRINKAGE * HEIGHT, rtol=1e-4)
    left, right = gaps["left"], gaps["right"]
    np.testing.assert_allclose(left, right.mean(), rtol=1e-3)
    assert left.mean() + right.mean() == pytest.approx(SHRINKAGE * WIDTH, rel=1e-4)
    assert state.totals["support_force"] < 1e-4 * WEIGHT
