"""V17: a casting that shrinks away from all sides of a tight closed mould (Chiumenti, Fig. 6).

A box of w × h, plane strain, cools so that it shrinks freely by s = (1 + ν) α ΔT in the plane. It
stays on the floor by its weight ρ g w h per metre of depth; the gap under the lid is s h, those at
the sides add up to s w. Nothing holds the box sideways: it stays in the middle by the weak springs
on the motions that nothing holds, which carry no force.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.coupled_cases import final_state

pytestmark = pytest.mark.sampled

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


def case(rigid: bool, steps: int = 2, **contact):
    return {
        "geometry": {
            "generator": "box_in_mould", "model": "plane-strain", "box": [WIDTH, HEIGHT],
            "wall": 0.03, "size": 0.01, "lid": True,
        },
        "materials": {"metal": {**METAL, "stress_free": 500.0}, "steel": {**METAL}},
        "bodies": [
            {"name": "casting", "material": "metal",
             "temperature_history": [[0.0, 500.0], [steps, 500.0 - COOLING]]},
            {"name": "mould", "material": "steel", "temperature": 20.0,
             "law": "rigid" if rigid else "thermo-elastic"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "contact": {"normals": "patches", **contact}}],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0.0}}],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "coupling": {"scheme": "mechanical"},
        "time": {"end": steps, "fixed_step": 1.0},
    }  # fmt: skip


def by_side(state, name):
    """Return the values of the pairs of all ranks by the side of the box that they are on."""
    comm, pairs = state.mesh.comm, state.pairs["casting/mould"]
    values = state.paired("casting/mould", name)
    sides = {"floor": (1, 1), "lid": (1, -1), "left": (0, 1), "right": (0, -1)}
    return {
        side: np.concatenate(comm.allgather(values[pairs.normals[:, k] * sign > 0.9]))
        for side, (k, sign) in sides.items()
    }


def check(state, tolerance=1e-6):
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


def test_an_iterative_solution_has_to_be_tighter_than_the_thermal_forces(comm):
    """Those are 1e5 times the weight; a Krylov method stops at a part of them."""
    data = case(rigid=True, method="block-iterative", block_solver="preconditioner")
    data["solver"] = {"mechanics_tolerance": 1e-11}
    check(final_state(comm, data))


def test_the_method_of_rigid_moulds(comm):
    check(final_state(comm, case(rigid=True, method="rigid")))


def test_in_one_step(comm):
    state = final_state(comm, case(rigid=True, steps=1))
    check(state)
    assert state.counters.frozen_pairs == state.counters.cutbacks == 0


def test_reference_numbers():
    assert WEIGHT == pytest.approx(141.264, rel=1e-12)
    assert (SHRINKAGE * HEIGHT, SHRINKAGE * WIDTH) == pytest.approx((0.72e-3, 1.2e-3))
